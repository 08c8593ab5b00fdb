"""Cuts: moves of which every plan makes so many at least, and which a cheapest flow makes too few of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

from ..closure import immediate
from ..problem import Problem

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

UNIT = 1_000_000
"""Flows are whole millionths."""
ENOUGH = 0.95
"""A flow of as much is not worth a cut."""
MOST = 400
"""Cuts in a round."""


@dataclass(frozen=True, eq=False, slots=True)
class Cuts:
    """Every plan goes at least `least[k]` times from a contour of `tail[k]` to one of `head[k]`.

    `tail` and `head` are (cuts, n + 1), home last, `least` (cuts,).
    """

    tail: Bools
    head: Bools
    least: Floats

    def __len__(self) -> int:
        return len(self.tail)

    def only(self, kept: Bools) -> Cuts:
        """Those of them that are kept."""
        return Cuts(self.tail[kept], self.head[kept], self.least[kept])

    def joined(self, more: Cuts) -> Cuts:
        """With more of them."""
        return Cuts(
            np.concatenate([self.tail, more.tail]),
            np.concatenate([self.head, more.head]),
            np.concatenate([self.least, more.least]),
        )


def block_cuts(problem: Problem) -> Cuts:
    """The contours of a contiguous block follow each other: one move less than there are leads from one to another."""
    names, size = np.unique(problem.block, return_counts=True)
    inside = np.append(problem.block, -1)[None, :] == names[size > 1][:, None]
    return Cuts(inside, inside, (size[size > 1] - 1).astype(np.float64))


def broken_cuts(problem: Problem, between: Floats, go: Callable[[], bool] = lambda: True) -> Cuts:
    """Cuts that a flow breaks; `between` (n + 1, n + 1) is how much goes from contour to contour, home last.

    From home to a contour no plan meets what comes after it, from a contour to home nothing that comes before it, and
    from one contour to a later one nothing before the one or after the other, nor home.
    """
    n = problem.n
    whole = np.rint(between * UNIT).astype(np.int32)
    before = problem.before
    found: dict[bytes, tuple[Bools, Bools]] = {}
    ways = [(n, j, before[j]) for j in range(n)]
    ways += [(j, n, before[:, j]) for j in range(n)]
    ways += [(i, j, before[:, i] | before[j]) for i, j in np.argwhere(immediate(before)).tolist()]
    for start, end, barred in ways:
        if not go():
            break
        kept = np.append(~barred, n in (start, end))
        if between[start, end] < ENOUGH and (cut := _least_cut(whole, start, end, kept)) is not None:
            found.setdefault(cut[0].tobytes() + cut[1].tobytes(), cut)
    chosen = list(found.values())[:: max(1, -(-len(found) // MOST))]
    tail, head = (np.array([cut[side] for cut in chosen], dtype=np.bool_).reshape(-1, n + 1) for side in (0, 1))
    return Cuts(tail, head, np.ones(len(chosen)))


def _least_cut(whole: NDArray[np.int32], start: int, end: int, kept: Bools) -> tuple[Bools, Bools] | None:
    """The contours on either side of the least cut among those kept, if less than `ENOUGH` flows across."""
    room = csr_matrix(np.where(kept[:, None] & kept[None, :], whole, 0))
    flow = maximum_flow(room, start, end)
    if flow.flow_value >= ENOUGH * UNIT:
        return None
    left = room - flow.flow
    left.data = np.maximum(left.data, 0)
    left.eliminate_zeros()
    side = np.zeros(len(kept), dtype=np.bool_)
    side[breadth_first_order(left, start, return_predecessors=False)] = True
    return side & kept, ~side & kept
