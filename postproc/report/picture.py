"""A nest, and a plan if there is one, as a scene."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kerfwise.encoder.cut import Cut
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan, PlannedCut
from kerfwise.models.plan.read_plan import expect_plan_of

from . import scene
from .label_fit import TextPlace
from .labels import Label, nested_metal, number_areas, place_labels, place_names
from .layers import (
    across_layer,
    bevel_layer,
    contour_layer,
    direction_layer,
    home_layer,
    lead_layer,
    name_layer,
    near_parts,
    number_layer,
    out_layer,
    outlines_of_parts,
    part_layer,
    pierce_layer,
    sheet_layer,
    stretch_layer,
    tab_layer,
    travel_layer,
    zone_layer,
    zone_map,
)
from .legend import Clock, duration, footer_layer, header_layer, nest_name
from .scene import CAP_HEIGHT, Dot, Item, Scene, SceneLayer, Style, TextLine, View, Window, text_width

_READABLE = 12.0  # pixels that a number should be high in a PNG
_MAX_PIXELS = 4000.0
_LEAST_NUMBER, _LEAST_NAME = 5.0, 4.5  # points on paper: numbers are no smaller, smaller names of parts are not drawn
_SPOT_PROPORTION = (1.6, 2.6)  # least and greatest width for a height of 1


@dataclass(frozen=True, slots=True)
class Spot:
    """The contours that a picture is about, and a sentence on why."""

    contours: frozenset[str]
    caption: str = ""


@dataclass(frozen=True, eq=False, slots=True)
class Sketch:
    """All of a picture but its header, which tells what a plan does not keep of its rules."""

    nest: Nest
    view: View
    drawn: _Drawn
    caption: str

    def scene(self, plan: Plan | None) -> Scene:
        """The whole picture; the plan may know more of its rules by now, and has the same cuts."""
        drawn = self.drawn
        around = (
            header_layer(self.nest, plan, self.view, self.caption),
            footer_layer(self.view, drawn.clock, drawn.kinds),
        )
        enlarge = _enlargement(drawn.numbers, self.view)
        return Scene(self.view.width, self.view.height, (*drawn.layers, *around), nest_name(self.nest, plan), enlarge)


def prepare(nest: Nest, home: Point = (0.0, 0.0)) -> None:
    """Find out what a picture of any plan of a whole nest needs of the nest alone: `sketch` takes it from there."""
    view = View.of(_whole(nest, home), len(nest.contours), _used_mm2(nest))
    number_areas(nest, view.number_size * view.mm)
    nested_metal(nest, tuple(hole.id for part in nest.parts for hole in part.holes))
    near_parts(nest)
    outlines_of_parts(nest, view)


def sketch(nest: Nest, plan: Plan | None = None, home: Point = (0.0, 0.0), spot: Spot | None = None) -> Sketch:
    """What takes long of a picture, see `make_scene`.

    Raises InputError if the plan cuts, or the spot names, a contour that the nest does not have.
    """
    cuts = tuple(p.cut for p in plan.cuts) if plan else ()
    expect_known(nest, plan, sorted(spot.contours) if spot else ())
    view, window = _frame(nest, cuts, home, spot)
    caption = spot.caption if spot else f"resumed after cut {plan.resumed_after}" if plan and plan.already else ""
    return Sketch(nest, view, _drawn(nest, plan, home, spot, view, window), caption)


def make_scene(nest: Nest, plan: Plan | None = None, home: Point = (0.0, 0.0), spot: Spot | None = None) -> Scene:
    """The picture of a nest: of the whole sheet, or zoomed to a spot.

    Raises InputError if the plan cuts, or the spot names, a contour that the nest does not have.
    """
    return sketch(nest, plan, home, spot).scene(plan)


def bare_picture(nest: Nest, plan: Plan, home: Point, width: float, most_high: float) -> Scene:
    """The drawing alone, without title and key, on a page of its own size.

    It is `width` wide, and lower than that where the whole would be higher than `most_high`. Raises InputError if the
    plan cuts a contour that the nest does not have.
    """
    cuts = tuple(p.cut for p in plan.cuts)
    expect_known(nest, plan)
    x0, y0, x1, y1 = _whole(nest, home if cuts else None)
    scale = min(width / max(x1 - x0, 1e-6), most_high / max(y1 - y0, 1e-6))
    pitch = scale * math.sqrt(_used_mm2(nest) / max(len(nest.contours), 1))
    left, high = (width - (x1 - x0) * scale) / 2, (y1 - y0) * scale
    view = View((x0, y0, x1, y1), scale, left, width, high, pitch, top=0.0)
    drawn = _drawn(nest, plan, home, None, view, None, names=True)
    return Scene(width, high, drawn.layers, nest_name(nest, plan))


@dataclass(frozen=True, eq=False, slots=True)
class _Drawn:
    """The layers of a drawing, the colours of its travel, what is to be told in its key, and the layer of numbers."""

    layers: tuple[SceneLayer, ...]
    clock: Clock | None
    kinds: frozenset[str]
    numbers: SceneLayer


def _drawn(
    nest: Nest,
    plan: Plan | None,
    home: Point,
    spot: Spot | None,
    view: View,
    window: shapely.Polygon | None,
    names: bool = False,
) -> _Drawn:
    """The drawing; with `names` parts have theirs, beside the numbers of their cuts."""
    cuts = tuple(p.cut for p in plan.cuts) if plan else ()
    order = {cut.contour: k for k, cut in enumerate(cuts, 1)}
    cuts_made = plan.resumed_after if plan else 0
    out = frozenset(p.cut.contour for p in plan.already_cut) if plan else frozenset()
    zones = zone_map(nest, {nest.contour(c.contour).part: c.zone for c in cuts})
    named = spot.contours if spot else frozenset()
    parts = {nest.contour(c).part for c in named}
    faded = frozenset(p.id for p in nest.parts if p.id not in parts) if spot else frozenset()

    size_mm = view.number_size * view.mm
    places = place_labels(nest, _labels(nest, cuts, named, size_mm, cuts_made), size_mm, window)
    if names:
        places = {name: replace(p, size_mm=max(p.size_mm, _LEAST_NUMBER * view.mm)) for name, p in places.items()}
    called = place_names(nest, places, size_mm, _LEAST_NAME * view.mm) if names else {}
    layers = [sheet_layer(nest, view), part_layer(nest, view, zones, order, faded, cuts_made)]
    if out:
        layers.append(out_layer(nest, view, out))
    if spot is None and not (names and len(set(zones.of_part.values())) == 1):  # on paper a single zone says nothing
        layers.append(zone_layer(nest, view, zones, [p.box() for p in (*places.values(), *called.values())]))
    layers.append(contour_layer(nest, view, order, named, out))
    clock = None
    begun = [] if plan is None else [(k - cuts_made, planned.cut) for k, planned in plan.begun if k > cuts_made]
    if cuts:
        clock, shares = _clock(cuts)
        pierced = {} if plan is None else {k - cuts_made: holes for k, holes in plan.sequence().pierced.items()}
        layers += [
            travel_layer(view, cuts, home, shares, pierced, begun),
            *([stretch_layer(nest, view, begun)] if begun else []),
            *([bevel_layer(view, plan.cuts)] if plan is not None and any(one.passes for one in plan.cuts) else []),
            direction_layer(nest, view, cuts),
            lead_layer(view, cuts),
            pierce_layer(nest, view, cuts),
            home_layer(view, home),
        ]
    kinds = _kinds(nest, plan, stretches=bool(begun))
    if "tab" in kinds:
        layers.append(tab_layer(nest, view, cuts))
    if plan is not None and "across" in kinds:
        layers.append(across_layer(view, plan.cuts))
    numbers = number_layer(nest, view, places, order)
    layers += [name_layer(nest, view, called), numbers] if called else [numbers]
    if plan is not None and "wait" in kinds:
        layers.append(wait_layer(view, plan.cuts, list(places.values())))
    return _Drawn(tuple(layers), clock, kinds, numbers)


def _kinds(nest: Nest, plan: Plan | None, stretches: bool) -> frozenset[str]:
    """What the key has to tell; `stretches` says that some were begun before."""
    planned = () if plan is None else plan.cuts
    cuts = [one.cut for one in planned]
    bevelled = any(one.tilt_deg for cut in planned for one in cut.passes)
    pierced = [cut.pierce for cut in cuts if nest.contour(cut.contour).kind != "mark"]
    there = {
        "stretch": stretches,
        "bevel": bevelled,
        "below": bevelled,
        "tab": any(cut.tabs for cut in cuts),
        "across": any(one.across for one in planned),
        "further": any(cut.torch > 1 for cut in cuts),
        "pass": plan is not None and bool(plan.pierces),
        "small": bool(nest.not_cut),
        "edge": not all(shapely.intersects_xy(nest.sheet.polygon, *pierce) for pierce in pierced),
        "kerf": any(cut.span is not None and not cut.linked for cut in cuts),
        "out": plan is not None and bool(plan.already_cut),
        "wait": plan is not None and bool(plan.waits),
    }
    kinds = {"pierce", "home", *(nest.contour(cut.contour).kind for cut in cuts)}
    return frozenset(kinds | {name for name, is_there in there.items() if is_there})


def _frame(nest: Nest, cuts: tuple[Cut, ...], home: Point, spot: Spot | None) -> tuple[View, shapely.Polygon | None]:
    if spot is None:
        return View.of(_whole(nest, home if cuts else None), len(nest.contours), _used_mm2(nest)), None
    window = _around(nest, spot)
    seen = shapely.box(*window)
    inside = shapely.intersects(np.array([c.line for c in nest.contours]), seen)
    return View.of(window, int(inside.sum()), seen.area), seen


def _whole(nest: Nest, home: Point | None) -> Window:
    """The sheet, and the torch's home where it leaves from one."""
    x0, y0, x1, y1 = nest.sheet.bounds
    return (
        (x0, y0, x1, y1) if home is None else (min(x0, home[0]), min(y0, home[1]), max(x1, home[0]), max(y1, home[1]))
    )


