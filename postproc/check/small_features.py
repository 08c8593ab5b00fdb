"""Small holes and narrow slots as the profile asks for them, found anew: cut, marked, slit or left out."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import CutSequence, Side
from kerfwise.encoder.display import join_names
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest, cached_with_nest
from kerfwise.encoder.scrap import with_scrap
from kerfwise.encoder.small_holes import HoleLimits
from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.profile.technique import Technique

from .burn_pieces import stretches_of
from .gouging import metal_of_parts
from .jets import as_burnt
from .matching import Matcher
from .plan_runs import slit_ends
from .result import normalize_name
from .ring_coverage import total_mm, union
from .torch_run import TorchRun, line_of, tolerance_mm

# The check measures holes in its own way, from fine chords, and draws itself the cross that is to stand at the middle
# of a hole that is only marked.

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
class JudgedNest:
    """The nest that a plan or program is judged by, the holes that are not cut in it, and the feeds in the others.

    `shares` are the least and the greatest share of the cut feed that a hole may be cut at, by contour; 1 elsewhere.
    """

    nest: Nest
    small: tuple[SmallHole, ...]
    shares: Mapping[str, Shares] = field(default_factory=dict)


def judged_nest(nest: Nest, profile: Technique) -> JudgedNest:
    """The drawing's nest as the profile has it cut; kept with the drawing, for a plan and its program."""
    scrap, drawn = profile.cuts.scrap, profile.without_losses(nest.drawn or nest)
    judged = _judged(drawn, profile.hole_limits(), profile.material.kerf_mm, scrap.grid_mm, scrap.remnant)
    burnt = as_burnt(judged.nest, profile)
    return judged if burnt is judged.nest else replace(judged, nest=burnt)


def _treats(limits: HoleLimits) -> bool:
    """Whether small holes are marked or left out; else no nest with such is cut."""
    return limits.under in ("spot", "skip")


@cached_with_nest(most=2)
def _judged(drawn: Nest, limits: HoleLimits, kerf_mm: float, grid_mm: float | None, remnant: Side | None) -> JudgedNest:
    under_mm = max(limits.least_mm, limits.room_mm) if _treats(limits) else limits.least_mm
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
            if not _treats(limits) or why_not is not None:
                holes.append(hole)
            elif limits.under == "spot":
                marks.append(_cross(hole, area, limits))
        changed = len(holes) != len(part.holes)
        parts.append(replace(part, holes=tuple(holes), marks=tuple(marks)) if changed else part)
    lined = with_scrap(drawn, kerf_mm, grid_mm, remnant)
    changed_parts = replace(lined, parts=tuple(parts), drawn=drawn.drawn or drawn) if small else lined
    return JudgedNest(changed_parts, tuple(small), shares)


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
    return Contour(hole.id, hole.part, "mark", Curve.of(steps.tolist(), closed=False), source=hole.source)


def small_holes(judged: JudgedNest, cuts: CutSequence, runs: Sequence[TorchRun], profile: Technique) -> list[Violation]:
    """Holes that must not be cut through, and are; holes for which the profile refuses the nest."""
    limits, found = profile.hole_limits(), []
    strays = [run for run in runs if not run.marks and (run.contour is None or run.contour.kind == "mark")]
    positions = cuts.positions()
    cut_names = {cut.contour for cut in cuts[: cuts.made]}
    for hole in (hole for hole in judged.small if hole.contour.id not in cut_names):
        name = hole.contour.id
        size = f"{name} is {hole.across_mm:.2f} mm across, holes under {_limit_mm(hole, limits):g} mm are not cut"
        at = (positions[name],) if name in positions else ()
        if not _treats(limits):
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


