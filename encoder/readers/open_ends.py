"""Lines that do not close, told so that a person finds them in the drawing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from .drawing import Piece
from .options import ReadOptions


def ends(chain: Piece) -> str:
    """How long a line is, where it starts and ends, and its layer."""
    (x0, y0), (x1, y1) = chain.curve.vertices[[0, -1], :2].tolist()
    return (
        f"of {chain.curve.length_mm:.3f} mm from ({x0:.3f}, {y0:.3f}) to ({x1:.3f}, {y1:.3f}) on layer '{chain.layer}'"
    )


def open_end_problems(chains: Sequence[Piece], options: ReadOptions) -> list[str]:
    """A line for each open chain: where its ends are, how far the nearest other open end is, and what to do."""
    points = np.concatenate([c.curve.vertices[[0, -1], :2] for c in chains])
    distance = cKDTree(points).query(points, k=2)[0][:, 1].reshape(-1, 2)
    problems = []
    for chain, gaps, pair in zip(chains, distance.tolist(), points.reshape(-1, 2, 2).tolist(), strict=True):
        gap, (x, y) = min(zip(gaps, pair, strict=True))
        advice = f"raise join_tolerance_mm over {gap:.3f}, close the line in CAD, or try --repair"
        if gap > 100 * options.join_tolerance_mm:
            advice = "close the line in CAD, or try --repair, which leaves it out"
        problems.append(
            f"the line {ends(chain)} is open: the end at ({x:.3f}, {y:.3f}) is {gap:.3f} mm from any other: {advice}"
        )
    return problems
