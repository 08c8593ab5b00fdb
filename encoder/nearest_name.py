"""A name that is not known: the valid one that was probably meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping


def nearest(word: str, valid: Iterable[str]) -> str | None:
    """The valid name most like `word`, or None when nothing is like it.

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
    begun = [plain for plain in sorted(by_plain) if len(word) > 2 and plain.startswith(_plain(word))]
    matches = begun or difflib.get_close_matches(_plain(word), by_plain, n=1, cutoff=0.6)
    return by_plain[matches[0]] if matches else _begun_alike(_plain(word), by_plain)


def _begun_alike(word: str, by_plain: Mapping[str, str]) -> str | None:
    """The first name whose beginning is much like what was given: `lasr` for `laser-wood`."""
    for plain in sorted(by_plain) if len(word) > 2 else ():
        beginnings = [plain[: len(word) + k] for k in (-1, 0, 1)]
        if difflib.get_close_matches(word, beginnings, n=1, cutoff=0.8):
            return by_plain[plain]
    return None


def unknown(what: str, word: str, valid: Iterable[str]) -> str:
    """A message for a name that is not among the valid ones: the nearest, and all of them when they are few.

    Examples
    --------
    >>> unknown("key", "kerv", ["name", "kerf"])
    "unknown key 'kerv': did you mean 'kerf'? (valid: kerf, name)"
    """
    names = sorted(valid)
    guess = nearest(word, names)
    hint = f": did you mean {guess!r}?" if guess else ""
    listed = ", ".join(names) if len(names) <= 20 else f"{', '.join(names[:20])}, …"
    return f"unknown {what} {word!r}{hint} (valid: {listed})" if names else f"unknown {what} {word!r}"


def _plain(name: str) -> str:
    return name.lower().replace("_", "-").replace(" ", "-")