def small_hole_notes(judged: JudgedNest, profile: Technique) -> Iterator[str]:
    """What the profile does not have cut: a check never passes over it in silence."""
    limits = profile.hole_limits()
    names = [hole.contour.id for hole in judged.small if hole.why_not is None]
    if not names or not _treats(limits):
        return
    holes = "a small hole is" if len(names) == 1 else f"{len(names)} small holes are"
    done = "not cut but marked at the middle" if limits.under == "spot" else "left out"
    yield f"{holes} {done} (small_holes.under: {limits.under}): {join_names(names, _NAMED)}"


# Slots narrower than the kerf that one pass along their middle opens, where the profile has them slit.
#
# The check does not look for slots. It takes each pass that a plan or program makes beside the contours, and measures
# the waste to both sides of it: the pass has to run in a slot narrower than the kerf, in its middle, and to end half
# a kerf before the slot's end. The part may lose half of what the slot is narrower than the kerf. Slots without such
# a pass are left uncut, which `features-kept` sees.

NARROW = "cuts.narrow: slit"
_NAME = re.compile(r"CUT \d+ (?P<contour>.+\.slit\d+) ZONE \d+\b", re.IGNORECASE)
_SLIT = re.compile(r"(?P<part>.+)\.slit\d+", re.IGNORECASE)
_SLIT_STEP_MM = 0.25
_LEAST = 17
_SLIT_SLACK_MM = 0.01
_AS_WIDE_MM = 0.03
"""A slot as wide as the kerf is one that no round enters; so much more is what drawings leave."""
_MOST_TOLD = 5


@dataclass(frozen=True, eq=False, slots=True)
class Slot:
    """The slot that a pass opens: how wide it is where it is narrowest, how far the pass runs in it, mm, and where.

    `off_mm` is how far the pass leaves the middle at most, `beyond_mm` how much nearer than half a kerf it comes to the
    slot's end; `width_mm` is None where the pass runs in no slot narrower than the kerf.
    """

    width_mm: float | None
    depth_mm: float
    place: Point
    off_mm: float
    beyond_mm: float

    def loss_mm(self, kerf_mm: float) -> float:
        """What the part loses at each side."""
        return 0.0 if self.width_mm is None else max(kerf_mm - self.width_mm, 0.0) / 2


Slots = Mapping[str, Slot]
"""By the contour id of the slit."""
Pass = tuple[str, Point, Point]
"""The name of a pass along a slot, where it begins at the mouth, and where it ends."""


def with_passes(nest: Nest, passes: Iterable[Pass], profile: Technique) -> tuple[Nest, Slots]:
    """The nest with the passes as slits, where the profile has slots slit, and the slots that they open."""
    if profile.cuts.narrow != "slit":
        return nest, {}
    kerf_mm = profile.material.kerf_mm
    metal = dict(zip((part.id for part in nest.parts), metal_of_parts(nest), strict=True))
    contours_of: dict[str, list[Contour]] = {part.id: [] for part in nest.parts}
    slots: dict[str, Slot] = {}
    for name, start, end in passes:
        found = _SLIT.fullmatch(name)
        if found is None or found["part"] not in contours_of or name in slots or start == end:
            continue
        part = nest.part_of[found["part"]]
        line = Curve.of([start, end], closed=False)
        beside = min((part.outer, *part.holes), key=lambda c: c.line.distance(shapely.Point(end)))
        contours_of[part.id].append(Contour(name, part.id, "slit", line, slot_of=beside.id, source=beside.source))
        slots[name] = _measured(np.array(start), np.array(end), metal[part.id], kerf_mm)
    parts = tuple(replace(part, slits=tuple(contours_of[part.id])) for part in nest.parts)
    return (replace(nest, parts=parts, drawn=nest.drawn or nest) if slots else nest), slots


def passes_of_cuts(cuts: CutSequence) -> Iterator[Pass]:
    """The passes that a plan makes: from where a slit is entered to where the torch goes off."""
    for cut in cuts:
        if _SLIT.fullmatch(cut.contour):
            yield cut.contour, cut.entry, cut.end


