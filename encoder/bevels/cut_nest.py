"""The nest as it is cut where contours carry bevels, and how a plant cuts these: head, block, kerfs, corners."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.offset import offset_curve
from kerfwise.encoder.geometry.segment import Segment
from kerfwise.encoder.nest import Contour, Nest, Part, cached_with_nest, with_parts

from .bevel import BevelPass, Face
from .round import SHARP_RAD, Corner, Round
from .tilted_path import Lean, TiltedPath

_LEAST_GROWTH_MM = 1e-6
_PART_KG = 1e-9
"""kg of a mm³ at 1 kg/m³."""


@dataclass(frozen=True, slots=True)
class BevelOptions:
    """How bevels are cut on a sheet of one thickness; lengths in mm.

    `kerfs` are rows of an angle and the kerf there, square to the jet, in order of angles, the first that of a torch
    that stands upright. `run_mm` is how far past a sharp corner a loop goes at the least, `most_turn_deg` how far the
    head turns either way; a `block` of torches may stand in the place of one head that tilts. Parts of `lies_still_kg`
    or more stay where they are when they have come loose.
    """

    thickness_mm: float
    kerfs: tuple[tuple[float, float], ...]
    corner: Corner = "either"
    run_mm: float = 5.0
    most_turn_deg: float = 360.0
    lies_still_kg: float | None = None
    density_kg_m3: float = 7850.0
    block: Block | None = None

    def kerf_mm(self, tilt_deg: float) -> float:
        """The kerf at an angle, square to the jet: straight between two rows, that of the last one beyond it."""
        angles, widths = zip(*self.kerfs, strict=True)
        return float(np.interp(abs(tilt_deg), angles, widths))

    def half_mm(self, one: BevelPass) -> float:
        """Half the width of a pass's cut, measured level."""
        return self.kerf_mm(one.tilt_deg) / math.cos(math.radians(one.tilt_deg)) / 2

    def lean(self, one: BevelPass) -> Lean:
        """How the torch leans in a pass."""
        return Lean(one.tilt_deg, one.root_mm, self.half_mm(one))

    def main_half_mm(self, drawn: Contour) -> float:
        """Half the level width of the last pass's cut: plans have their leads join that."""
        if drawn.bevel is None:
            return self.kerfs[0][1] / 2
        return self.half_mm(drawn.bevel.passes(self.thickness_mm)[-1])

    def leans(self, drawn: Contour) -> tuple[Lean, ...]:
        """How each pass of a contour with one bevel leans."""
        return () if drawn.bevel is None else tuple(map(self.lean, drawn.bevel.passes(self.thickness_mm)))

    def rounds(self, drawn: Contour, ccw: bool) -> tuple[Round, ...]:
        """The passes of a contour as drawn, in order; the last goes all the way round.

        Where single edges have bevels their passes but the last are each a run along these edges, while the part is
        still held by the others; the last round cuts all edges, each as its own last pass wants.
        """
        if self.block is not None:
            return (Round(drawn, self.lean(BevelPass(0.0, 0.0)), ccw, apart_mm=self.block.apart_mm),)
        if drawn.bevel is not None:
            return tuple(Round(drawn, self.lean(one), ccw) for one in drawn.bevel.passes(self.thickness_mm))
        upright, each = self.lean(BevelPass(0.0, 0.0)), drawn.bevel_of_edge
        passes = [(BevelPass(0.0, 0.0),) if of is None else of.passes(self.thickness_mm) for of in each]
        found = []
        for run in _runs(drawn):
            *before, _ = passes[run[0]]
            for one in before:
                leans = tuple(self.lean(one) if k in run else upright for k in range(len(each)))
                found.append(Round(drawn, upright, ccw, (), leans, run, self.thickness_mm))
        leans = tuple(self.lean(of[-1]) for of in passes)
        return *found, Round(drawn, upright, ccw, (), leans, (), self.thickness_mm)

    def depths_mm(self) -> tuple[float, ...]:
        """The depths at which ways are judged, from the top face to the bottom face: a millimetre apart at the most."""
        count = max(math.ceil(self.thickness_mm), 2)
        return tuple(np.linspace(0.0, self.thickness_mm, count + 1).tolist())

    def mass_kg(self, part: Part) -> float:
        """What a part weighs, its bevels not taken off."""
        return float(part.polygon.area) * self.thickness_mm * self.density_kg_m3 * _PART_KG


def bevelled(nest: Nest) -> Iterator[Contour]:
    """The contours with bevels, as they are drawn."""
    return (contour for part in (nest.drawn or nest).parts for contour in part if contour.bevelled)


@cached_with_nest(most=4)
def with_bevels(nest: Nest, options: BevelOptions) -> Nest:
    """The nest as it is cut: contours with bevels stand so far out that half a kerf beside them runs the last pass.

    A tilted torch's cut is wider, measured level. The nest that comes out keeps the one that went in as `drawn`; where
    no contour has a bevel it is that one. Contours are cut more slowly where the way through the metal is longer.
    Raises InputError for a bevel that the sheet has no room for, with its contour.
    """
    if not any(True for _ in bevelled(nest)):
        return nest
    return with_parts(nest, tuple(_part(part, options) for part in nest.parts))


def _part(part: Part, options: BevelOptions) -> Part:
    outer, holes = _contour(part.outer, options), tuple(_contour(hole, options) for hole in part.holes)
    same = outer is part.outer and all(new is old for new, old in zip(holes, part.holes, strict=True))
    return part if same else replace(part, outer=outer, holes=holes)


