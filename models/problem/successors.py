"""Which contour may directly follow which."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Ints

from .bits import ROWS_AT_ONCE
from .closure import columns_packed, known_immediate_pairs
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
    n, wide = len(before), -(-len(before) // 8)
    sooner = columns_packed(before)
    near = known_immediate_pairs(before, sooner)
    near = near[:, np.argsort(near[0], kind="stable")]
    from_row = np.searchsorted(near[0], np.arange(0, n + ROWS_AT_ONCE, ROWS_AT_ONCE))
    first, last = (np.asarray(~before.any(axis=axis)) for axis in (0, 1))
    bits = _across_blocks(before, block)
    for k, row in enumerate(range(0, n, ROWS_AT_ONCE)):
        rows = slice(row, min(row + ROWS_AT_ONCE, n))
        lawful = ~np.packbits(before[rows], axis=1, bitorder="little")
        lawful &= ~sooner[rows].astype("<u8", copy=False).view(np.uint8)[:, :wide]
        one, other = near[:, from_row[k] : from_row[k + 1]]
        np.bitwise_or.at(lawful, (one - row, other >> 3), _bit(other))
        bits[rows, :wide] &= lawful
    itself = np.arange(n)
    bits[itself, itself >> 3] &= ~_bit(itself)
    bits[itself, n >> 3] |= last.astype(np.uint8) << np.uint8(n & 7)
    unlike = np.array(apart, dtype=np.int64).reshape(-1, 2)
    for one, other in (unlike.T, unlike[:, ::-1].T):
        np.bitwise_and.at(bits, (one, other >> 3), ~_bit(other))
    bits[n] = np.packbits(np.append(first, False), bitorder="little")
    return Followers(bits)


def _across_blocks(before: Bools, block: Ints) -> NDArray[np.uint8]:
    """Who may follow whom as far as blocks go, as bits: they are entered at a first of them and left at a last."""
    n = len(before)
    enters, leaves = np.ones(n, np.bool_), np.ones(n, np.bool_)
    order = np.argsort(block, kind="stable")
    blocks = [k for k in np.split(order, np.flatnonzero(np.diff(block[order])) + 1) if len(k) > 1]
    for members in blocks:
        within = before[np.ix_(members, members)]
        enters[members], leaves[members] = ~within.any(axis=0), ~within.any(axis=1)
    bits = np.zeros((n + 1, n // 8 + 1), dtype=np.uint8)
    bits[:n][leaves] = np.packbits(np.append(enters, False), bitorder="little")
    for members in blocks:
        bits[members] |= np.packbits(np.bincount(members, minlength=n + 1).astype(np.bool_), bitorder="little")
    return bits


def _bit(number: Ints) -> NDArray[np.uint8]:
    """Where each number is in its byte."""
    return np.uint8(1) << (number & 7).astype(np.uint8)