def passes_of_program(nest: Nest, program: NcProgram, profile: Technique) -> list[Pass]:
    """The passes that a program makes, and those that it says an earlier one has made.

    A pass is a path with the torch that goes round no contour. Its last block runs along the slot, what comes before
    leads to that. It is called what the comment before it says, else by a number.
    """
    if profile.cuts.narrow != "slit":
        return []
    kerf_mm, known = profile.material.kerf_mm, {normalize_name(part.id): part.id for part in nest.parts}
    found = [(_known(name, known), start, end) for name, start, end in slit_ends(program.comments)]
    burns = [burn for burn in program.burns if burn.tool == 0 and burn.path.segments]
    lines = [line for burn in burns if (line := line_of(burn.path)) is not None]
    matcher = Matcher(nest, kerf_mm)
    matches = matcher.match(lines, [False] * len(lines), [None] * len(lines))
    rings = shapely.STRtree([c.line for c in nest.contours if c.encloses])
    names = [c.part for c in nest.contours if c.encloses]
    taken = {name for name, _, _ in found}
    along = _on_rings(burns, matcher.rings, kerf_mm)
    for number, (burn, match) in enumerate(zip(burns, matches, strict=True)):
        if (match is not None and match.deviation_mm <= tolerance_mm(kerf_mm)) or number in along:
            continue
        points = burn.path.vertices[:, :2]
        part = names[int(rings.nearest(shapely.Point(points[-1])))]
        name = _called(burn, part, taken, known)
        taken.add(name)
        found.append((name, _xy(points[-2]), _xy(points[-1])))
    return found


def _on_rings(burns: Sequence[Burn], rings: Sequence[shapely.LineString | None], kerf_mm: float) -> set[int]:
    """Burns that run along torch rings, if not all round one: at least half of the way."""
    along = stretches_of([burn.path for burn in burns], rings, range(len(burns)), tolerance_mm(kerf_mm))
    found = set()
    for k, row in along.items():
        on = union(np.array([(s.low_mm, s.high_mm) for s in row]))
        if total_mm(on) >= burns[k].path.length_mm / 2:
            found.add(k)
    return found


def _called(burn: Burn, part: str, taken: Collection[str], known: Mapping[str, str]) -> str:
    """What a comment calls a pass, where that is one of this part; else the part's next slit."""
    words = _NAME.search(burn.comment)
    contour = _known(words["contour"], known) if words else ""
    if contour.rpartition(".")[0] == part and contour not in taken:
        return contour
    return next(name for k in range(1, len(taken) + 2) if (name := f"{part}.slit{k}") not in taken)


def _known(name: str, known: Mapping[str, str]) -> str:
    """A pass's name with its part as the nest spells it."""
    part, _, number = name.rpartition(".")
    return f"{known.get(normalize_name(part), part)}.{number.lower()}"


def _measured(start: Floats, end: Floats, metal: shapely.Geometry, kerf_mm: float) -> Slot:
    """The waste to both sides of a pass, and before its end."""
    length_mm = float(np.hypot(*(end - start)))
    along = (end - start) / length_mm
    aside = np.array([-along[1], along[0]])
    [before_mm] = _gaps(end[None, :], along, metal, 2 * kerf_mm).tolist()
    at_mm = np.linspace(0, length_mm + before_mm, max(_LEAST, int(length_mm / _SLIT_STEP_MM)))[:-1]
    at = start + at_mm[:, None] * along
    left, right = (_gaps(at, sign * aside, metal, kerf_mm) for sign in (1, -1))
    width_mm, within = left + right, left + right < kerf_mm + _AS_WIDE_MM
    beyond_mm = max(kerf_mm / 2 - before_mm, 0.0)
    if not within.any():
        return Slot(None, 0.0, _xy(start), 0.0, beyond_mm)
    first, on_pass = int(np.argmax(within)), within & (at_mm <= length_mm)
    return Slot(
        # The middle of a pass along a shallow slot stays before its mouth: then it is as wide as behind that.
        float(width_mm[on_pass].min() if on_pass.any() else width_mm[within].max()),
        length_mm + before_mm - float(at_mm[first]),
        _xy(at[first]),
        float(np.abs(left - right)[on_pass if on_pass.any() else within].max()) / 2,
        beyond_mm,
    )


