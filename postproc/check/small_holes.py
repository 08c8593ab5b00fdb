"""Small holes as the profile asks for them, found anew: which are cut, and how fast, which are marked or left out.

The check measures holes in its own way, from fine chords, and draws itself the cross that is to stand at the middle of
a hole that is only marked.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely

from kerfwise.encoder.cut import CutSequence, Side
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.kept import kept_with_nest
from kerfwise.encoder.listed import listed
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.scrap import with_scrap
from kerfwise.encoder.small_holes import HoleLimits
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Violation

from .torch_run import TorchRun

Shares = tuple[float, float]

_RULE = "small-holes"
_CHORD_MM, _STEP_MM = 1e-4, 2e-4
_SLACK_MM = 0.0125
_DRAWN_MM = 0.011
_MEASURED_MM = 0.002
_MIDDLE, _ARMS = 0.25, 0.8
_NAMED = 5


@dataclass(frozen=True, eq=False, slots=True)
class SmallHole:
    """A hole that the profile does not have cut: how wide it is, mm, and why it can be neither marked nor left out."""

    contour: Contour
    across_mm: float
    why_not: str | None


@dataclass(frozen=True, eq=False, slots=True)
class Judged:
    """The nest that a plan or program is judged by, the holes that are not cut in it, and the feeds in the others.

    `shares` are the least and the greatest share of the cut feed that a hole may be cut at, by contour; 1 elsewhere.
    """

    nest: Nest
    small: tuple[SmallHole, ...]
    shares: Mapping[str, Shares] = field(default_factory=dict)


def judged_nest(nest: Nest, profile: Profile) -> Judged:
    """The drawing's nest as the profile has it cut; kept with the drawing, for a plan and its program."""
    scrap, drawn = profile.cuts.scrap, profile.without_losses(nest.drawn or nest)
    return _judged(drawn, profile.hole_limits(), profile.material.kerf_mm, scrap.grid_mm, scrap.remnant)


@kept_with_nest(most=2)
def _judged(drawn: Nest, limits: HoleLimits, kerf_mm: float, grid_mm: float | None, remnant: Side | None) -> Judged:
    under_mm = limits.least_mm if limits.under == "refuse" else max(limits.least_mm, limits.room_mm)
    outers = shapely.STRtree([part.outer.polygon for part in drawn.parts])
    small: list[SmallHole] = []
    shares: dict[str, Shares] = {}
    parts = []
    enough_mm = max(under_mm, limits.full_feed_mm)
    coarsely_mm = _coarsely_mm([hole for part in drawn.parts for hole in part.holes]) if enough_mm > 0 else {}
    for part in drawn.parts:
        holes, marks = [], list(part.marks)
        for hole in part.holes:
            if enough_mm > 0 and coarsely_mm[hole.id] >= enough_mm + _SLACK_MM:
                shares[hole.id] = _shares(enough_mm + _SLACK_MM, limits)
                holes.append(hole)
                continue
            area = shapely.make_valid(hole.curve.polygon(_CHORD_MM))
            across_mm = _across_mm(area, enough_mm)
            if across_mm >= under_mm - _SLACK_MM:
                shares[hole.id] = _shares(across_mm, limits)
                holes.append(hole)
                continue
            guests = [drawn.parts[k].id for k in outers.query(area, "contains").tolist()]
            shares[hole.id] = _shares(across_mm, limits)
            why_not = f"{guests[0]} lies in it" if guests else _no_spot(area, across_mm, limits)
            small.append(SmallHole(hole, across_mm, why_not))
            if limits.under == "refuse" or why_not is not None:
                holes.append(hole)
            elif limits.under == "spot":
                marks.append(_cross(hole, area, limits))
        changed = len(holes) != len(part.holes)
        parts.append(replace(part, holes=tuple(holes), marks=tuple(marks)) if changed else part)
    lined = with_scrap(drawn, kerf_mm, grid_mm, remnant)
    changed_parts = replace(lined, parts=tuple(parts), drawn=drawn.drawn or drawn) if small else lined
    return Judged(changed_parts, tuple(small), shares)


def _across_mm(area: shapely.Geometry, enough_mm: float) -> float:
    """Diameter of the largest circle in an area, or a smaller one that is wide enough to tell."""
    if enough_mm <= 0:
        return np.inf
    edge, middle = shapely.boundary(area), shapely.centroid(area)
    if shapely.covers(area, middle) and 2 * shapely.distance(edge, middle) >= enough_mm:
        return float(2 * shapely.distance(edge, middle))
    return float(2 * shapely.maximum_inscribed_circle(area, tolerance=_STEP_MM).length)