def _around(nest: Nest, spot: Spot) -> Window:
    """The contours in question with air around them, in a window of pleasant proportions; less air beyond the sheet."""
    x0, y0, x1, y1 = shapely.GeometryCollection([nest.contour(c).line for c in sorted(spot.contours)]).bounds
    air = 0.25 * max(x1 - x0, y1 - y0)
    left, bottom, right, top = nest.sheet.bounds
    less = 0.2 * air  # contours may lie beside the sheet themselves
    x0, x1 = max(x0 - air, min(x0, left) - less), min(x1 + air, max(x1, right) + less)
    y0, y1 = max(y0 - air, min(y0, bottom) - less), min(y1 + air, max(y1, top) + less)
    wide, high = x1 - x0, y1 - y0
    x_air, y_air = max(_SPOT_PROPORTION[0] * high - wide, 0) / 2, max(wide / _SPOT_PROPORTION[1] - high, 0) / 2
    return x0 - x_air, y0 - y_air, x1 + x_air, y1 + y_air


def _used_mm2(nest: Nest) -> float:
    """Area of the rectangle around all parts; of the sheet if there are none."""
    outlines = shapely.GeometryCollection([p.outer.line for p in nest.parts])
    return float(shapely.envelope(outlines).area) if nest.parts else float(nest.sheet.polygon.area)


