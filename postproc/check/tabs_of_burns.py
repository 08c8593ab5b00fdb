"""Tabs as burns leave them: stretches that the torch goes unlit, and the one that a cut stops short of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Cut, Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.tabs import LONGEST_MM
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.rules.rule import Violation

from .matching import Matcher
from .program_rules import tolerance_mm
from .torch_run import TorchRun, line_of

_MOST = 0.25
"""What is left of a ring at the most, that it still counts as cut but for a tab."""


def up_to_tabs(burns: Sequence[Burn], nest: Nest, matcher: Matcher) -> tuple[Burn, ...]:
    """The burns, those that stop short of where they joined an outer contour led on to there, unlit."""
    lines = [line_of(burn.path) for burn in burns]
    asked = [k for k, burn in enumerate(burns) if burn.tool == 0 and lines[k] is not None]
    found = matcher.match([line for k in asked if (line := lines[k])], [False] * len(asked), [None] * len(asked))
    made = list(burns)
    for k, match in zip(asked, found, strict=True):
        if match is None or nest.contours[match.contour].kind != "outer":
            continue
        if (rest := _rest(burns[k].path, match.ring, tolerance_mm(matcher.kerf_mm))) is not None:
            path, lit_mm = burns[k].path, burns[k].path.length_mm
            led_on = Curve(np.vstack([path.vertices[:-1], rest]), closed=False)
            made[k] = replace(burns[k], path=led_on, unlit=((lit_mm, led_on.length_mm),))
    return tuple(made)


def _rest(path: Curve, ring: shapely.LineString, within_mm: float) -> Floats | None:
    """The vertices along a ring from the end of a path to where it joined; None where it ends elsewhere, or far off."""
    points = shapely.points(path.vertices[:, :2])
    on = shapely.distance(ring, points) <= within_mm
    if not on[-1] or int(on.sum()) < 3:
        return None
    join = int(np.argmax(on))
    at_mm = shapely.line_locate_point(ring, points)
    around_mm = float(ring.length)
    step_mm = (at_mm[join + 1] - at_mm[join] + around_mm / 2) % around_mm - around_mm / 2
    lit = Curve(path.vertices[join:], closed=False)
    onwards = (
        lit.is_ccw == bool(shapely.is_ccw(shapely.LinearRing(ring.coords))) if len(lit.segments) > 2 else step_mm > 0
    )
    gap_mm = float((at_mm[join] - at_mm[-1]) % around_mm if onwards else (at_mm[-1] - at_mm[join]) % around_mm)
    if not within_mm < gap_mm <= min(LONGEST_MM, _MOST * around_mm):
        return None
    steps = np.linspace(0.0, gap_mm, max(2, int(gap_mm / 0.5) + 2))
    along = shapely.line_interpolate_point(ring, (at_mm[-1] + (steps if onwards else -steps)) % around_mm)
    xy = shapely.get_coordinates(along)
    xy[0], xy[-1] = path.vertices[-1, :2], path.vertices[join, :2]
    return np.column_stack([xy, np.zeros(len(xy))])


def with_tabs(cut: Cut, run: TorchRun, burn: Burn, kerf_mm: float) -> tuple[Cut, TorchRun, list[Violation]]:
    """A cut, and its run, with the tabs that its burn leaves, and what is wrong with where these are."""
    assert run.contour is not None
    curve, wrong = run.contour.curve, []
    tabs, off = [], []
    for low, high in burn.unlit:
        middle = burn.path.point_at((low + high) / 2)
        at = curve.point_at(curve.project(middle)[0])
        tabs.append(Tab(at, high - low - kerf_mm))
        off.append(Tab(middle, high - low))
        away_mm = run.loop.distance(shapely.Point(middle))
        if away_mm > tolerance_mm(kerf_mm):
            text = f"{run.where}: the torch goes off for {high - low:.2f} mm beside {cut.contour}, where no tab can be"
            wrong.append(Violation("contour-geometry", (cut.contour,), text, (run.position,)))
    lead_out = cut.lead_out
    if burn.unlit[-1][1] >= burn.path.length_mm - 1e-6:
        lead_out = Curve.of([burn.path.point_at(burn.unlit[-1][0])], closed=False)
    return replace(cut, tabs=tuple(tabs), lead_out=lead_out), replace(run, unlit=tuple(off)), wrong
