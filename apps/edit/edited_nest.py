"""A nest that changes: parts dropped, moved, turned, added, laid anew, on another sheet; every change can be undone.

A changed nest is a nest, and the changes that were made to it. What comes of them is worked out from the first on, so
that any way of doing and undoing that leaves the same changes gives the same bytes.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from kerfwise.apps.distortion.change import COMPENSATED
from kerfwise.apps.nesting.find_nests import spacing_of
from kerfwise.apps.nesting.placement.demand import QUARTERS, PartType, Spacing
from kerfwise.apps.nesting.placement.fill import LEFT, Room, Taste, fill, largest_first
from kerfwise.apps.nesting.placement.layout import TURNS
from kerfwise.apps.nesting.placement.nofit import Placed, Pose
from kerfwise.apps.nesting.placement.shapes import Shapes
from kerfwise.encoder.candidates.build import scrap_problems as near_or_severed
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import QUANTITY_KEY, Contour, Nest, Part, Sheet, as_scrap
from kerfwise.encoder.readers.json_nest import nest_json
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.encoder.scrap import largest_rectangle
from kerfwise.encoder.validate import scrap_problems
from kerfwise.jobs.inputs import Inputs, Tell, damaged, is_plan_file, silent
from kerfwise.jobs.nest_job.request import last_plan
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.postproc.output_files import expect_outputs, write_files
from kerfwise.postproc.report.legend import counted
from kerfwise.rules.profile.profile import Profile

from .edits import Add, Drop, Edit, Keep, Mirror, Move, NestAnew, OtherSheet, Turn, edit_of

# A nest with what was done to it: how each part lies is worked out once, from where it was drawn.

_SAME_MM = 1e-6


@dataclass(frozen=True, slots=True)
class Lying:
    """How a part lies against where it was: turned about its middle after a mirroring, then moved."""

    turn_deg: float = 0.0
    mirrored: bool = False
    dx_mm: float = 0.0
    dy_mm: float = 0.0

    def turned(self, by_deg: float) -> Lying:
        """Turned further."""
        return replace(self, turn_deg=round((self.turn_deg + by_deg) % 360.0, 6) % 360.0)

    def moved(self, dx_mm: float, dy_mm: float) -> Lying:
        """Moved further."""
        return replace(self, dx_mm=round(self.dx_mm + dx_mm, 6) + 0.0, dy_mm=round(self.dy_mm + dy_mm, 6) + 0.0)

    def flipped(self) -> Lying:
        """Turned over: what was turned counter-clockwise is turned clockwise then."""
        return replace(self, turn_deg=-self.turn_deg % 360.0, mirrored=not self.mirrored)

    def part(self, drawn: Part) -> Part:
        """The part where it lies now: itself where nothing was done."""
        if self == Lying():
            return drawn
        pose = Pose(self.turn_deg, self.mirrored)
        x0, y0, x1, y1 = drawn.outer.polygon.bounds
        middle = np.array([[(x0 + x1) / 2, (y0 + y1) / 2]])
        by = middle - pose.moved(middle) + [self.dx_mm, self.dy_mm]
        laid = Placed(0, pose, float(by[0, 0]), float(by[0, 1])).part(drawn, drawn.id)
        was = Pose(float(str(drawn.attributes.get("turned", 0.0))), bool(drawn.attributes.get("mirrored", False)))
        turn = self.turn_deg + (-was.turn_deg if self.mirrored else was.turn_deg)
        attributes: dict[str, object] = {"turned": turn % 360.0 + 0.0, "mirrored": self.mirrored != was.mirrored}
        if "turned" not in drawn.attributes and not (attributes["turned"] or attributes["mirrored"]):
            attributes = {}
        return replace(laid, attributes={**drawn.attributes, **attributes})


@dataclass(frozen=True, eq=False)
class _State:
    """What there is after some changes: parts as they were drawn or laid, how they lie, and what is off the sheet."""

    sheet: Sheet
    drawn: Mapping[str, Part]
    lying: Mapping[str, Lying]
    off: tuple[str, ...] = ()

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The parts where they lie."""
        return tuple(self.lying[name].part(part) for name, part in self.drawn.items())

    def without(self, names: Sequence[str]) -> _State:
        """Without these parts."""
        gone = set(names)
        return replace(self, drawn={name: part for name, part in self.drawn.items() if name not in gone})

    def laid(self, name: str, lying: Lying) -> _State:
        """With a part lying otherwise."""
        return replace(self, lying={**self.lying, name: lying})


