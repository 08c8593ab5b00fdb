"""Blocks of blocks and clones of clones: what they unfold to is counted before any of it is drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

from kerfwise.encoder.errors import InputError

DEEPEST = 32
MOST_COPIES = 500_000
"""Ten thousand contours of fifty lines each; as many copies take a minute or two to draw."""

K = TypeVar("K")
MadeOf = Callable[[K], tuple[int, Iterable[tuple[K, int]]]]
"""Key of a drawing or a block → how many entities it holds beside blocks, and which blocks how many times over."""


def check_copies(whole: K, made_of: MadeOf[K], word: str) -> None:
    """Refuse a drawing whose copies nobody could wait for: two dozen blocks of two blocks each are 16 million.

    Every block is looked into once.

    Parameters
    ----------
    whole
        Key of the drawing itself; its own entities are no copies.
    word
        What the format calls a block, for the message.

    Raises
    ------
    InputError
        For over `MOST_COPIES` copies, or blocks in blocks over `DEEPEST` deep, as those that contain themselves are.

    Examples
    --------
    >>> nested = {"sheet": (1, [("row", 10)]), "row": (0, [("part", 10)]), "part": (4, [])}
    >>> check_copies("sheet", nested.__getitem__, "block")
    >>> check_copies("sheet", (nested | {"part": (9000, [])}).__getitem__, "block")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    kerfwise.encoder.errors.InputError: the drawing unfolds to 900,110 copies of what its blocks hold, ...
    """
    counted: dict[K, int] = {}

    def unfolded(key: K, depth: int) -> int:
        if depth > DEEPEST:
            raise InputError(f"{word}s are nested over {DEEPEST} deep: a {word} seems to contain itself")
        if key not in counted:
            own, inner = made_of(key)
            counted[key] = own + sum(times * (1 + unfolded(block, depth + 1)) for block, times in inner)
        return counted[key]

    copies = unfolded(whole, 0) - made_of(whole)[0]
    if copies > MOST_COPIES:
        raise InputError(
            f"the drawing unfolds to {copies:,} copies of what its {word}s hold, {MOST_COPIES:,} at the most can be "
            f"read; take out {word}s that are no part of the nest"
        )
