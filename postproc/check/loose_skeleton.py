"""Burns in pieces of the skeleton that scrap lines have cut off, seen from the kerfs themselves.

From the first burn along a scrap line on, the sheet is looked at before each burn. The frame is the largest piece that
the kerfs of all lines leave of the largest piece that those of all parts leave; leads do not tell which is larger.
Before each burn the frame is part of some larger piece of metal, and only in that may be cut, or where the metal is
narrower than the kerf and holds nothing anyway.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from kerfwise.encoder.nest import Contour, Nest
from kerfwise.rules.judging.skeleton import frame_of, in_frame, wide_enough
from kerfwise.rules.rule import Violation

from .rings import torch_rings
from .torch_run import TorchRun

_RULE = "loose-metal"


def off_the_frame(nest: Nest, runs: Sequence[TorchRun], made: Sequence[Contour], kerf_mm: float) -> Iterator[Violation]:
    """Contours that are cut, from the first scrap line on, in metal that does not hold to the frame.

    `made` were cut before a stop: their kerfs are there from the start.
    """
    torch = [run for run in runs if not run.marks]
    of_scrap = [run.contour is not None and run.contour.kind == "scrap" for run in torch]
    if kerf_mm <= 0 or not any(of_scrap):
        return
    lines = np.array([run.loop for run in torch], dtype=object)
    kerfs = shapely.buffer(lines, kerf_mm / 2, quad_segs=4)
    leads = [shapely.union_all(run.leads).buffer(kerf_mm / 2, quad_segs=4) for run in torch]
    begin = of_scrap.index(True) if not any(c.kind == "scrap" for c in made) else 0
    older = [ring.buffer(kerf_mm / 2, quad_segs=4) for ring in torch_rings(made, kerf_mm) if ring is not None]
    metal = shapely.make_valid(nest.sheet.polygon) - shapely.union_all([*older, *kerfs[:begin]])
    metal = wide_enough(metal, kerf_mm)
    parts = shapely.union_all(shapely.make_valid([part.outer.polygon for part in nest.parts]))
    along = np.array(of_scrap)
    skeleton = metal - shapely.union_all(kerfs[begin:][~along[begin:]]) - parts
    frame = frame_of(skeleton, shapely.union_all(kerfs[along]), kerf_mm)
    left = [] if frame is None else shapely.get_parts(frame - shapely.union_all(leads)).tolist()
    if not left:
        return
    inside = shapely.point_on_surface(max(left, key=lambda piece: piece.area))
    metal -= shapely.union_all(leads[:begin])
    for k, (run, line, kerf) in enumerate(zip(torch, lines.tolist(), kerfs.tolist(), strict=True)):
        if k < begin:
            continue
        if run.contour is not None and not in_frame(line, metal, inside, kerf_mm):
            x, y = shapely.line_interpolate_point(run.loop, 0.5, normalized=True).coords[0]
            text = (
                f"{run.where}: {run.contour.id} is cut at ({x:z.1f}, {y:z.1f}) in metal that is cut off the skeleton, "
                "and loose"
            )
            yield Violation(_RULE, (run.contour.id,), text, (run.position,) if run.position else ())
        metal -= shapely.union(kerf, leads[k])