@dataclass(frozen=True, eq=False, repr=False)
class EditedNest:
    """A nest and the changes made to it. Nothing of it changes: each change gives another one.

    Attributes
    ----------
    base
        The nest as it was read.
    spacing
        How far parts keep from each other and from the edge of the sheet; parts that were nearer may stay so.
    cut
        Parts that are cut already, wholly or in part: they stay where they are; and scrap lines.
    kerf_mm
        Width of the cut: so much more is out around parts that are.
    reading
        How files of parts are read that are added.
    edits
        What was done, in order.
    undone
        What was undone and can be done again, the last first.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> plate = nest(200, 100, part("A", rect(10, 10, 40, 40)), part("B", rect(60, 10, 40, 40)))
    >>> one = EditedNest(plate, Spacing(5.0, 5.0)).do("drop A").do("move B 20 0")
    >>> [p.id for p in one.nest.parts], one.nest.parts[0].outer.polygon.bounds
    (['B'], (80.0, 10.0, 120.0, 50.0))
    >>> one.undo().undo().nest is plate
    True
    """

    base: Nest
    spacing: Spacing
    cut: frozenset[str] = frozenset()
    kerf_mm: float = 0.0
    reading: ReadOptions = field(default_factory=ReadOptions)
    edits: tuple[Edit, ...] = ()
    undone: tuple[Edit, ...] = field(default=())

    def __str__(self) -> str:
        x0, y0, x1, y1 = self.nest.sheet.bounds
        count = counted(len(self.nest.parts), "part")
        text = f"{count} of {len(self.base.parts)} before, on a sheet of {x1 - x0:g} × {y1 - y0:g} mm"
        text += f"\noff the sheet, left out: {escape_text(', '.join(self.off))}" if self.off else ""
        return text + "".join(f"\nscrap line left out: {escape_text(why)}" for why in self.scrap_left_out)

    __repr__ = __str__

    def do(self, *changes: Edit | str) -> EditedNest:
        """With these changes, which count together: only what comes of all of them has to be sound.

        A change may be a line such as "drop P1", "move P2 10 0", "turn P2 90" or "add bracket.dxf=2": see `edit_of`.

        Raises InputError if there is no such part, it is cut already, parts come too near to each other or to the edge,
        or what is to be laid has no room: with all collisions.
        """
        if self.base.bridges or self.base.apart:
            raise InputError("a nest with bridges between parts cannot be edited: take them out of the drawing first")
        if any(COMPENSATED in part.attributes for part in self.base.parts):
            raise InputError("a compensated nest fits one plan as it lies: edit the one that it was made from")
        edits = tuple(edit_of(one, self.reading) if isinstance(one, str) else one for one in changes)
        edited = replace(self, edits=(*self.edits, *edits), undone=())
        edited.__dict__["_state"] = self._after(self._state, edits)
        if wrong := edited.faults:
            raise InputError("the parts would come too near to each other or to the edge", details=wrong)
        return edited

    def undo(self) -> EditedNest:
        """Without the last change; InputError where there is none."""
        if not self.edits:
            raise InputError("nothing can be undone")
        return replace(self, edits=self.edits[:-1], undone=(self.edits[-1], *self.undone))

    def redo(self) -> EditedNest:
        """With the change that was undone last; InputError where there is none."""
        if not self.undone:
            raise InputError("nothing was undone")
        return replace(self, edits=(*self.edits, self.undone[0]), undone=self.undone[1:])

    @cached_property
    def nest(self) -> Nest:
        """The nest as it is now; the base itself where nothing is changed."""
        if not self.edits:
            return self.base
        return Nest(self._state.sheet, self._state.parts, file=self.base.file, scrap=self._scrap[0])

    @property
    def off(self) -> tuple[str, ...]:
        """Parts that are off the other sheet, and left out."""
        return self._state.off

    @property
    def scrap_left_out(self) -> tuple[str, ...]:
        """Why, a sentence for each scrap line of the base that is left out, by its name there."""
        return self._scrap[1]

    @cached_property
    def _scrap(self) -> tuple[tuple[Contour, ...], tuple[str, ...]]:
        """The scrap lines that can be cut as the parts lie now, numbered anew, and why each other one is left out."""
        state, left_out = self._state, list[str]()
        now = Nest(state.sheet, state.parts, scrap=self.base.scrap)
        begun_again = any(name in self.cut for name in self.base.part_of if name not in state.drawn)
        done = [f"{line.id} is cut already" for line in now.scrap if begun_again and line.id in self.cut]
        while wrong := [*done, *scrap_problems(now.scrap, now.parts, now.sheet), *near_or_severed(now, self.kerf_mm)]:
            left_out.append(wrong[0])
            gone = wrong[0].split()[0]
            done = [text for text in done if text is not wrong[0]]
            now = replace(now, scrap=tuple(line for line in now.scrap if line.id != gone))
        if not left_out:
            return self.base.scrap, ()
        return as_scrap([line.curve for line in now.scrap], [line.source for line in now.scrap]), tuple(left_out)

    @property
    def named_as_before(self) -> Nest:
        """The nest without the scrap lines whose name was another line's before."""
        old = {line.id: line.curve for line in self.base.scrap}
        return replace(self.nest, scrap=tuple(line for line in self.nest.scrap if old[line.id] is line.curve))

    def text(self) -> str:
        """The nest as kerfwise-nest/1."""
        return nest_json(self.nest)

    def save(self, path: str | Path) -> Path:
        """Write the nest as kerfwise-nest/1.

        Raises InputError if there is no such folder, or it cannot be written.
        """
        out = Path(path)
        expect_outputs([out], [Path(self.base.file)] if self.base.file else [])
        write_files({out: self.text()})
        return out

    @cached_property
    def _state(self) -> _State:
        drawn = {part.id: part for part in self.base.parts}
        return self._after(_State(self.base.sheet, drawn, dict.fromkeys(drawn, Lying())), self.edits)

    def _after(self, state: _State, edits: Sequence[Edit]) -> _State:
        for edit in edits:
            state = self._changed(state, edit)
        if not state.drawn:
            raise InputError("no part would be left")
        return state

    def _changed(self, state: _State, edit: Edit) -> _State:
        match edit:
            case Drop(parts):
                self._expect_free(state, parts, "left out")
                return state.without(parts)
            case Keep(parts):
                _expect_there(state, parts)
                gone = [name for name in state.drawn if name not in parts]
                out = [part for part in state.parts if part.id in gone and part.id in self.cut]
                left = state.without(gone)
                return replace(left, sheet=_without_metal(state.sheet, out, left.parts, self.kerf_mm)) if out else left
            case Move(part, dx_mm, dy_mm):
                self._expect_free(state, (part,), "moved")
                return state.laid(part, state.lying[part].moved(dx_mm, dy_mm))
            case Turn(part, turn_deg):
                self._expect_free(state, (part,), "turned")
                laid = state.laid(part, state.lying[part].turned(turn_deg))
                _expect_turn(state.drawn[part], laid.lying[part])
                return laid
            case Mirror(part):
                self._expect_free(state, (part,), "mirrored")
                return state.laid(part, state.lying[part].flipped())
            case OtherSheet(sheet):
                if self.cut:
                    raise InputError(f"{min(self.cut)} is cut already: the sheet stays")
                return self._on_sheet(state, sheet)
            case Add(types):
                return self._added(state, types)
            case NestAnew(fixed):
                _expect_there(state, fixed)
                return self._anew(state, {*fixed, *self.cut})

    def _expect_free(self, state: _State, names: Sequence[str], what: str) -> None:
        _expect_there(state, names)
        if stays := [name for name in names if name in self.cut]:
            raise InputError(f"{stays[0]} is cut already, wholly or in part: it cannot be {what}")

    def _on_sheet(self, state: _State, sheet: Sheet) -> _State:
        """On another sheet; parts that lie off it, or too near to its edge, are left out."""
        (x0, y0, *_), (a0, b0, *_) = state.sheet.bounds, sheet.bounds
        moved = Pose()
        if (x0, y0) != (a0, b0):
            by = Placed(0, moved, x0 - a0, y0 - b0)
            sheet = Sheet(by.curve(sheet.outline), tuple(by.curve(hole) for hole in sheet.holes))
        near = {part.id: _edge_mm(part, state.sheet) for part in state.parts}
        off = tuple(
            part.id
            for part in state.parts
            if _edge_mm(part, sheet) < min(self.spacing.edge_mm, max(near[part.id], 0.0)) - _NEAR_MM
        )
        return replace(state.without(off), sheet=sheet, off=(*state.off, *off))

    def _added(self, state: _State, types: Sequence[PartType]) -> _State:
        there = [PartType(part.id, part, 1) for part in state.parts]
        shapes = Shapes([*there, *types], self.spacing.gap_mm)
        room = Room(shapes, state.sheet, self.spacing)
        room.take(Placed(k, Pose(), 0.0, 0.0) for k in range(len(there)))
        kinds = range(len(there), len(there) + len(types))
        laid = fill(room, largest_first(shapes, kinds), {k: types[k - len(there)].quantity for k in kinds}, LEFT)
        lost = {k: shapes.types[k].quantity - sum(one.kind == k for one in laid) for k in kinds}
        if missing := [f"{n} of {shapes.types[k].quantity} {shapes.types[k].name}" for k, n in lost.items() if n]:
            raise InputError("there is no room on the sheet for more parts", details=tuple(missing))
        drawn = dict(state.drawn)
        for one in laid:
            kind = shapes.types[one.kind]
            name = next(name for n in range(1, len(drawn) + 2) if (name := f"{kind.name}-{n}") not in drawn)
            copy = one.part(kind.part, name)
            copy.attributes.pop(QUANTITY_KEY, None)
            copy.attributes.update({"of": kind.name} | ({"order": kind.order} if kind.order else {}))
            drawn[name] = copy
        return replace(state, drawn=drawn, lying={**dict.fromkeys(drawn, Lying()), **state.lying})

    def _anew(self, state: _State, fixed: set[str]) -> _State:
        """All but the fixed parts laid so that the largest rectangle is left, of the ways that have room for all."""
        types = [PartType(part.id, part, 1, turns_deg=_turns_of(part)) for part in state.parts]
        shapes = Shapes(types, self.spacing.gap_mm)
        kinds = [k for k, kind in enumerate(types) if kind.name not in fixed]
        best: tuple[float, list[Placed]] | None = None
        for taste in (LEFT, Taste(0.01, 1.0)):
            room = Room(shapes, state.sheet, self.spacing)
            room.take(Placed(k, Pose(), 0.0, 0.0) for k in range(len(types)) if k not in kinds)
            laid = fill(room, largest_first(shapes, kinds), dict.fromkeys(kinds, 1), taste, every=True)
            if len(laid) < len(kinds):
                continue
            metal = [one.area(types[one.kind].part.polygon) for one in room.placed]
            a0, b0, a1, b1 = largest_rectangle(state.sheet, metal, self.spacing.gap_mm)
            if best is None or (a1 - a0) * (b1 - b0) > best[0] + _SAME_MM:
                best = (a1 - a0) * (b1 - b0), laid
        if best is None:
            raise InputError("the parts have no room when they are laid anew: fix fewer, or leave some out")
        for one in best[1]:
            name, part = types[one.kind].name, types[one.kind].part
            x0, y0, x1, y1 = part.outer.polygon.bounds
            middle = np.array([[(x0 + x1) / 2, (y0 + y1) / 2]])
            dx, dy = (one.pose.moved(middle, one.dx_mm, one.dy_mm) - middle)[0].tolist()
            state = state.laid(name, state.lying[name].turned(one.pose.turn_deg).moved(dx, dy))
        return state

    @cached_property
    def faults(self) -> tuple[str, ...]:
        """Parts that lie too near to each other or to the edge, where they did not before."""
        return tuple(_faults(self.base, self._state, self.spacing))


