"""A plan's cuts as torch-on paths, made here from the contour and the leads alone, with what is wrong with them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import shapely
from shapely import ops

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.rules.rule import Violation

from .program_rules import tolerance_mm
from .rings import torch_rings
from .torch_run import TorchRun, line_of


def runs_from_cuts(nest: Nest, cuts: CutSequence, kerf_mm: float) -> tuple[tuple[TorchRun, ...], tuple[Violation, ...]]:
    """The torch-on path of every new cut of a known contour, and where leads do not join what they should."""
    new = enumerate(cuts.new, cuts.made + 1)
    known = [(k, cut, nest.contour(cut.contour)) for k, cut in new if cut.contour in nest.index]
    rings = torch_rings([contour for _, _, contour in known], kerf_mm)
    runs: list[TorchRun] = []
    violations: list[Violation] = []
    for (position, cut, contour), ring in zip(known, rings, strict=True):
        faults = []
        if ring is None:
            faults.append(("contour-geometry", f"the kerf of {kerf_mm:g} mm leaves nothing of {contour.id} to follow"))
            ring = contour.curve.line()
        join = _join(cut, ring)
        faults += list(_faults(cut, contour, ring, join, kerf_mm))
        where, marks = f"cut {position}", contour.kind == "mark"
        runs.append(TorchRun(position, where, contour, line_of(cut.lead_in), ring, line_of(cut.lead_out), marks))
        violations += [Violation(rule, (contour.id,), f"{where}: {text}", (position,)) for rule, text in faults]
    return tuple(runs), tuple(violations)


def _join(cut: Cut, ring: shapely.LineString) -> Point:
    """Where the torch joins the contour: the end of the lead-in, else the start of the lead-out, else at the entry."""
    if cut.lead_in is not None:
        return _xy(cut.lead_in, -1)
    if cut.lead_out is not None:
        return _xy(cut.lead_out, 0)
    x, y = ops.nearest_points(ring, shapely.Point(cut.entry))[0].coords[0]
    return x, y


def _faults(
    cut: Cut, contour: Contour, ring: shapely.LineString, join: Point, kerf_mm: float
) -> Sequence[tuple[str, str]]:
    allowed = tolerance_mm(kerf_mm)
    found: list[tuple[str, str]] = []

    def geometry(text: str) -> None:
        found.append(("contour-geometry", f"{contour.id}: {text}"))

    off_mm = contour.curve.project(cut.entry)[1]
    if off_mm > allowed:
        geometry(f"the entry is {off_mm:.3f} mm off the contour")
    if cut.lead_in is not None and math.dist(_xy(cut.lead_in, 0), cut.pierce) > allowed:
        geometry("the lead-in does not start at the pierce")
    if contour.kind == "mark":
        if cut.lead_in is not None and cut.lead_in.segments:
            geometry("a mark has no lead-in")
        begins = cut.entry if contour.curve.closed else _xy(contour.curve, 0 if cut.direction == "ccw" else -1)
        if math.dist(cut.pierce, begins) > allowed:
            geometry("marking does not start where the line does")
        return found
    if contour.kind == "slit":
        begins = cut.pierce if cut.lead_in is None else _xy(cut.lead_in, -1)
        if cut.direction != "ccw" or math.dist(begins, _xy(contour.curve, 0)) > allowed:
            geometry("a slit is cut from its mouth on")
        return found
    start = cut.pierce if cut.lead_in is None else join
    off_mm = shapely.Point(start).distance(ring)
    if off_mm > allowed:
        other = torch_rings([contour], kerf_mm, "wrong")[0]
        if other is not None and shapely.Point(start).distance(other) <= allowed:
            side = "inside" if contour.kind == "outer" else "outside"
            found.append(("kerf-side", f"the torch joins {contour.id} {side}, so that the kerf is on the part's side"))
        else:
            geometry(f"the torch joins {off_mm:.3f} mm off where the kerf asks for it")
    if math.dist(join, cut.entry) > kerf_mm + allowed:
        geometry(f"the torch joins {math.dist(join, cut.entry):.3f} mm from the entry")
    if cut.lead_out is not None and math.dist(_xy(cut.lead_out, 0), join) > allowed:
        geometry("the lead-out does not start where the round ends")
    return found


def _xy(curve: Curve, k: int) -> Point:
    x, y = curve.vertices[k, :2].tolist()
    return x, y
