"""The nest as it is cut where contours carry bevels, and how a plant cuts these: head, angles, kerfs, corners."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.offset import offset_curve
from kerfwise.encoder.nest import Contour, Nest, Part, cached_with_nest, with_parts

from .bevel import Bevel, BevelPass
from .tilted_path import Corner, Edge

_LEAST_GROWTH_MM = 1e-6
_PART_KG = 1e-9
"""kg of a mm³ at 1 kg/m³."""


@dataclass(frozen=True, slots=True)
class BevelOptions:
    """How bevels are cut on a sheet of one thickness; lengths in mm.

    `kerfs` are rows of an angle and the kerf there, square to the jet, in order of angles, the first that of a torch
    that stands upright. `run_mm` is how far past a sharp corner a loop goes at the least, `most_turn_deg` how far the
    head turns either way. Parts of `lies_still_kg` or more stay where they are when they have come loose.
    """

    thickness_mm: float
    kerfs: tuple[tuple[float, float], ...]
    corner: Corner = "either"
    run_mm: float = 5.0
    most_turn_deg: float = 360.0
    lies_still_kg: float | None = None
    density_kg_m3: float = 7850.0

    def kerf_mm(self, tilt_deg: float) -> float:
        """The kerf at an angle, square to the jet: straight between two rows, that of the last one beyond it."""
        angles, widths = zip(*self.kerfs, strict=True)
        return float(np.interp(abs(tilt_deg), angles, widths))

    def half_mm(self, one: BevelPass) -> float:
        """Half the width of a pass's cut, measured level."""
        return self.kerf_mm(one.tilt_deg) / math.cos(math.radians(one.tilt_deg)) / 2

    def main_half_mm(self, bevel: Bevel) -> float:
        """The same of the last pass: plans have their leads join that."""
        return self.half_mm(bevel.passes(self.thickness_mm)[-1])

    def edges(self, drawn: Contour, ccw: bool) -> tuple[Edge, ...]:
        """The contour as drawn with each of its passes."""
        assert drawn.bevel is not None
        return tuple(Edge(drawn, one, self.half_mm(one), ccw) for one in drawn.bevel.passes(self.thickness_mm))

    def depths_mm(self) -> tuple[float, ...]:
        """The depths at which ways are judged, from the top face to the bottom face: a millimetre apart at the most."""
        count = max(math.ceil(self.thickness_mm), 2)
        return tuple(np.linspace(0.0, self.thickness_mm, count + 1).tolist())

    def mass_kg(self, part: Part) -> float:
        """What a part weighs, its bevels not taken off."""
        return float(part.polygon.area) * self.thickness_mm * self.density_kg_m3 * _PART_KG


def bevelled(nest: Nest) -> Iterator[Contour]:
    """The contours with bevels, as they are drawn."""
    return (contour for part in (nest.drawn or nest).parts for contour in part if contour.bevel is not None)


@cached_with_nest(most=4)
def with_bevels(nest: Nest, options: BevelOptions) -> Nest:
    """The nest as it is cut: contours with bevels stand so far out that half a kerf beside them runs the last pass.

    A tilted torch's cut is wider, measured level. The nest that comes out keeps the one that went in as `drawn`; where
    no contour has a bevel it is that one. Contours are cut more slowly where the way through the metal is longer.

    Raises
    ------
    InputError
        For a bevel that the sheet has no room for, with its contour.
    """
    if not any(True for _ in bevelled(nest)):
        return nest
    return with_parts(nest, tuple(_part(part, options) for part in nest.parts))


def _part(part: Part, options: BevelOptions) -> Part:
    outer, holes = _contour(part.outer, options), tuple(_contour(hole, options) for hole in part.holes)
    same = outer is part.outer and all(new is old for new, old in zip(holes, part.holes, strict=True))
    return part if same else replace(part, outer=outer, holes=holes)


def _contour(contour: Contour, options: BevelOptions) -> Contour:
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
    return replace(contour, curve=curve, feed_share=contour.feed_share * math.cos(math.radians(last.tilt_deg)))