def _expect_there(state: _State, names: Sequence[str]) -> None:
    for name in names:
        if name not in state.drawn:
            raise InputError(unknown("part", name, state.drawn))


def _turns_of(part: Part) -> tuple[float, ...]:
    """How a part may be turned from where it lies, degrees."""
    value: Any = part.attributes.get(TURNS)
    if not isinstance(value, list):
        return QUARTERS
    now = float(str(part.attributes.get("turned", 0.0)))
    return tuple(sorted((float(turn) - now) % 360.0 for turn in value))


def _expect_turn(drawn: Part, lying: Lying) -> None:
    value: Any = drawn.attributes.get(TURNS)
    turned = float(str(lying.part(drawn).attributes.get("turned", 0.0)))
    if isinstance(value, list) and turned not in [float(turn) % 360.0 for turn in value]:
        known = ", ".join(f"{turn:g}" for turn in value)
        raise InputError(f"{drawn.id} may lie at {known} degrees only, because of grain, and would lie at {turned:g}")


def _without_metal(sheet: Sheet, out: Sequence[Part], kept: Sequence[Part], kerf_mm: float) -> Sheet:
    """The sheet without parts that are out, and their kerfs.

    Raises InputError if a part that is kept lies in one that is out: its metal has fallen out with that.
    """
    voids = [part.outer.polygon.buffer(kerf_mm, join_style="mitre") for part in out]
    for part in kept:
        for other, void in zip(out, voids, strict=True):
            if void.intersection(part.polygon).area > _NEAR_MM:
                raise InputError(f"{part.id} lies in the metal of {other.id}, which is cut and out: it cannot be kept")
    metal = sheet.polygon.difference(shapely.union_all(voids))
    pieces = [piece for piece in shapely.get_parts(metal) if any(piece.intersects(part.polygon) for part in kept)]
    if len(pieces) != 1:
        raise InputError("the parts that are kept lie on pieces of the sheet that hang together no more: keep fewer")
    outline = sheet.outline if pieces[0].exterior.equals(sheet.polygon.exterior) else _ring(pieces[0].exterior)
    return Sheet(outline, tuple(_ring(hole) for hole in pieces[0].interiors), sheet.stated)


