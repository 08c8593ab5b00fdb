"""How kernels of the search are compiled, what they take, and their random numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import accumulate
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Ints
from kerfwise.models.jit import KERNEL, inner, jit

# How kernels are compiled: to machine code that is kept on disk between runs and runs without the GIL.

F = TypeVar("F", bound=Callable[..., object])


def compiled(function: F) -> F:
    """Compile a function of numbers, arrays and structs that other compiled functions call."""
    return inner(**KERNEL)(function)


def entry(function: F) -> F:
    """Compile a function that Python calls, and keep the machine code, with that of all it calls, on disk."""
    return jit(**KERNEL)(function)


# Lists of lists as two flat arrays: those of i lie at `flat[first[i]:first[i + 1]]`.


def ints(values: Sequence[int]) -> Ints:
    """An array of whole numbers, empty ones included."""
    return np.array(values, dtype=np.int64)


def flatten(rows: Sequence[Sequence[int]]) -> tuple[Ints, Ints]:
    """`first` and `flat`.

    Examples
    --------
    >>> [a.tolist() for a in flatten([[5, 6], [], [7]])]
    [[0, 2, 2, 3], [5, 6, 7]]
    """
    return ints([0, *accumulate(len(row) for row in rows)]), ints([x for row in rows for x in row])


# Random numbers whose state is an array of our own, so that a search can stop and go on the same way.


@compiled
def draw_number(random: NDArray[np.uint64]) -> np.uint64:
    """The next 64 random bits (xorshift64*, Vigna 2016)."""
    x = random[0]
    x ^= x >> np.uint64(12)
    x ^= x << np.uint64(25)
    x ^= x >> np.uint64(27)
    random[0] = x
    return np.uint64(x * np.uint64(2685821657736338717))


@compiled
def below(random: NDArray[np.uint64], bound: int) -> int:
    """A random whole number in 0 … bound - 1."""
    return int(np.int64((draw_number(random) >> np.uint64(33)) % np.uint64(bound)))


@compiled
def draw_share(random: NDArray[np.uint64]) -> float:
    """A random number in [0, 1)."""
    return np.float64(draw_number(random) >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@compiled
def high(bits: np.uint64, bound: int) -> int:
    """A whole number in 0 … bound - 1 by the upper half of random bits; what follows takes other parts of them."""
    return int(np.int64((bits >> np.uint64(32)) * np.uint64(bound) >> np.uint64(32)))


@compiled
def low(bits: np.uint64, bound: int) -> int:
    """A whole number in 0 … bound - 1, at most 1 << 16, by the lowest sixteen of random bits."""
    return int(np.int64((bits & np.uint64(0xFFFF)) * np.uint64(bound) >> np.uint64(16)))


@compiled
def rather_low(bits: np.uint64, bound: int) -> int:
    """A whole number in 0 … bound - 1, at most 1 << 16, rather a small one, by the lowest sixteen of random bits."""
    by = bits & np.uint64(0xFFFF)
    return int(np.int64((by * by >> np.uint64(16)) * np.uint64(bound) >> np.uint64(16)))


@compiled
def short(bits: np.uint64) -> int:
    """1 … 16, rather small, by the lowest sixteen of random bits."""
    by = bits & np.uint64(0xFFFF)
    return int(np.int64(by * by >> np.uint64(28))) + 1


@compiled
def is_odd(bits: np.uint64) -> bool:
    """Heads or tails, by the seventeenth bit."""
    return bool(bits & np.uint64(0x10000))


@compiled
def chunk(bits: np.uint64) -> int:
    """0 … 4095, by the bits above the seventeenth."""
    return int(np.int64((bits >> np.uint64(17)) & np.uint64(0xFFF)))
