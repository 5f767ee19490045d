"""Wide vectors for the kernels of this package, where the processor has them."""

import os
import sys
from collections.abc import Mapping

_NAMES = ("NUMBA_CPU_FEATURES", "NUMBA_CPU_NAME", "NUMBA_ENABLE_AVX")


def widen() -> None:
    """Have numba use vectors of 512 bits where that pays: a row of a tile is one of them, and tiles take a tenth to a
    fifth less. Only before numba compiles anything, and not where the user's environment says for which processor it
    shall compile. numba's cache on disk tells kernels apart by this."""
    if any(name in os.environ for name in _NAMES):
        return
    from llvmlite import binding

    try:
        host = binding.get_host_cpu_features()
    except RuntimeError:  # a processor that LLVM does not know; numba goes without, too
        return
    if has_fast_wide_vectors(host):
        features = f"{host.flatten()},-prefer-256-bit"
        os.environ["NUMBA_CPU_FEATURES"] = features
        if "numba" in sys.modules:  # it has read its environment already
            sys.modules["numba"].config.CPU_FEATURES = features


def has_fast_wide_vectors(host: Mapping[str, bool]) -> bool:
    """Whether a processor with LLVM's features ``host`` should not be spared 512 bits, as LLVM does for Intel's.

    The first that had them lower their clock for it. Those from Ice Lake on hardly do; they have ``avx512vbmi2``.
    """
    return bool(host.get("avx512vbmi2"))
