"""Names that rules may have."""

from __future__ import annotations

import re

RESERVED = ("new", "page", "test")
"""Verbs of `kerfwise rules`."""


def wrong_name(name: object) -> str | None:
    """What is wrong with a rule's name; None where nothing is.

    Examples
    --------
    >>> wrong_name("long-parts-last")
    >>> wrong_name("Long parts")
    "'Long parts' is not a name of a rule: expected small letters and digits such as long-parts-last"
    """
    if not isinstance(name, str) or not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name):
        return f"{name!r} is not a name of a rule: expected small letters and digits such as long-parts-last"
    if name in RESERVED:
        return f"a rule cannot be called {name!r}: `kerfwise rules {name}` means something else"
    return None
