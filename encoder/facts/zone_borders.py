"""Where an order is divided into zones, for every number of zones that there may be."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from kerfwise.arrays import Floats, Ints

Bears = Callable[[int, int], bool]
"""Whether the pieces begin + 1 … end of an order may be one zone. What may not be is no part of any that may."""
Price = Callable[[Ints, int], Floats]
"""What zones of the pieces begin + 1 … end cost, for several begins (k,), and one end."""


def divisions(count: int, price: Price, bears: Bears, most: int) -> Iterator[Ints]:
    """Ways to make zones of so many pieces that follow each other: the zone, from 1, of every piece (count,).

    The fewest zones come first, then one more each time, up to `most` (the fewest come anyway). Of all zones that are
    so many, they have the least price together (a shortest way over the places between pieces, as in Bellman 1957). A
    piece alone is always borne.

    Examples
    --------
    Four pieces, no more than three may be one zone; zones cost the square of what they are too long by, over two.

    >>> def price(begins, end):
    ...     return (end - begins - 2.0) ** 2
    >>> [zone.tolist() for zone in divisions(4, price, lambda begin, end: end - begin <= 3, 0)]
    [[1, 1, 2, 2]]
    """
    first = _first_of_each(count, bears)
    fewest = [0]
    for end in range(1, count + 1):
        fewest.append(fewest[first[end]] + 1)
    most_zones = min(count, max(most, fewest[count]))
    least = np.full((most_zones + 1, count + 1), np.inf)
    came = np.zeros((most_zones + 1, count + 1), dtype=np.int64)
    least[0, 0] = 0.0
    for end in range(1, count + 1):
        begins = np.arange(first[end], end)
        whole = least[:-1, begins] + price(begins, end)
        came[1:, end] = begins[whole.argmin(axis=1)]
        least[1:, end] = whole.min(axis=1)
    for zones in np.flatnonzero(np.isfinite(least[:, count])).tolist():
        zone, end = np.empty(count, dtype=np.int64), count
        for number in range(zones, 0, -1):
            begin = int(came[number, end])
            zone[begin:end] = number
            end = begin
        yield zone


def _first_of_each(count: int, bears: Bears) -> list[int]:
    """For the end of every piece, where the largest zone begins that ends with it."""
    first, begin = [0], 0
    for end in range(1, count + 1):
        while begin < end - 1 and not bears(begin, end):
            begin += 1
        first.append(begin)
    return first
