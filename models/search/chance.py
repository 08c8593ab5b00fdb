"""Random numbers whose state is an array of our own, so that a search can stop and go on the same way."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .compiled import compiled


@compiled
def draw(random: NDArray[np.uint64]) -> np.uint64:
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
    return int(np.int64((draw(random) >> np.uint64(33)) % np.uint64(bound)))


@compiled
def share(random: NDArray[np.uint64]) -> float:
    """A random number in [0, 1)."""
    return np.float64(draw(random) >> np.uint64(11)) * (1.0 / 9007199254740992.0)
