"""Following loose pieces from meeting point to meeting point."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kerfwise.arrays import Ints

Step = tuple[int, bool]
"""A piece's number and whether it is followed as drawn."""


@dataclass(frozen=True, slots=True)
class Trail:
    """Pieces that follow each other, back to the start if closed."""

    steps: tuple[Step, ...]
    closed: bool


def trace(group: Sequence[int], nodes: Ints, twin: Mapping[int, int]) -> list[Trail]:
    """Every piece of the group in one ring or chain.

    Parameters
    ----------
    group
        Numbers of pieces, in the order of the file.
    nodes
        Array (n, 2): the meeting points at the start and the end of each piece.
    twin
        Piece → the first piece that runs along the same line; a trail never turns back along one.

    Examples
    --------
    >>> import numpy as np
    >>> trace([0, 1, 2], np.array([[0, 1], [2, 1], [2, 0]]), {0: 0, 1: 1, 2: 2})
    [Trail(steps=((0, True), (1, False), (2, True)), closed=True)]
    """
    at: dict[int, list[int]] = defaultdict(list)
    for k in group:
        for node in nodes[k].tolist():
            at[node].append(k)
    free, trails = dict.fromkeys(group), []
    loose_ends = [k for k in group if any(len(at[n]) == 1 for n in nodes[k].tolist())]
    for seed in [*loose_ends, *group]:
        if seed in free:
            rings, chain = _walk(seed, at, free, nodes, twin)
            trails += [Trail(ring, closed=True) for ring in rings]
            if chain:
                trails.append(Trail(chain, closed=False))
    return trails


def _walk(
    seed: int, at: Mapping[int, Sequence[int]], free: dict[int, None], nodes: Ints, twin: Mapping[int, int]
) -> tuple[list[tuple[Step, ...]], tuple[Step, ...]]:
    """The rings that the way from `seed` closes, and what is left of the way when it ends.

    Whenever the way comes back to a point it has passed, the loop is a ring of its own: contours that share a
    corner come apart there.
    """
    start, end = nodes[seed].tolist()
    forward = len(at[start]) == 1 or len(at[end]) > 1
    here, there = (start, end) if forward else (end, start)
    passed, steps = {here: 0}, [(seed, forward)]
    rings: list[tuple[Step, ...]] = []
    visited = [here]
    del free[seed]
    while True:
        if there in passed:
            loop = passed[there]
            rings.append(tuple(steps[loop:]))
            for node in visited[loop + 1 :]:
                del passed[node]
            del steps[loop:], visited[loop + 1 :]
        else:
            passed[there] = len(steps)
            visited.append(there)
        last = steps[-1][0] if steps else rings[-1][-1][0]
        onward = [k for k in at[there] if k in free and twin[k] != twin[last]]
        if not onward or (not steps and rings):
            return rings, tuple(steps)
        chosen = min(onward, key=lambda k: (abs(k - last), k < last))
        del free[chosen]
        forward = int(nodes[chosen][0]) == there
        steps.append((chosen, forward))
        there = int(nodes[chosen][1 if forward else 0])