def _ring(ring: shapely.LinearRing) -> Curve:
    return Curve.of([(x, y) for x, y in shapely.get_coordinates(ring)[:-1].round(6).tolist()])


# Collisions: parts that come nearer than the gap, named with the distance; what lay so before is let be.

_NEAR_MM = 0.01


def _edge_mm(part: Part, sheet: Sheet) -> float:
    """How far a part lies from the edge of a sheet; less than 0 by how far it reaches over it."""
    metal = sheet.polygon
    if metal.covers(part.outer.polygon):
        return float(part.outer.polygon.distance(metal.boundary))
    corners = shapely.points(shapely.get_coordinates(part.outer.polygon.difference(metal)))
    return -max(float(shapely.distance(corners, metal).max()), 2 * _NEAR_MM)


def _faults(base: Nest, state: _State, spacing: Spacing) -> Iterator[str]:
    before, parts = base.part_of, state.parts
    moved = [part.id not in before or part is not before[part.id] for part in parts]
    for part, new in zip(parts, moved, strict=True):
        if not new:
            continue
        edge_mm = _edge_mm(part, state.sheet)
        least_mm = min(spacing.edge_mm, _edge_mm(before[part.id], base.sheet)) if part.id in before else spacing.edge_mm
        if edge_mm < 0:
            yield f"{part.id} reaches {-edge_mm:.1f} mm over the edge of the sheet"
        elif edge_mm < least_mm - _NEAR_MM:
            yield f"{part.id} lies {edge_mm:.1f} mm from the edge of the sheet: {spacing.edge_mm:g} mm are kept"
    metal = [part.polygon for part in parts]
    tree = shapely.STRtree(metal)
    one, other = tree.query(metal, "dwithin", distance=spacing.gap_mm)
    for i, j in sorted((int(i), int(j)) for i, j in zip(one, other, strict=True) if i < j and (moved[i] or moved[j])):
        apart_mm = float(metal[i].distance(metal[j]))
        shared_mm2 = float(metal[i].intersection(metal[j]).area)
        a, b = parts[i].id, parts[j].id
        if shared_mm2 > _NEAR_MM:
            yield f"{a} overlaps {b} by {shared_mm2:.4g} mm²"
        elif apart_mm < spacing.gap_mm - _NEAR_MM and not _was_so(before, a, b, apart_mm):
            yield f"{a} lies {apart_mm:.1f} mm from {b}: {spacing.gap_mm:g} mm are kept"


