"""Which key asks for what: the defaults of the table, and what a person changed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from .actions import ACTIONS, BY_NAME, Order

MODIFIERS = ("Ctrl", "Shift", "Alt")
_WORDS = "Esc Tab Space Enter Backspace Delete Insert Home End PageUp PageDown Left Right Up Down".split()
NAMED = {name.lower(): name for name in (*_WORDS, *(f"F{n}" for n in range(1, 25)))}
"""Keys with a name, by that name in small letters; every other key is called by the character it types, in capitals."""
RESERVED = {"Esc": "leave", "Ctrl+Q": "quit"}
"""Always there: nobody can lock themselves in."""


@dataclass(frozen=True)
class Keymap:
    """What each key asks for."""

    orders: Mapping[str, Order]
    """Key -> order."""
    conflicts: tuple[str, ...] = ()
    """One sentence for each key that was wanted twice or is no key."""

    def order(self, key: str, repeated: bool = False) -> Order | None:
        """What a key asks for; held down it repeats only what moves by steps."""
        order = self.orders.get(key)
        return None if order is None or (repeated and not order.relative) else order

    def keys_of(self, name: str) -> tuple[str, ...]:
        """The keys of an action, in the order of the table."""
        return tuple(key for key, order in self.orders.items() if order.name == name)


def key_name(text: str) -> str | None:
    """The canonical name of a key as a person may write it (``ctrl + q``); None when there is none like it."""
    text = text.strip()
    plus = text in ("+",) or text.endswith("++")
    parts = [part.strip() for part in (text[:-1] if plus else text).split("+") if part.strip()] + (
        ["+"] if plus else []
    )
    if not parts:
        return None
    *modifiers, key = parts
    held = {modifier.title() for modifier in modifiers}
    named = NAMED.get(key.lower())
    if not held <= set(MODIFIERS) or (named is None and len(key) != 1):
        return None
    return "+".join([*(modifier for modifier in MODIFIERS if modifier in held), named or key.upper()])


def keymap(changes: Mapping[str, Sequence[str]] | None = None) -> Keymap:
    """The keys of the table with a person's own in their place.

    Args:
        changes: action's name -> its keys, one for each of its default keys; a shorter list leaves the rest without.

    A key that two actions want goes to the one that the person gave it to, and between equals to the first in the
    table; each such case is said in ``conflicts``.
    """
    changes = dict(changes or {})
    complaints = [f"There is no action called '{name}'; its keys are left out." for name in changes.keys() - BY_NAME]
    orders: dict[str, Order] = {}
    own = [action for action in ACTIONS if action.name in changes]
    for action in (*own, *(action for action in ACTIONS if action.name not in changes)):
        defaults = action.keys
        wanted = changes.get(action.name, [key for key, _ in defaults])
        for text in wanted[len(defaults) :]:
            complaints.append(f"{action.title} takes {len(defaults)} of your keys; '{text}' is one too many.")
        for text, (_, value) in zip(wanted, defaults, strict=False):
            key = key_name(text)
            if key is None:
                complaints.append(f"'{text}' is no key, so {action.title} is left without it.")
            elif RESERVED.get(key, action.name) != action.name:
                complaints.append(f"{key} always means {BY_NAME[RESERVED[key]].title}; give {action.title} another.")
            elif key in orders:
                first = BY_NAME[orders[key].name].title
                complaints.append(f"{key} means {first}, so {action.title} is left without it.")
            else:
                orders[key] = Order(action.name, value, action.relative)
    for key, name in RESERVED.items():
        orders.setdefault(key, Order(name))
    places = {name: place for place, name in enumerate(BY_NAME)}
    ordered = sorted(orders.items(), key=lambda item: places[item[1].name])
    return Keymap(dict(ordered), tuple(complaints))


def rebound(changes: Mapping[str, Sequence[str]], name: str, place: int, key: str) -> dict[str, tuple[str, ...]]:
    """The changes with one more: the ``place``-th key of an action becomes ``key``."""
    keys = [key for key, _ in BY_NAME[name].keys]
    keys[: len(changes.get(name, keys))] = changes.get(name, keys)
    keys[place] = key
    return {**{other: tuple(theirs) for other, theirs in changes.items()}, name: tuple(keys)}