def _runs(drawn: Contour) -> list[tuple[int, ...]]:
    """The edges with a bevel, those that follow each other at one angle together, in the order of the contour."""
    segments, each = drawn.curve.segments, drawn.bevel_of_edge
    count, out = len(segments), 1.0 if drawn.curve.is_ccw == (drawn.kind == "outer") else -1.0
    runs: list[list[int]] = []
    for k in range(count):
        if each[k] is None:
            continue
        if runs and runs[-1][-1] == k - 1 and each[k - 1] == each[k] and _goes_on(segments[k - 1], segments[k], out):
            runs[-1].append(k)
        else:
            runs.append([k])
    first, last = (runs[0], runs[-1]) if len(runs) > 1 else ([-1], [-1])
    if first[0] == 0 and last[-1] == count - 1 and each[0] == each[-1] and _goes_on(segments[-1], segments[0], out):
        runs[0] = [*runs.pop(), *first]
    return [tuple(run) for run in runs]


def _goes_on(before: Segment, after: Segment, out: float) -> bool:
    """Whether a torch goes on from one edge to the next at its angle: not where they bend into the part."""
    (ax, ay), (bx, by) = before.tangent_at(1.0), after.tangent_at(0.0)
    return out * math.atan2(ax * by - ay * bx, ax * bx + ay * by) > -SHARP_RAD


def _contour(contour: Contour, options: BevelOptions) -> Contour:
    for one in contour.edge_bevels:
        try:
            one.bevel.expect_fit(options.thickness_mm)
        except InputError as error:
            raise InputError(f"{contour.id}, bevel {one.bevel}: {error.message}") from None
        if not any(one.is_on(segment) for segment in contour.curve.segments):
            x, y = one.edge.point_at(one.edge.length_mm / 2)
            raise InputError(
                f"{contour.id}, bevel {one.bevel}: no edge runs at ({x:.1f}, {y:.1f}) any more: draw it anew"
            )
    if contour.bevel is None:
        return contour
    try:
        contour.bevel.expect_fit(options.thickness_mm)
        last = contour.bevel.passes(options.thickness_mm)[-1]
        by_mm = options.half_mm(last) - options.kerfs[0][1] / 2
        outwards = by_mm if contour.kind == "outer" else -by_mm
        curve = offset_curve(contour.curve, outwards) if abs(by_mm) > _LEAST_GROWTH_MM else contour.curve
    except (InputError, ValueError) as error:
        raise InputError(f"{contour.id}, bevel {contour.bevel}: {error}") from None
    slowest = max((one.tilt_deg for one in contour.bevel.passes(options.thickness_mm)), key=abs)
    tilt_deg = last.tilt_deg if options.block is None else slowest
    return replace(contour, curve=curve, feed_share=contour.feed_share * math.cos(math.radians(tilt_deg)))


_STRAIGHT_RAD = 1e-3


@dataclass(frozen=True, slots=True)
class Block:
    """How far the tilted torches stand from the upright one along the contour, mm, and which of them on the left.

    Left is as one looks from the part to the waste: on a contour that is cut counter-clockwise that torch leads, and
    clockwise it is the last.
    """

    apart_mm: float
    left: Face

    def left_mm(self, lean: Lean) -> float:
        """How far on the left of the upright torch that with a lean stands."""
        if not lean.tilt_deg:
            return 0.0
        return self.apart_mm if (lean.tilt_deg > 0) == (self.left == "top") else -self.apart_mm

    def torches(self, path: TiltedPath, leans: tuple[Lean, ...], upright: Lean) -> tuple[TiltedPath, ...]:
        """The ways of the torches that burn, where the block goes along the path of its upright one."""
        found = []
        for lean in leans:
            out_mm = lean.half_mm - lean.slope * lean.root_mm - upright.half_mm
            steps = tuple(
                replace(step, tilt_deg=lean.tilt_deg, end_tilt_deg=lean.tilt_deg, half_mm=lean.half_mm)
                for step in path.steps
            )
            found.append(TiltedPath(steps, path.thickness_mm, (self.left_mm(lean), out_mm)))
        return tuple(found)

    def expect_fit(self, drawn: Contour) -> None:
        """Refuse a contour that a block cannot go round: its torches stand apart along straight edges.

        Raises InputError with the place, and what to do.
        """
        if drawn.edge_bevels:
            raise InputError("a block of torches cuts whole contours: take a head that tilts for single edges")
        segments, out = drawn.curve.segments, 1.0 if drawn.curve.is_ccw == (drawn.kind == "outer") else -1.0
        for before, after in zip((segments[-1], *segments), segments, strict=False):
            (ax, ay), (bx, by) = before.tangent_at(1.0), after.tangent_at(0.0)
            x, y = after.start
            if after.is_arc:
                raise InputError(
                    f"an arc begins at ({x:.1f}, {y:.1f}), and the torches of the block stand {self.apart_mm:g} mm "
                    "apart along it: they cut straight edges; take a head that tilts"
                )
            if out * math.atan2(ax * by - ay * bx, ax * bx + ay * by) < -_STRAIGHT_RAD:
                raise InputError(
                    f"at ({x:.1f}, {y:.1f}) it bends into the part, where the torches of the block that go ahead would "
                    "burn: take a head that tilts"
                )
