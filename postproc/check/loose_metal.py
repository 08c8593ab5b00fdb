"""Burns in metal that has come loose: pieces that several burns have cut off together before all in them was cut.

What one burn cuts off by going round one contour is what the rules on inner and nested contours are about. Here are
pieces that only the kerfs of several burns enclose, such as a row of parts with common edges.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from kerfwise.encoder.components import weak_components
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.rules.rule import Violation

from .rings import torch_rings
from .torch_run import TorchRun

_RULE = "loose-metal"
_LEAST_MM = 1.0


def burnt_loose(nest: Nest, runs: Sequence[TorchRun], kerf_mm: float) -> Iterator[Violation]:
    """Contours that are cut, or go on to be cut, in a piece that holds to nothing any more."""
    torch = [k for k, run in enumerate(runs) if not run.marks]
    if kerf_mm <= 0 or not any(runs[k].partial for k in torch):
        return
    lines = np.array([shapely.union_all([runs[k].loop, *runs[k].leads]) for k in torch], dtype=object)
    last = {run.contour.id: k for k, run in enumerate(runs) if run.contour is not None and not run.marks}
    cut = [c for c in nest.contours if c.id in last and c.encloses]
    rings = [(c, ring) for c, ring in zip(cut, torch_rings(cut, kerf_mm), strict=True) if ring is not None]
    tree = shapely.STRtree([ring for _, ring in rings])
    told: set[str] = set()
    for cluster in _clusters(list(lines), [runs[k].partial for k in torch], kerf_mm):
        burnt: shapely.Geometry = shapely.Polygon()
        known: set[tuple[float, ...]] = set()
        for n in cluster:
            burnt = shapely.union(burnt, shapely.buffer(lines[n], kerf_mm / 2, quad_segs=4))
            for piece in _enclosed(burnt, kerf_mm):
                key = tuple(np.round([*piece.bounds, piece.area], 2).tolist())
                if key in known:
                    continue
                known.add(key)
                for number in sorted(tree.query(piece, "intersects").tolist()):
                    contour, ring = rings[number]
                    inside_mm = shapely.intersection(ring, piece).length
                    open_yet = last[contour.id] > torch[n] and contour.id not in told
                    if open_yet and inside_mm > min(_LEAST_MM, ring.length / 4):
                        told.add(contour.id)
                        yield _violation(contour, runs[last[contour.id]], runs[torch[n]], piece)


def _clusters(lines: Sequence[shapely.Geometry], partial: Sequence[bool], kerf_mm: float) -> list[list[int]]:
    """Runs whose kerfs meet, in order of time; clusters of runs that are all whole rounds are left out."""
    one, other = shapely.STRtree(lines).query(lines, "dwithin", distance=kerf_mm)
    label = weak_components(len(lines), np.column_stack([one, other]))
    clusters: list[list[int]] = [[] for _ in range(int(label.max(initial=-1)) + 1)]
    for k, number in enumerate(label.tolist()):
        clusters[number].append(k)
    return [cluster for cluster in clusters if any(partial[k] for k in cluster)]


def _enclosed(burnt: shapely.Geometry, kerf_mm: float) -> Iterator[shapely.Polygon]:
    """Pieces of metal with kerf all round; crumbs are none."""
    for part in shapely.get_parts(burnt):
        for ring in shapely.get_rings(part)[1:]:
            piece = shapely.Polygon(ring)
            if piece.area > kerf_mm**2:
                yield piece


def _violation(contour: Contour, cut: TorchRun, closed: TorchRun, piece: shapely.Polygon) -> Violation:
    x, y = shapely.point_on_surface(piece).coords[0]
    text = (
        f"{cut.where}: {contour.id} is cut in metal that is loose since {closed.where}: the piece at "
        f"({x:z.1f}, {y:z.1f}), {piece.area:.0f} mm², holds to nothing any more"
    )
    return Violation(_RULE, (contour.id,), text, (cut.position,) if cut.position else ())
