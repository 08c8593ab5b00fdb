"""Slits: slots narrower than the kerf, opened by one pass of the torch along their middle.

A slit is an open cut of its own. It begins where the torch's path round the contour closes over the mouth of the slot,
or beside that where the mouth is open to one side only, as of a bend relief. It runs along the middle, and ends half a
kerf from the slot's end. The slot becomes as wide as the kerf: the part loses half the difference to each side. What
has no straight middle is not slit.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import tolerance_mm

from .narrow_features import CHORD_MM, CORNER_RAD, MOST_TOLD, NEAR_MM, LostFeatureSpan, lost_walls, ring_of
from .nest import Contour, Nest, Part, cached_with_nest, with_parts
from .torch_path import compensate_together, compensated

# A first guess, square to the mouth or towards the farthest point of the wall, is straightened: sections across it
# give points halfway between the two sides, and a line through those the next guess.

STRAIGHT_MM = 0.02
"""The middle of a slot may leave a straight line by this much."""
_SECTIONS = 33
_ROUNDS = 6


@dataclass(frozen=True, eq=False, slots=True)
class Middle:
    """The straight middle of a slot: a point on it, and the unit vector into the slot.

    Lengths along it count from that point: where the mouth and the bottom lie, and sections across the slot (m,) with
    their widths.
    """

    origin: Floats
    along: Floats
    mouth_mm: float
    bottom_mm: float
    at_mm: Floats
    widths_mm: Floats

    @property
    def opening(self) -> float:
        """By how much it grows wider, a length along it."""
        return float(np.polyfit(self.at_mm, self.widths_mm, 1)[0])

    def narrowest_mm(self, until_mm: float) -> float:
        """The narrowest width up to a place along it."""
        slope, at_zero_mm = np.polyfit(self.at_mm, self.widths_mm, 1).tolist()
        there_mm = at_zero_mm + slope * max(until_mm, float(self.at_mm[0]))
        before = self.widths_mm[: max(int((self.at_mm <= until_mm).sum()), 1)]
        return max(min(float(before.min()), float(there_mm)), 0.0)

    def point(self, at_mm: float) -> Point:
        """A point of it."""
        x, y = (self.origin + at_mm * self.along).tolist()
        return x, y


def middle_of_slot(wall: Floats) -> Middle | None:
    """The straight middle of a slot with this wall (n, 2), a line from one side of its mouth to the other.

    None where there is none: of a slot that is bent, forked or wider behind its mouth on one side.

    Examples
    --------
    >>> found = middle_of_slot(np.array([(0.0, 10.0), (0.0, 0.0), (1.0, 0.0), (1.0, 10.0)]))
    >>> found.point(found.bottom_mm), found.narrowest_mm(found.bottom_mm)
    ((0.5, 0.0), 1.0)
    """
    origin, mouth = (wall[0] + wall[-1]) / 2, wall[-1] - wall[0]
    farthest = wall[np.argmax(np.hypot(*(wall - origin).T))]
    square = np.array([-mouth[1], mouth[0]]) * np.sign(
        mouth[0] * (farthest - origin)[1] - mouth[1] * (farthest - origin)[0]
    )
    for first in (square, farthest - origin):
        found = _straightened(wall, origin, _unit(first))
        if found is not None:
            return found
    return None


def _straightened(wall: Floats, origin: Floats, along: Floats) -> Middle | None:
    """The straight middle, found step by step from a first guess."""
    for _ in range(_ROUNDS):
        found = _sections(wall, origin, along)
        if found is None:
            return None
        at_mm, sides, mouth_mm, bottom_mm = found
        middle = sides.mean(axis=1)
        slope, offset = np.polyfit(at_mm, middle, 1)
        across = np.array([-along[1], along[0]])
        origin, along = origin + float(offset) * across, _unit(along + float(slope) * across)
    found = _sections(wall, origin, along)
    if found is None or float(np.abs(found[1].mean(axis=1)).max()) > STRAIGHT_MM:
        return None
    at_mm, sides, mouth_mm, bottom_mm = found
    return Middle(origin, along, mouth_mm, bottom_mm, at_mm, np.ptp(sides, axis=1))


def _sections(wall: Floats, origin: Floats, along: Floats) -> tuple[Floats, Floats, float, float] | None:
    """Sections of a slot across a line: where along it, the two sides, and where its mouth and its bottom are."""
    across = np.array([-along[1], along[0]])
    u, v = (wall - origin) @ along, (wall - origin) @ across
    bottoms = _crossings(v, u, 0.0)
    mouth_mm = float(max(u[0], u[-1]))
    if not len(bottoms) or (bottom_mm := float(bottoms.min())) <= mouth_mm:
        return None
    width_mm = float(abs(v[0] - v[-1]))
    far_mm = max(bottom_mm - width_mm, mouth_mm + 0.5 * (bottom_mm - mouth_mm))
    at_mm = np.linspace(mouth_mm, far_mm, _SECTIONS + 2)[1:-1]
    rows = [np.sort(_crossings(u, v, float(at))) for at in at_mm]
    if any(len(row) != 2 for row in rows):
        return None
    return at_mm, np.array(rows), mouth_mm, bottom_mm


def _crossings(x: Floats, y: Floats, at: float) -> Floats:
    """Where a line of points (x, y) passes `at` in x: the y there."""
    before, after = x[:-1] - at, x[1:] - at
    passes = (before < 0) != (after < 0)
    share = before[passes] / (before[passes] - after[passes])
    return np.asarray(y[:-1][passes] + share * (y[1:] - y[:-1])[passes])


def _unit(vector: Floats) -> Floats:
    return np.asarray(vector / max(math.hypot(*vector.tolist()), 1e-12))


_OPENS = 2 * math.tan(CORNER_RAD / 2)
"""Sides that open by more are those of a corner."""
_MOUTH_KERFS = 3.0
"""So many kerfs of a contour on either side of a slot belong to its mouth."""
MOST_FEATURES = 200
"""Features of a contour that slits are tried for: each takes up to half a second, and rings of noise have thousands."""


@dataclass(frozen=True, slots=True)
class Slit:
    """A slot of a contour that one pass opens: `line` is that of the torch's centre, `width_mm` where it is narrowest.

    The part loses `loss_mm` at each side.
    """

    contour: str
    slot: LostFeatureSpan
    line: Curve
    width_mm: float
    loss_mm: float

    def sentence(self, name: str, kerf_mm: float) -> str:
        """What is done with the slot, and what that costs."""
        x, y = self.slot.place
        return (
            f"{name} opens the slot of {self.contour} at ({x:z.1f}, {y:z.1f}), {self.width_mm:.2f} mm wide and "
            f"{self.slot.depth_mm:.1f} mm deep, in one pass: it becomes {kerf_mm:g} mm wide, the part loses "
            f"{self.loss_mm:.2f} mm at each side (cuts.narrow: slit)"
        )


@dataclass(frozen=True, slots=True)
class LostFeature:
    """A feature that the kerf would lose and no pass along its middle keeps, and why."""

    slot: LostFeatureSpan
    why: str


@cached_with_nest(most=8)
def with_slits(nest: Nest, kerf_mm: float) -> Nest:
    """The nest with a slit for every slot that one pass opens; it keeps the nest as drawn.

    Slits are numbered in each part, those of its holes first, along each contour.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part
    >>> outline = [(50, 50), (110, 50), (110, 80), (81, 80), (81, 60), (80, 60), (80, 80), (50, 80)]
    >>> made = with_slits(nest(200, 200, part("A", outline)), 1.5)
    >>> [(c.id, c.slot_of) for c in made.contours], made.contour("A.slit1").curve.as_rows()[-1]
    ([('A.slit1', 'A.outer'), ('A.outer', '')], [80.5, 60.75])
    """
    return with_parts(nest, tuple(_slit(part, kerf_mm) for part in nest.parts))


def _slit(part: Part, kerf_mm: float) -> Part:
    found = [slit for contour in _cut(part) for slit in slits_of(contour, kerf_mm)[0]]
    of = {contour.id: contour.source for contour in part}
    slits = tuple(
        Contour(f"{part.id}.slit{k}", part.id, "slit", slit.line, slot_of=slit.contour, source=of[slit.contour])
        for k, slit in enumerate(found, 1)
    )
    return replace(part, slits=slits) if slits else part


@cached_with_nest(most=4)
def features_cut_across(nest: Nest, kerf_mm: float) -> dict[str, tuple[LostFeatureSpan, ...]]:
    """By contour, the slots, notches and necks of a nest as it is cut that the torch cuts straight across."""
    slits: dict[str, list[Curve]] = {}
    for slit in (c for c in nest.contours if c.kind == "slit"):
        slits.setdefault(slit.slot_of, []).append(slit.curve)
    cut = [c for c in nest.contours if c.encloses]
    compensate_together(cut, kerf_mm)
    lost = lost_walls(cut, kerf_mm, {c.id: compensated(c, kerf_mm) for c in cut}, slits)
    return {name: tuple(one for one, _ in of) for name, of in lost.items()}


def narrow_because(nest: Nest, kerf_mm: float) -> dict[str, str]:
    """For every slit of a nest as it is cut, what it is for and what it costs; for contours what they do not get."""
    reasons: dict[str, str] = {}
    for name, lost in features_cut_across(nest, kerf_mm).items():
        places = "; ".join(one.sentence().removeprefix("the ") for one in lost[:MOST_TOLD])
        more = f"; and {len(lost) - MOST_TOLD} more" if len(lost) > MOST_TOLD else ""
        reasons[name] = (
            f"{name} is cut straight across what is narrower than the kerf of {kerf_mm:g} mm: {places}{more}"
        )
    for part in nest.parts:
        if part.slits:
            of = {slit.line: slit for contour in _cut(part) for slit in slits_of(contour, kerf_mm)[0]}
            reasons |= {c.id: of[c.curve].sentence(c.id, kerf_mm) for c in part.slits if c.curve in of}
    return reasons


def blocked_slits(nest: Nest, contour: Contour, kerf_mm: float) -> list[LostFeature]:
    """The slots of a contour that are slit, but whose slits would burn what is beside them: webs that are too thin."""
    part = nest.part_of[contour.part]
    own = {slit.line: slit for slit in slits_of(contour, kerf_mm)[0]}
    found = []
    for one in (c for c in part.slits if c.curve in own):
        line, half_mm = one.curve.line(CHORD_MM), kerf_mm / 2 - tolerance_mm(kerf_mm)
        near = [c.id for c in _cut(part) if c is not contour and c.line.dwithin(line, half_mm)]
        near += [c.id for c in part.slits if c is not one and c.line.dwithin(line, kerf_mm)]
        if near:
            found.append(LostFeature(own[one.curve].slot, f"the pass would burn through the web to {near[0]}"))
    return found


def _cut(part: Part) -> Iterator[Contour]:
    yield from (*part.holes, part.outer)


@lru_cache(maxsize=1 << 15)
def slits_of(contour: Contour, kerf_mm: float) -> tuple[tuple[Slit, ...], tuple[LostFeature, ...]]:
    """The slots of a contour that one pass opens, along the contour; and features that it would lose all the same."""
    slits: list[tuple[float, Slit]] = []
    unfit: list[LostFeature] = []
    walls = {wall: lost for lost, wall in lost_walls([contour], kerf_mm).get(contour.id, ())}
    if len(walls) > MOST_FEATURES:
        why = f"{contour.id} has {len(walls)} such features, and slits are tried for up to {MOST_FEATURES} of a contour"
        return (), tuple(LostFeature(lost, why) for lost in walls.values())
    fitted = {wall: _fitted(contour, lost, wall, kerf_mm) for wall, lost in walls.items()}
    passes = [fit.line for fit in fitted.values() if isinstance(fit, Slit)]
    left = lost_walls([contour], kerf_mm, None, {contour.id: passes}).get(contour.id, ()) if passes else ()
    for wall, fit in fitted.items():
        if isinstance(fit, str):
            unfit.append(LostFeature(walls[wall], fit))
        elif any(rest.dwithin(wall, NEAR_MM) for _, rest in left):
            unfit.append(LostFeature(walls[wall], "it forks or bends: one pass would leave some of it"))
        else:
            at_mm = contour.curve.project(fit.line.end)[0]
            slits.append((at_mm, fit))
    return tuple(slit for _, slit in sorted(slits, key=lambda row: row[0])), tuple(unfit)


def _fitted(contour: Contour, lost: LostFeatureSpan, wall: shapely.LineString, kerf_mm: float) -> Slit | str:
    """The slit of a slot, or why there is none."""
    middle = middle_of_slot(shapely.get_coordinates(wall))
    if middle is None:
        return "it has no straight middle"
    if middle.widths_mm.max() > kerf_mm + STRAIGHT_MM:
        return "it is wider than the kerf behind its mouth"
    if abs(middle.opening) > _OPENS:
        return "its sides open like a corner's"
    half_mm = kerf_mm / 2
    ends_mm = middle.bottom_mm - half_mm
    starts_mm = _start_mm(ring_of(contour, half_mm), middle, kerf_mm)
    if starts_mm is None or ends_mm - starts_mm < tolerance_mm(kerf_mm):
        return "its mouth is not open to waste"
    line = Curve.of([middle.point(starts_mm), middle.point(ends_mm)], closed=False)
    width_mm = middle.narrowest_mm(ends_mm)
    loss_mm = max((kerf_mm - width_mm) / 2, 0.0)
    if _burnt_mm(contour, line, half_mm) > loss_mm + STRAIGHT_MM:
        return "it narrows too much, or its end is not square to its middle"
    if _reaches_elsewhere(contour, wall, line, half_mm - tolerance_mm(kerf_mm), kerf_mm):
        return "the pass would burn the contour beside the slot"
    return Slit(contour.id, lost, line, width_mm, loss_mm)


def _start_mm(path: shapely.Geometry, middle: Middle, kerf_mm: float) -> float | None:
    """How far along a slot's middle the torch's path round the contour crosses it, outside the mouth.

    Where one side of the slot goes on beyond the other, the path runs beside the middle: then it is as far outside as
    if the mouth were open to both sides.
    """
    reach = shapely.LineString([middle.point(middle.mouth_mm), middle.point(middle.mouth_mm - 2 * kerf_mm)])
    points = shapely.get_coordinates(shapely.intersection(path, reach))
    if len(points):
        return float(((points - middle.origin) @ middle.along).max())
    width_mm = float(middle.widths_mm[0])
    outside_mm = middle.mouth_mm - math.sqrt(max(kerf_mm**2 - width_mm**2, 0.0)) / 2
    beside_mm = shapely.distance(path, shapely.Point(middle.point(outside_mm)))
    return outside_mm if beside_mm < (kerf_mm - width_mm) / 2 + tolerance_mm(kerf_mm) else None


def _burnt_mm(contour: Contour, line: Curve, half_mm: float) -> float:
    """How deep a pass along a line burns into the part that a contour bounds."""
    burnt = shapely.buffer(line.line(CHORD_MM), half_mm, quad_segs=32)
    area = shapely.make_valid(contour.curve.polygon(CHORD_MM))
    lost = burnt & area if contour.kind == "outer" else burnt - area
    points = shapely.points(shapely.get_coordinates(shapely.segmentize(lost, half_mm / 4)))
    return float(shapely.distance(shapely.boundary(area), points).max()) if len(points) else 0.0


def _reaches_elsewhere(
    contour: Contour, wall: shapely.LineString, line: Curve, reach_mm: float, kerf_mm: float
) -> bool:
    """Whether a pass burns its own contour where the slot and its mouth are not."""
    curve, more_mm = contour.curve, _MOUTH_KERFS * kerf_mm
    ends: list[Point] = [(float(x), float(y)) for x, y in shapely.get_coordinates(wall)[[0, -1]].tolist()]
    one_mm, other_mm = (curve.project(end)[0] for end in ends)
    around_mm = curve.length_mm
    forward_mm = (other_mm - one_mm) % around_mm
    if abs(forward_mm - wall.length) > abs(around_mm - forward_mm - wall.length):
        other_mm, forward_mm = one_mm, around_mm - forward_mm
    left_mm = around_mm - forward_mm - 2 * more_mm
    if left_mm <= 0:
        return False
    rest = curve.between((other_mm + more_mm) % around_mm, left_mm).line(CHORD_MM)
    return bool(rest.dwithin(line.line(CHORD_MM), reach_mm))
