"""Candidates that the machine can make: those whose torch stays within its travel."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Box
from kerfwise.encoder.nest import Contour

from .candidate import Candidate

_SLACK_MM = 1e-6


def within_reach(candidates: Iterable[Candidate], reach: Box | None) -> list[Candidate]:
    """The candidates whose leads and ends the torch can go to; edge starts only where anybody has said how far it goes.

    The rings between them are judged once for each contour (`out_of_reach`).
    """
    if reach is None:
        return [c for c in candidates if not c.edge_start]
    return [c for c in candidates if all(inside(xy, reach) for xy in _points(c))]


def out_of_reach(contour: Contour, path: Curve, reach: Box | None) -> str | None:
    """Where the torch's path round a contour leaves what it can go to, as a sentence; None if it does not."""
    if reach is None:
        return None
    points = shapely.get_coordinates(path.line())
    far = max(points.tolist(), key=lambda xy: beyond_mm((xy[0], xy[1]), reach))
    if (off_mm := beyond_mm((far[0], far[1]), reach)) <= _SLACK_MM:
        return None
    return (
        f"{contour.id} at ({far[0]:.1f}, {far[1]:.1f}) is {off_mm:.1f} mm out of the machine's travel: "
        "move the part, or correct machine.travel_x and machine.travel_y"
    )


def inside(point: Sequence[float], reach: Box) -> bool:
    """Whether the torch can go to a point."""
    return beyond_mm(point, reach) <= _SLACK_MM


def beyond_mm(point: Sequence[float], reach: Box) -> float:
    """How far a point is beyond what the torch can go to, along the worse axis; 0 or less within it."""
    x0, y0, x1, y1 = reach
    return max(x0 - point[0], point[0] - x1, y0 - point[1], point[1] - y1)


def _points(candidate: Candidate) -> Iterable[Sequence[float]]:
    yield from (candidate.pierce, candidate.end)
    for lead in (candidate.lead_in, candidate.lead_out):
        if lead is not None:
            yield from lead.flatten().tolist()
