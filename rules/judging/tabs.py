"""Which parts may tip, and whether tabs lie where they hold: the judging half of rule hold-small-parts."""

from __future__ import annotations

import math

import numpy as np
import shapely

from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Part

BENT_DEG = 45.0
"""A contour that turns by more beside a tab has a corner there. The planner keeps to 40: chords turn in steps."""
SLACK_MM = 1e-6


def may_tip(part: Part, pitch_mm: float, across: int) -> float | None:
    """How near the centroid of a part lies to one end of it along an axis (0: x, 1: y), mm; None if a pitch or more."""
    points = shapely.get_coordinates(part.polygon.exterior)[:, across]
    middle = shapely.get_coordinates(part.polygon.centroid)[0, across]
    near_mm = float(min(middle - points.min(), points.max() - middle))
    return near_mm if near_mm < pitch_mm - SLACK_MM else None


def bend_deg(contour: Contour, at: Point, reach_mm: float) -> float:
    """By how much a contour turns within a reach of a point of it, either way, all turns added up."""
    points = shapely.get_coordinates(contour.line)[:-1]
    steps = np.roll(points, -1, axis=0) - points
    steps_mm = np.hypot(*steps.T)
    heading = np.arctan2(steps[:, 1], steps[:, 0])
    turn = np.abs((heading - np.roll(heading, 1) + math.pi) % (2 * math.pi) - math.pi)  # at the start of each step
    starts_mm = np.concatenate([[0.0], np.cumsum(steps_mm)[:-1]])
    around_mm = float(steps_mm.sum())
    at_mm = float(shapely.line_locate_point(contour.line, shapely.Point(at)))
    away_mm = np.abs((starts_mm - at_mm + around_mm / 2) % around_mm - around_mm / 2)
    return math.degrees(float(turn[away_mm < reach_mm - SLACK_MM].sum()))