def _coarsely_mm(holes: Sequence[Contour]) -> dict[str, float]:
    """A diameter that a circle in each hole has at the least, by the chords of the drawing; 0 where they tell none."""
    areas = np.array([hole.polygon for hole in holes], dtype=object)
    middles = shapely.centroid(areas)
    sound = shapely.is_valid(areas)
    sound[sound] = shapely.covers(areas[sound], middles[sound])
    edges = np.array([hole.line for hole in holes], dtype=object)
    across_mm = np.where(sound, 2 * shapely.distance(edges, middles) - 2 * _DRAWN_MM, 0.0)
    return dict(zip([hole.id for hole in holes], across_mm.tolist(), strict=True))


def _shares(across_mm: float, limits: HoleLimits) -> Shares:
    """The feeds that a hole may be cut at, its diameter being known to some micrometres."""
    if limits.full_feed_mm <= limits.least_mm:
        low, high = (limits.feed_share if across_mm + d < limits.full_feed_mm else 1.0 for d in (-1e-3, 1e-3))
        return low, high
    at_mm, feeds = (limits.least_mm, limits.full_feed_mm), (limits.feed_share, 1.0)
    low, high = (float(np.interp(across_mm + d, at_mm, feeds)) for d in (-_MEASURED_MM, _MEASURED_MM))
    return low, high


def _no_spot(area: shapely.Geometry, across_mm: float, limits: HoleLimits) -> str | None:
    middle = shapely.centroid(area)
    apart_mm = shapely.distance(shapely.boundary(area), middle) if shapely.covers(area, middle) else 0.0
    off = limits.under == "spot" and apart_mm < _MIDDLE * across_mm
    return "its middle lies outside it" if off else None


def _cross(hole: Contour, area: shapely.Geometry, limits: HoleLimits) -> Contour:
    """The mark that shows the middle of a hole: along x, back to the middle, and along y."""
    middle = shapely.centroid(area)
    reach = min(limits.spot_mm / 2, _ARMS * float(shapely.distance(shapely.boundary(area), middle)))
    steps = np.array([(-1, 0), (1, 0), (0, 0), (0, 1), (0, -1)]) * reach + np.array([middle.x, middle.y])
    return Contour(hole.id, hole.part, "mark", Curve.of(steps.tolist(), closed=False))


def small_holes(judged: Judged, cuts: CutSequence, runs: Sequence[TorchRun], profile: Profile) -> list[Violation]:
    """Holes that must not be cut through, and are; holes for which the profile refuses the nest."""
    limits, found = profile.hole_limits(), []
    strays = [run for run in runs if not run.marks and (run.contour is None or run.contour.kind == "mark")]
    positions = cuts.positions()
    made = {cut.contour for cut in cuts[: cuts.made]}
    for hole in (hole for hole in judged.small if hole.contour.id not in made):
        name = hole.contour.id
        size = f"{name} is {hole.across_mm:.2f} mm across, holes under {_limit_mm(hole, limits):g} mm are not cut"
        at = (positions[name],) if name in positions else ()
        if limits.under == "refuse":
            found.append(Violation(_RULE, (name,), f"{size}: the profile refuses the nest (small_holes.under)", at))
        elif hole.why_not is not None:
            text = f"{size}, and it cannot be {_done(limits)} either: {hole.why_not}"
            found.append(Violation(_RULE, (name,), text, at))
        else:
            where = next(_cut_through(hole, cuts, strays), None)
            if where is not None:
                text = f"{where}: {size} but {_done(limits)} (small_holes.under: {limits.under})"
                found.append(Violation(_RULE, (name,), text, at))
    return found


def _cut_through(hole: SmallHole, cuts: CutSequence, strays: Sequence[TorchRun]) -> Iterator[str]:
    """Where a plan, or a program, cuts a hole that it must not."""
    for position, cut in enumerate(cuts, 1):
        if cut.contour == hole.contour.id and cut.lead_in is not None and cut.lead_in.segments:
            yield f"cut {position}"
    inside = hole.contour.polygon
    yield from (run.where for run in strays if inside.covers(run.loop))


def _limit_mm(hole: SmallHole, limits: HoleLimits) -> float:
    """The limit that a hole is under: the profile's least diameter, or the room that a pierce needs."""
    return limits.least_mm if hole.across_mm < limits.least_mm - _SLACK_MM else limits.room_mm


def _done(limits: HoleLimits) -> str:
    return "marked at their middle" if limits.under == "spot" else "left out"


def told_of_small_holes(judged: Judged, profile: Profile) -> Iterator[str]:
    """What the profile does not have cut: a check never passes over it in silence."""
    limits = profile.hole_limits()
    names = [hole.contour.id for hole in judged.small if hole.why_not is None]
    if not names or limits.under == "refuse":
        return
    holes = "a small hole is" if len(names) == 1 else f"{len(names)} small holes are"
    done = "not cut but marked at the middle" if limits.under == "spot" else "left out"
    yield f"{holes} {done} (small_holes.under: {limits.under}): {listed(names, _NAMED)}"
