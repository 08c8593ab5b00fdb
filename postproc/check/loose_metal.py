"""Burns in metal that has come loose: pieces that several burns have cut off together before all in them was cut.

What one burn cuts off by going round one contour is what the rules on inner and nested contours are about. Here are
pieces that only the kerfs of several burns enclose, such as a row of parts with common edges.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

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
        burnt = Burnt(kerf_mm)
        known: set[tuple[float, ...]] = set()
        for n in cluster:
            for piece in burnt.by(shapely.buffer(lines[n], kerf_mm / 2, quad_segs=4)):
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


class Burnt:
    """What several burns have burnt, kept as its outlines and the pieces of metal that these enclose.

    Each burn is put together with what it meets alone, so that many burns take no longer for each other.
    """

    def __init__(self, kerf_mm: float) -> None:
        self.kerf_mm = kerf_mm
        self._lumps: list[_Lump] = []

    def by(self, kerf: shapely.Geometry) -> Iterator[shapely.Polygon]:
        """The pieces that one more burn has enclosed, or has cut something off; crumbs are none."""
        for burn in shapely.get_parts(kerf):
            yield from self._by_one(burn)

    def _by_one(self, burn: shapely.Polygon) -> list[shapely.Polygon]:
        met = [lump for lump in self._lumps if lump.met_by(burn)]
        kept: list[Any] = []
        grown = shapely.get_parts(shapely.union_all([burn, *(lump.outline for lump in met)])).tolist()
        made = [shapely.Polygon(ring) for area in grown for ring in area.interiors]
        for lump in met:
            taken = shapely.union_all([burn, *(other.outline for other in met if other.lies_in(lump))])
            cut = shapely.intersects(lump.pieces, taken)
            kept += lump.pieces[~cut].tolist()
            left = shapely.get_parts(shapely.difference(lump.pieces[cut], taken)).tolist()
            made += [shapely.Polygon(area.exterior) for area in left if isinstance(area, shapely.Polygon)]
        made = sorted((piece for piece in made if piece.area > self.kerf_mm**2), key=lambda piece: piece.bounds)
        pieces = np.array([*kept, *made], dtype=object)
        self._lumps = [lump for lump in self._lumps if all(lump is not one for one in met)]
        for area in grown:  # more than one where two do no more than touch
            outline = shapely.Polygon(area.exterior)
            self._lumps.append(_Lump(outline, pieces[shapely.covers(outline, pieces)]))
        return made


@dataclass(frozen=True, eq=False, slots=True)
class _Lump:
    """Burnt metal that hangs together: its outline, filled, and the pieces within that are not burnt, filled too."""

    outline: shapely.Polygon
    pieces: Any

    def met_by(self, burn: shapely.Polygon) -> bool:
        """Whether a burn comes to the burnt metal itself, not only into a piece within."""
        return bool(shapely.intersects(self.outline, burn) and not shapely.contains_properly(self.pieces, burn).any())

    def lies_in(self, other: _Lump) -> bool:
        """Whether it lies in a piece that another encloses."""
        inside = self.outline.area < other.outline.area and shapely.intersects(self.outline, other.outline)
        return self is not other and bool(inside)


def _violation(contour: Contour, cut: TorchRun, closed: TorchRun, piece: shapely.Polygon) -> Violation:
    x, y = shapely.point_on_surface(piece).coords[0]
    text = (
        f"{cut.where}: {contour.id} is cut in metal that is loose since {closed.where}: the piece at "
        f"({x:z.1f}, {y:z.1f}), {piece.area:.0f} mm², holds to nothing any more"
    )
    return Violation(_RULE, (contour.id,), text, (cut.position,) if cut.position else ())