def _was_so(before: Mapping[str, Part], a: str, b: str, apart_mm: float) -> bool:
    """Whether two parts lay as near to each other before."""
    return a in before and b in before and before[a].polygon.distance(before[b].polygon) <= apart_mm + _NEAR_MM


def contours_cut(
    inputs: Inputs, file: str | Path | None, old: Plan | str | Path | None, upto: int | None, tell: Tell = silent
) -> set[str]:
    """The contours that a plan or program of a nest has cut, up to that cut; all of them where no number is given.

    A plan that is damaged is told. Raises InputError if it cannot be read, or has fewer cuts.
    """
    if old is None:
        return set()
    cuts = last_plan(old, inputs.nest, file, inputs.profile).cuts
    if isinstance(old, Plan) or is_plan_file(old):
        for text in damaged(old if isinstance(old, Plan) else read_plan(old), inputs):
            tell(text)
    if upto is not None and not 1 <= upto <= len(cuts):
        name = "the plan" if isinstance(old, Plan) else old
        raise InputError(f"--upto {upto} (in Python upto): {name} has {len(cuts)} cuts only")
    return {contour for number, contour in cuts.items() if upto is None or number <= upto}


def editing(
    nest: Nest,
    profile: Profile,
    *,
    gap_mm: float | None = None,
    edge_mm: float | None = None,
    cut: Collection[str] = (),
) -> EditedNest:
    """A nest that can be changed, as it is drawn, with the distances of its profile; `cut` contours are cut already."""
    parts = {nest.contour(name).part or name for name in cut if name in nest.index}
    return EditedNest(
        nest.drawn or nest, spacing_of(profile, gap_mm, edge_mm), frozenset(parts), profile.material.kerf_mm
    )
