"""Lines that do not close, told so that a person finds them in the drawing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from kerfwise.arrays import Floats
from kerfwise.encoder.errors import REPAIR

from .drawing import DrawnCurve
from .options import ReadOptions

REPAIR_FACTOR = 10
"""With `repair`, gaps up to this many times the join tolerance are closed."""


def ends(chain: DrawnCurve) -> str:
    """How long a line is, where it starts and ends, and its layer."""
    (x0, y0), (x1, y1) = chain.curve.vertices[[0, -1], :2].tolist()
    return (
        f"of {chain.curve.length_mm:.3f} mm from ({x0:.3f}, {y0:.3f}) to ({x1:.3f}, {y1:.3f}) on layer '{chain.layer}'"
    )


def nearest_ends(chains: Sequence[DrawnCurve]) -> Floats:
    """Array (n, 2): how far the start and the end of each chain are from the nearest other end, its own too, mm."""
    points = np.concatenate([c.curve.vertices[[0, -1], :2] for c in chains])
    distances: Floats = cKDTree(points).query(points, k=2)[0][:, 1].reshape(-1, 2)
    return distances


def open_end_problems(chains: Sequence[DrawnCurve], options: ReadOptions) -> list[str]:
    """A line for each open chain: where its ends are, how far the nearest other open end is, and what to do."""
    problems = []
    for chain, gaps in zip(chains, nearest_ends(chains).tolist(), strict=True):
        gap, (x, y) = min(zip(gaps, chain.curve.vertices[[0, -1], :2].tolist(), strict=True))
        advice = "close the line in CAD"
        if gap <= REPAIR_FACTOR * options.join_tolerance_mm:
            advice = f"{advice}, raise drawing.join_tolerance over {gap:.3f} mm, or try {REPAIR}"
        problems.append(
            f"the line {ends(chain)} is open: the end at ({x:.3f}, {y:.3f}) is {gap:.3f} mm from any other: {advice}"
        )
    return problems
