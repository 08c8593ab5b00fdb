"""Burns in metal that has come loose, waste or part, whatever cut it off: seen from all kerfs in order of time.

Whole rounds, rounds whose kerfs meet, common edges, links, leads and what was cut before a stop: metal that all of
these together have cut off the frame of the sheet holds to nothing, and nothing may be burnt in it any more.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from kerfwise.encoder.nest import Nest
from kerfwise.rules.judging.loose import OVER_MM, Face, beside_metal, crumbs, loosened
from kerfwise.rules.rule import Violation

from .metal import metal_of_parts
from .torch_run import TorchRun

_RULE = "loose-metal"
_AT_MM = 1e-6
_KERF_MM = 0.02
"""What a torch without a kerf cuts apart."""


def burnt_loose(
    nest: Nest, runs: Sequence[TorchRun], kerf_mm: float, before: Sequence[shapely.Geometry] = ()
) -> Iterator[Violation]:
    """Runs that burn metal which is loose when they begin; `before` are lines that were burnt before a stop."""
    torch = [run for run in runs if not run.marks]
    first = len(before)
    lines = [*before, *(shapely.union_all([run.loop, *run.leads]) for run in torch)]
    faces = loosened(shapely.make_valid(nest.sheet.polygon), lines, max(kerf_mm, _KERF_MM))
    if not faces:
        return
    areas = np.array([face.area for face in faces], dtype=object)
    kept = np.flatnonzero(~crumbs(areas)).tolist()
    faces, areas = [faces[k] for k in kept], areas[kept]
    since, gone = (np.array([getattr(face, name) for face in faces]) for name in ("since", "gone"))
    of, burnt = shapely.STRtree(lines).query(areas, "intersects")
    late = (since[of] < burnt) & (burnt <= gone[of]) & (burnt >= first)
    of, burnt = of[late], burnt[late]
    over = shapely.intersection(np.array(lines, dtype=object)[burnt], areas[of])
    over = beside_metal(over, metal_of_parts(nest), kerf_mm)
    over_mm = shapely.length(over)
    for k in np.unique(burnt).tolist():
        mine = np.flatnonzero(burnt == k)
        run = torch[k - first]
        begun = [] if run.linked else [j for j in mine.tolist() if shapely.dwithin(over[j], _begin(run), _AT_MM)]
        if over_mm[mine].sum() > OVER_MM or begun:
            j = int(max(mine.tolist(), key=lambda j: (j in begun, over_mm[j])))
            yield _violation(run, faces[of[j]], [None] * first + list(torch), float(over_mm[mine].sum()))


def _begin(run: TorchRun) -> shapely.Point:
    """Where the torch is lit."""
    return shapely.get_point(run.loop if run.lead_in is None else run.lead_in, 0)


def _violation(run: TorchRun, face: Face, runs: Sequence[TorchRun | None], over_mm: float) -> Violation:
    x, y = shapely.point_on_surface(face.area).coords[0]
    closed = runs[face.since]
    since = "what was cut before the stop" if closed is None else closed.where
    text = (
        f"{run.where}: {run.name} is cut in metal that is loose since {since}: the piece at ({x:z.1f}, {y:z.1f}) holds "
        f"to nothing any more, and {over_mm:.1f} mm are burnt in it"
    )
    contours = () if run.contour is None else (run.contour.id,)
    return Violation(_RULE, contours, text, (run.position,) if run.position else ())