def _labels(
    nest: Nest, cuts: tuple[Cut, ...], named: frozenset[str], size_mm: float, cuts_made: int
) -> dict[str, Label]:
    """Order numbers with a plan; without one the names of the parts, or of the contours in question."""
    if cuts:
        return {cut.contour: _number(nest, k, cut, named, size_mm) for k, cut in enumerate(cuts, cuts_made + 1)}
    if named:
        return {c: Label(c) for c in sorted(named)}
    return {p.outer.id: Label(p.id) for p in nest.parts}


def _number(nest: Nest, order: int, cut: Cut, named: frozenset[str], size_mm: float) -> Label:
    text = f"{order}  {cut.contour}" if cut.contour in named else str(order)
    leads = tuple(lead for lead in (cut.lead_in, cut.lead_out) if lead is not None)
    return Label(text, _beside_entry(nest, cut, size_mm), leads)


def _beside_entry(nest: Nest, cut: Cut, size_mm: float) -> Point:
    """A little after the entry in cutting direction, so that the number does not stand on the torch's way in."""
    curve = nest.contour(cut.contour).curve
    if not curve.closed:
        return cut.entry
    run = curve.towards(cut.direction)
    dx, dy = run.tangent_at(run.project(cut.entry)[0])
    return cut.entry[0] + 1.2 * size_mm * dx, cut.entry[1] + 1.2 * size_mm * dy


