"""JSON trees with something put where nobody expects it."""

import json
from copy import deepcopy
from random import Random
from typing import Any

_DEEP, _LONG = "@deep@", "@long@"
STRANGE: tuple[Any, ...] = (
    *(None, True, False, 0, 1, -1, 0.5, 2, 7, 2**31, 2**53, 2**60, -(2**60), 2**64, 10**30, 10**400, -(10**400)),
    *(1e308, -1e308, 1e-320, float("nan"), float("inf"), float("-inf")),
    *("", "0", "1/0", "1e999999999", "9" * 5000, "1/" + "9" * 3000, "-1/30", "NaN", "inf", "\0", "\ud800"),
    *("../../../../etc/passwd", "/dev/zero", "file:///etc/passwd", "http://127.0.0.1/x", "con", "x" * 5000),
    *([], {}, [0], [[]], [None] * 3, [1e308] * 3, {"a": {"b": {}}}, _DEEP, _LONG),
)
"""What is put in the place of honest values."""


def shaken(tree: Any, rng: Random) -> Any:
    """A copy with one to three entries exchanged, moved, doubled or lost."""
    copy = {"root": deepcopy(tree)}
    for _ in range(rng.choice((1, 1, 2, 3))):
        holder, key = rng.choice(_places(copy))
        match rng.randrange(5):
            case 0 if isinstance(holder, list) or holder is not copy:
                del holder[key]
            case 1:
                other, place = rng.choice(_places(copy))
                holder[key] = deepcopy(other[place])
            case 2 if isinstance(holder, list):
                holder += [deepcopy(holder[key])] * rng.choice((1, 3, 300))
            case 2 if isinstance(holder, dict):
                holder[rng.choice(("", "extra", "__class__", "uri", str(key) + " "))] = deepcopy(holder[key])
            case 3 if isinstance(holder[key], int):
                holder[key] = holder[key] * rng.choice((-1, 0, 1, 2, 10**6, 10**30)) + rng.choice((0, 1, -1))
            case _:
                holder[key] = deepcopy(rng.choice(STRANGE))
    return copy["root"]


def text_of(tree: Any) -> bytes:
    """The tree as JSON, where the two monsters take their true shape."""
    text = json.dumps(tree)
    return text.replace(f'"{_DEEP}"', "[" * 60_000).replace(f'"{_LONG}"', "9" * 60_000).encode()


def _places(tree: Any) -> list[tuple[Any, Any]]:
    """Every (holder, key) in the tree."""
    found: list[tuple[Any, Any]] = []
    waiting = [tree]
    while waiting:
        holder = waiting.pop()
        for key in range(len(holder)) if isinstance(holder, list) else list(holder):
            found.append((holder, key))
            if isinstance(holder[key], list | dict):
                waiting.append(holder[key])
    return found
