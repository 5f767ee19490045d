"""Work that the threads of a kernel share out among themselves while they run.

numba gives each thread its part beforehand: the kernel then takes as long as the thread whose core somebody else has.
"""

from typing import Any

from numba import types
from numba.extending import intrinsic


def _fetch_add(typing: Any, counter: Any, step: Any) -> Any:
    del typing, step

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.atomic_rmw("add", array.data, arguments[1], "monotonic")

    return types.int64(counter, types.int64), generate


fetch_add: Any = intrinsic(_fetch_add)
"""``fetch_add(counter, step)``, in kernels: ``counter`` int64 [1] before ``step`` was added to it, at one stroke: no
two threads get the same number."""