def _clock(cuts: tuple[Cut, ...]) -> tuple[Clock, list[float]]:
    """The clock, and the moment (0 … 1) at which each idle travel begins, the way home last."""
    total_s = cuts[-1].end_s
    if total_s > 0:
        return Clock(total_s, True), [0.0, *(c.end_s / total_s for c in cuts)]
    return Clock(len(cuts), False), [k / len(cuts) for k in range(len(cuts) + 1)]


def _enlargement(numbers: SceneLayer, view: View) -> float:
    """Pixels a page unit for a PNG in which most numbers can be read."""
    sizes = [item.size for item in numbers.items if isinstance(item, TextLine)]
    wanted = _READABLE / float(np.quantile(sizes, 0.25)) if sizes else 1.0
    return min(max(wanted, 1.25), _MAX_PIXELS / max(view.width, view.height))


# The layer that shows where the torch waits for metal to cool, and for how long.

_LEAST_RADIUS = 3.0
_ROUND = tuple(k * math.pi / 4 for k in (0, 4, 2, 6, 1, 7, 3, 5))
"""Where a time may stand about its ring, the best first: right, left, above, below, then the corners."""
_FARTHER = (1.0, 2.0, 3.5)
"""How far from the ring, in heights of the text."""


def wait_layer(view: View, cuts: Sequence[PlannedCut], places: Sequence[TextPlace]) -> SceneLayer:
    """A ring about every pierce over which the torch waits, off, and how long.

    The times stand clear of each other and of the labels in `places`, where there is room.
    """
    taken = [shapely.Polygon(view.xy(shapely.get_coordinates(place.box()))) for place in places]
    rings: list[Item] = []
    times: list[Item] = []
    for k, planned in enumerate(cuts, 1):
        if planned.dwell_s <= 0:
            continue
        at, radius = view.point(planned.cut.pierce), max(2.4 * view.dot_radius, _LEAST_RADIUS)
        rings.append(Dot(*at, radius, Style(stroke=scene.WAIT, width=max(0.35 * radius, 1.2)), k))
        time, box = _beside(view, at, radius, f"wait {wait_text(planned.dwell_s)}", taken, k)
        taken.append(box)
        times.append(time)
    return SceneLayer("waits", (*rings, *times))


def wait_text(wait_s: float) -> str:
    """A wait for people, short ones to a tenth of a second.

    Examples
    --------
    >>> wait_text(2.25), wait_text(42.0), wait_text(75.2)
    ('2.2 s', '42 s', '1 min 15 s')
    """
    return f"{round(wait_s, 1):g} s" if wait_s < 60 else duration(wait_s)


def _beside(
    view: View, at: Point, radius: float, text: str, taken: Sequence[shapely.Polygon], cut: int
) -> tuple[TextLine, shapely.Polygon]:
    """The text where it covers least of what is taken, and its box."""
    size = view.number_size
    page = shapely.box(0, 0, view.width, view.height)
    wide, high = text_width(text, size, bold=True), size * CAP_HEIGHT
    found: list[tuple[float, Point, shapely.Polygon]] = []
    for far in _FARTHER:
        for angle in _ROUND:
            along, up = math.cos(angle), math.sin(angle)
            x = at[0] + along * (radius + far * 0.5 * high + wide / 2)
            y = at[1] - up * (radius + far * 0.5 * high + high / 2)
            box = shapely.box(x - wide / 2, y - high / 2, x + wide / 2, y + high / 2)
            covered = sum(box.intersection(other).area for other in taken) + 10 * box.difference(page).area
            found.append((round(covered, 3), (x, y), box))
    _, (x, y), box = min(found, key=lambda spot: spot[0])
    return TextLine(x, y, text, size, scene.WAIT, bold=True, halo=scene.PAGE, cut=cut), box


# Whether a picture's plan is one of its nest.


def expect_known(nest: Nest, plan: Plan | None, named: Iterable[str] = ()) -> None:
    """Say that a plan, or a list of contours, is not of this nest.

    Raises InputError if the plan is not one of this nest, or the list names a contour that the nest does not have.
    """
    if plan is not None:
        expect_plan_of(plan, nest)
    if unknown := [name for name in named if name not in nest.index]:
        raise InputError(
            f"no contour {unknown[0]!r} in the nest ({len(unknown)} unknown in all)", file=nest.file or None
        )
