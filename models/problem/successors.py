"""Which contour may directly follow which."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.models.kernels import kept, suited

from .bits import ROWS_AT_ONCE, Masks
from .closure import immediate_pairs, packed
from .followers import Followers
from .last import LastOf, digest

_last = LastOf[Followers]()


def known_followers(before: Bools, block: Ints, apart: Sequence[tuple[int, int]] = ()) -> Followers:
    """The same as `lawful_followers`, made once of orders that are asked for again; they must not change meanwhile."""
    unlike = np.array(apart, dtype=np.int64).reshape(-1, 2)
    asked = digest(block, unlike)
    followers = _last.known(before, asked)
    if followers is None:
        followers = lawful_followers(before, block, unlike)
        _last.keep(before, asked, followers)
    return followers


def lawful_followers(before: Bools, block: Ints, apart: Sequence[tuple[int, int]] | Ints = ()) -> Followers:
    """Which of n + 1 may directly follow which; n is the machine's home.

    `before` is the closed relation of what must come before what, `block` the contiguous block of every contour, and
    `apart` pairs that may not follow each other either way round.

    Examples
    --------
    >>> chain = np.array([[0, 1, 1], [0, 0, 1], [0, 0, 0]], dtype=bool)
    >>> lawful_followers(chain, np.arange(3)).whole().astype(int).tolist()
    [[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [1, 0, 0, 0]]
    """
    n = len(before)
    sooner = packed(before.T)
    near = immediate_pairs(sooner)
    near = near[:, np.argsort(near[0], kind="stable")]
    from_row = np.searchsorted(near[0], np.arange(0, n + ROWS_AT_ONCE, ROWS_AT_ONCE))
    enters, leaves = _ends_of_blocks(before, block)
    first, last = (np.asarray(~before.any(axis=axis)) for axis in (0, 1))
    unlike = np.array(apart, dtype=np.int64).reshape(-1, 2)
    unlike = np.concatenate([unlike, unlike[:, ::-1]])
    bits = np.zeros((n + 1, n // 8 + 1), dtype=np.uint8)
    mark = suited(_mark_lawful, n * n)
    for k, row in enumerate(range(0, n, ROWS_AT_ONCE)):
        lawful = np.zeros((min(ROWS_AT_ONCE, n - row), n + 1), dtype=np.bool_)
        one, other = near[:, from_row[k] : from_row[k + 1]]
        lawful[one - row, other] = True
        mark(before, sooner, block, enters, leaves, row, lawful)
        lawful[:, n] = last[row : row + ROWS_AT_ONCE]
        of = unlike[(unlike[:, 0] >= row) & (unlike[:, 0] < row + ROWS_AT_ONCE)]
        lawful[of[:, 0] - row, of[:, 1]] = False
        bits[row : row + len(lawful)] = np.packbits(lawful, axis=1, bitorder="little")
    bits[n] = np.packbits(np.append(first, False), bitorder="little")
    return Followers(bits)


def _ends_of_blocks(before: Bools, block: Ints) -> tuple[Bools, Bools]:
    """Contours with none of their block before them, and with none after them."""
    enters, leaves = np.ones(len(before), np.bool_), np.ones(len(before), np.bool_)
    order = np.argsort(block, kind="stable")
    for members in np.split(order, np.flatnonzero(np.diff(block[order])) + 1):
        if len(members) > 1:
            within = before[np.ix_(members, members)]
            enters[members], leaves[members] = ~within.any(axis=0), ~within.any(axis=1)
    return enters, leaves


@kept(nogil=True)
def _mark_lawful(  # pragma: no cover - compiled
    before: Bools, sooner: Masks, block: Ints, enters: Bools, leaves: Bools, row: int, lawful: Bools
) -> None:
    """Contours from a row on: not backwards, nothing in between, blocks entered at a first and left at a last of them.

    Where nothing is in between is marked already; `sooner` are the sets of what comes before each.
    """
    for k in range(len(lawful)):
        i = row + k
        for j in range(len(before)):
            if not before[i, j] and i != j and not sooner[i, j >> 6] >> np.uint64(j & 63) & np.uint64(1):
                lawful[k, j] = True
            if lawful[k, j]:
                lawful[k, j] = block[i] == block[j] or (leaves[i] and enters[j])