def _gaps(at: Floats, ahead: Floats, metal: shapely.Geometry, reach_mm: float) -> Floats:
    """How far it is from points to metal in one direction; `reach_mm` where there is none so near, 0 in metal."""
    rays = shapely.linestrings(np.stack([at, at + reach_mm * ahead], axis=1))
    gaps_mm = shapely.distance(shapely.intersection(rays, metal), shapely.points(at))
    return np.asarray(np.nan_to_num(gaps_mm, nan=reach_mm))


def misplaced(slots: Slots, cuts: CutSequence, kerf_mm: float) -> Iterator[Violation]:
    """Passes that run in no narrow slot, beside its middle, or on beyond its end."""
    positions, allowed_mm = cuts.positions(), tolerance_mm(kerf_mm) + _SLIT_SLACK_MM
    for name, slot in slots.items():
        k = positions.get(name, 0)
        at = f"cut {k} ({name}) at ({slot.place[0]:.1f}, {slot.place[1]:.1f})"
        if k <= cuts.made:
            continue
        if slot.width_mm is None:
            yield Violation("features-kept", (name,), f"{at} runs along no slot narrower than the kerf", (k,))
        elif slot.off_mm > allowed_mm:
            text = f"{at} runs up to {slot.off_mm:.2f} mm beside the middle of the slot"
            yield Violation("features-kept", (name,), text, (k,))
        elif slot.beyond_mm > allowed_mm:
            text = f"{at} burns {slot.beyond_mm:.2f} mm beyond the end of the slot"
            yield Violation("features-kept", (name,), text, (k,))


def slot_notes(nest: Nest, slots: Slots, kerf_mm: float) -> Iterator[str]:
    """What parts lose to passes along their slots: a check never passes over it in silence."""
    notes = [
        f"{name} opens a slot of {nest.contour(name).slot_of} at ({slot.place[0]:.1f}, {slot.place[1]:.1f}), "
        f"{slot.width_mm:.2f} mm wide and {slot.depth_mm:.1f} mm deep, by one pass: it becomes {kerf_mm:g} mm wide, "
        f"the part loses {slot.loss_mm(kerf_mm):.2f} mm at each side ({NARROW})"
        for name, slot in slots.items()
        if slot.width_mm is not None
    ]
    yield from notes[:_MOST_TOLD]
    if len(notes) > _MOST_TOLD:
        most_mm = max(slot.loss_mm(kerf_mm) for slot in slots.values())
        yield f"{len(notes) - _MOST_TOLD} more slots are opened so; no part loses more than {most_mm:.2f} mm at a side"


def burns_by_contour(runs: Sequence[TorchRun], opened: Sequence[Contour]) -> Mapping[str, list[shapely.LineString]]:
    """The passes along slots of each contour that has any: slits that were cut before, and those of runs."""
    found: dict[str, list[shapely.LineString]] = {}
    passes = [(slit, slit.line) for slit in opened]
    passes += [(run.contour, run.loop) for run in runs if run.contour is not None]
    for contour, line in passes:
        if contour.slot_of:
            found.setdefault(contour.slot_of, []).append(line)
    return found


def slits_of_made(nest: Nest, cuts: CutSequence) -> list[Contour]:
    """The slits among the cuts that were made before a stop."""
    contours = (nest.contour(cut.contour) for cut in cuts[: cuts.made] if cut.contour in nest.index)
    return [contour for contour in contours if contour.kind == "slit"]


def _xy(point: Floats) -> Point:
    return float(point[0]), float(point[1])
