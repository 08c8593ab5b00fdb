"""Slots narrower than the kerf that one pass along their middle opens, where the profile has them slit.

The check does not look for slots. It takes each pass that a plan or program makes beside the contours, and measures the
waste to both sides of it: the pass has to run in a slot narrower than the kerf, in its middle, and to end half a kerf
before the slot's end. The part may lose half of what the slot is narrower than the kerf. Slots without such a pass are
left uncut, which `features-kept` sees.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Violation

from .covering.intervals import total_mm, union
from .covering.sharing import stretches_of
from .matching import Matcher
from .metal import metal_of_parts
from .names import folded
from .program_rules import tolerance_mm
from .resumed import told_ends
from .torch_run import TorchRun, line_of

NARROW = "cuts.narrow: slit"
_NAME = re.compile(r"CUT \d+ (?P<contour>.+\.slit\d+) ZONE \d+\b", re.IGNORECASE)
_SLIT = re.compile(r"(?P<part>.+)\.slit\d+", re.IGNORECASE)
_STEP_MM = 0.25
_LEAST = 17
_SLACK_MM = 0.01
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


def with_passes(nest: Nest, passes: Iterable[Pass], profile: Profile) -> tuple[Nest, Slots]:
    """The nest with the passes as slits, where the profile has slots slit, and the slots that they open."""
    if profile.cuts.narrow != "slit":
        return nest, {}
    kerf_mm = profile.material.kerf_mm
    metal = dict(zip((part.id for part in nest.parts), metal_of_parts(nest), strict=True))
    made: dict[str, list[Contour]] = {part.id: [] for part in nest.parts}
    slots: dict[str, Slot] = {}
    for name, start, end in passes:
        found = _SLIT.fullmatch(name)
        if found is None or found["part"] not in made or name in slots or start == end:
            continue
        part = nest.part_of[found["part"]]
        line = Curve.of([start, end], closed=False)
        beside = min((part.outer, *part.holes), key=lambda c: c.line.distance(shapely.Point(end)))
        made[part.id].append(Contour(name, part.id, "slit", line, slot_of=beside.id))
        slots[name] = _measured(np.array(start), np.array(end), metal[part.id], kerf_mm)
    parts = tuple(replace(part, slits=tuple(made[part.id])) for part in nest.parts)
    return (replace(nest, parts=parts, drawn=nest.drawn or nest) if slots else nest), slots


def passes_of_cuts(cuts: CutSequence) -> Iterator[Pass]:
    """The passes that a plan makes: from where a slit is entered to where the torch goes off."""
    for cut in cuts:
        if _SLIT.fullmatch(cut.contour):
            yield cut.contour, cut.entry, cut.end


def passes_of_program(nest: Nest, program: NcProgram, profile: Profile) -> list[Pass]:
    """The passes that a program makes, and those that it says an earlier one has made.

    A pass is a path with the torch that goes round no contour. Its last block runs along the slot, what comes before
    leads to that. It is called what the comment before it says, else by a number.
    """
    if profile.cuts.narrow != "slit":
        return []
    kerf_mm, known = profile.material.kerf_mm, {folded(part.id): part.id for part in nest.parts}
    found = [(_known(name, known), start, end) for name, start, end in told_ends(program.comments)]
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
    told = _known(words["contour"], known) if words else ""
    if told.rpartition(".")[0] == part and told not in taken:
        return told
    return next(name for k in range(1, len(taken) + 2) if (name := f"{part}.slit{k}") not in taken)


def _known(name: str, known: Mapping[str, str]) -> str:
    """A pass's name with its part as the nest spells it."""
    part, _, number = name.rpartition(".")
    return f"{known.get(folded(part), part)}.{number.lower()}"


def _measured(start: Floats, end: Floats, metal: shapely.Geometry, kerf_mm: float) -> Slot:
    """The waste to both sides of a pass, and before its end."""
    length_mm = float(np.hypot(*(end - start)))
    along = (end - start) / length_mm
    aside = np.array([-along[1], along[0]])
    [before_mm] = _gaps(end[None, :], along, metal, 2 * kerf_mm).tolist()
    at_mm = np.linspace(0, length_mm + before_mm, max(_LEAST, int(length_mm / _STEP_MM)))[:-1]
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
    positions, allowed_mm = cuts.positions(), tolerance_mm(kerf_mm) + _SLACK_MM
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


def told_of_slots(nest: Nest, slots: Slots, kerf_mm: float) -> Iterator[str]:
    """What parts lose to passes along their slots: a check never passes over it in silence."""
    told = [
        f"{name} opens a slot of {nest.contour(name).slot_of} at ({slot.place[0]:.1f}, {slot.place[1]:.1f}), "
        f"{slot.width_mm:.2f} mm wide and {slot.depth_mm:.1f} mm deep, by one pass: it becomes {kerf_mm:g} mm wide, "
        f"the part loses {slot.loss_mm(kerf_mm):.2f} mm at each side ({NARROW})"
        for name, slot in slots.items()
        if slot.width_mm is not None
    ]
    yield from told[:_MOST_TOLD]
    if len(told) > _MOST_TOLD:
        most_mm = max(slot.loss_mm(kerf_mm) for slot in slots.values())
        yield f"{len(told) - _MOST_TOLD} more slots are opened so; no part loses more than {most_mm:.2f} mm at a side"


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
    made = (nest.contour(cut.contour) for cut in cuts[: cuts.made] if cut.contour in nest.index)
    return [contour for contour in made if contour.kind == "slit"]


def _xy(point: Floats) -> Point:
    return float(point[0]), float(point[1])
