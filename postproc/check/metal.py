"""What the torch burns besides its contours: parts that the kerf enters, and places beyond the sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from ...encoder.nest import Nest
from ...rules.rule import Violation
from .program_rules import tolerance_mm
from .torch_run import TorchRun


@dataclass(frozen=True, slots=True)
class Gouges:
    """Violations of no-gouging, and warnings about parts that stand closer than the kerf is wide."""

    violations: tuple[Violation, ...]
    warnings: tuple[str, ...]


def gouges(nest: Nest, runs: Sequence[TorchRun], kerf_mm: float) -> Gouges:
    """Where the kerf, half its width to each side of the torch, enters the metal of a part.

    Two parts closer than the kerf cannot be cut apart without one losing metal: the round of one that touches the
    other is a warning that names both; leads may not do it there either.
    """
    reach_mm = kerf_mm / 2 - tolerance_mm(kerf_mm)
    torch = [run for run in runs if not run.marks]
    if reach_mm <= 0 or not torch or not nest.parts:
        return Gouges((), ())
    metal = np.array([shapely.make_valid(part.polygon) for part in nest.parts], dtype=object)
    tree = shapely.STRtree(metal)
    violations: list[Violation] = []
    tight: dict[tuple[str, str], float] = {}
    loops = np.array([run.loop for run in torch], dtype=object)
    for k, p in sorted(map(tuple, tree.query(loops, predicate="dwithin", distance=reach_mm).T.tolist())):
        run, other = torch[k], nest.parts[p].id
        if run.contour is not None and run.contour.part != other:
            gap_mm = float(shapely.distance(run.contour.line, metal[p]))
            if gap_mm < 2 * reach_mm:
                pair = (min(run.contour.part, other), max(run.contour.part, other))
                tight[pair] = min(tight.get(pair, np.inf), gap_mm)
                continue
        violations.append(_gouge(run, "the kerf", run.loop, metal[p], other, kerf_mm))
    leads = [(run, lead) for run in torch for lead in run.leads]
    lines = np.array([lead for _, lead in leads], dtype=object)
    for k, p in sorted(map(tuple, tree.query(lines, predicate="dwithin", distance=reach_mm).T.tolist())):
        (run, lead), other = leads[k], nest.parts[p].id
        if run.contour is not None and (min(run.contour.part, other), max(run.contour.part, other)) in tight:
            # near its join a lead runs in the round's own kerf, which is already warned of
            lead = shapely.difference(lead, shapely.buffer(run.loop, kerf_mm / 2))
            if lead.is_empty or not shapely.dwithin(lead, metal[p], reach_mm):
                continue
        violations.append(_gouge(run, "a lead", lead, metal[p], other, kerf_mm))
    warnings = [
        f"{a} and {b} are {gap:.3f} mm apart, less than the kerf of {kerf_mm:g} mm: each cut takes metal of both"
        for (a, b), gap in sorted(tight.items())
    ]
    return Gouges(tuple(violations), tuple(warnings))


def _gouge(
    run: TorchRun, what: str, line: shapely.LineString, metal: shapely.Geometry, part: str, kerf_mm: float
) -> Violation:
    depth_mm = kerf_mm / 2 - float(shapely.distance(line, metal))
    contours = () if run.contour is None else (run.contour.id,)
    where = f"{depth_mm:.3f} mm deep" if depth_mm < kerf_mm / 2 else "across it"
    return Violation(
        "no-gouging",
        (*contours, f"{part}.outer"),
        f"{run.where}: {what} of {run.name} enters the metal of {part}, {where}",
        (run.position,) if run.position else (),
    )


def off_sheet(nest: Nest, runs: Sequence[TorchRun], margin_mm: float) -> list[Violation]:
    """Torch-on paths that leave the sheet by more than `margin_mm`."""
    allowed = shapely.buffer(shapely.make_valid(nest.sheet.polygon), margin_mm)
    shapely.prepare(allowed)
    found: list[Violation] = []
    for run in runs:
        for line in (run.loop, *run.leads):
            if not shapely.covers(allowed, line):
                out_mm = float(shapely.difference(line, allowed).length)
                contours = () if run.contour is None else (run.contour.id,)
                text = f"{run.where}: {out_mm:.1f} mm of the path of {run.name} lie off the sheet"
                found.append(Violation("on-sheet", contours, text, (run.position,) if run.position else ()))
                break
    return found
