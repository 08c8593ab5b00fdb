"""Did you mean …? The nearest valid name to a mistyped one."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping


def nearest(given: str, valid: Iterable[str]) -> str | None:
    """The valid name most like `given`, or None when nothing is like it.

    Examples
    --------
    >>> nearest("levelahead", ["hull-before", "level-ahead"])
    'level-ahead'
    >>> nearest("lasr", ["laser-wood", "water-jet"])
    'laser-wood'
    >>> nearest("zzz", ["hull-before"]) is None
    True
    """
    by_plain = {_plain(name): name for name in sorted(valid, reverse=True)}
    begun = [plain for plain in sorted(by_plain) if len(given) > 2 and plain.startswith(_plain(given))]
    matches = begun or difflib.get_close_matches(_plain(given), by_plain, n=1, cutoff=0.6)
    return by_plain[matches[0]] if matches else _begun_alike(_plain(given), by_plain)


def _begun_alike(given: str, by_plain: Mapping[str, str]) -> str | None:
    """The first name whose beginning is much like what was given: `lasr` for `laser-wood`."""
    for plain in sorted(by_plain) if len(given) > 2 else ():
        beginnings = [plain[: len(given) + k] for k in (-1, 0, 1)]
        if difflib.get_close_matches(given, beginnings, n=1, cutoff=0.8):
            return by_plain[plain]
    return None


def unknown(what: str, given: str, valid: Iterable[str]) -> str:
    """A message for a name that is not among the valid ones: the nearest, and all of them when they are few.

    Examples
    --------
    >>> unknown("key", "kerv", ["name", "kerf"])
    "unknown key 'kerv': did you mean 'kerf'? (valid: kerf, name)"
    """
    names = sorted(valid)
    guess = nearest(given, names)
    hint = f": did you mean {guess!r}?" if guess else ""
    listed = ", ".join(names) if len(names) <= 20 else f"{', '.join(names[:20])}, …"
    return f"unknown {what} {given!r}{hint} (valid: {listed})" if names else f"unknown {what} {given!r}"


def _plain(name: str) -> str:
    return name.lower().replace("_", "-").replace(" ", "-")
