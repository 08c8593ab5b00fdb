"""Whether a skeleton is cut up as the profile asks, seen from the kerfs of the program alone.

Where the lines lie that were made for it is not asked: what they leave is measured.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from kerfwise.encoder.cut import Side
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.rules.judging.skeleton import largest_of
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Violation

from .rings import torch_rings
from .torch_run import TorchRun

_RULE = "scrap-pieces"
_SLACK_MM = 0.1
"""Chords, and the accuracy of programs."""
_NARROW_MM = 0.05
"""A web may be so much wider than the kerf, on either side, and still be no piece."""
_LEAST_MM = 50.0
"""A remnant with a shorter side is not worth keeping."""
_FILLED = 0.995
"""A rectangle fills so much of its bounds."""


def wrong_pieces(
    nest: Nest, runs: Sequence[TorchRun], made: Sequence[Contour], profile: Profile
) -> Iterator[Violation]:
    """Pieces of the skeleton that are larger than the grid asked for, and a remnant that is not saved.

    `made` were cut before a stop. Only the largest piece is looked at that the parts leave of the skeleton: what else
    came loose with them, before any line was cut, is not cut up, however large it is. Nor is metal
    narrower than the kerf: a line along it would leave nothing of it.
    """
    asked, kerf_mm = profile.cuts.scrap, profile.material.kerf_mm
    if kerf_mm <= 0 or (asked.grid_mm is None and asked.remnant is None):
        return
    rows = [(run.contour, shapely.union_all([run.loop, *run.leads])) for run in runs if not run.marks]
    rows += [(c, ring) for c, ring in zip(made, torch_rings(made, kerf_mm), strict=True) if ring is not None]
    of_line = np.array([contour is not None and contour.kind == "scrap" for contour, _ in rows], dtype=np.bool_)
    burnt = shapely.buffer(np.array([line for _, line in rows], dtype=object), kerf_mm / 2, quad_segs=4)
    parts = shapely.make_valid([part.outer.polygon for part in nest.parts])
    gone = shapely.union_all(shapely.buffer(parts, kerf_mm, quad_segs=4))  # what tabs leave of a kerf is no piece
    half_mm = kerf_mm / 2 + _NARROW_MM
    skeleton = shapely.make_valid(nest.sheet.polygon) - gone
    skeleton = skeleton.buffer(-half_mm, quad_segs=4).buffer(half_mm, quad_segs=4) - shapely.union_all(burnt[~of_line])
    if skeleton.is_empty:
        return
    frame = largest_of(shapely.get_parts(skeleton).tolist())
    pieces = [p for p in shapely.get_parts(frame - shapely.union_all(burnt[of_line])) if p.area > kerf_mm**2]
    kept = None
    if asked.remnant is not None:
        kept = _along(pieces, asked.remnant, nest)
        if kept is None:
            text = f"no rectangle with sides of {_LEAST_MM:g} mm or more is saved along the {asked.remnant} side"
            yield Violation(_RULE, (), f"{text} (cuts.scrap.remnant)")
    for piece in pieces:
        x0, y0, x1, y1 = piece.bounds
        if asked.grid_mm is not None and piece is not kept and max(x1 - x0, y1 - y0) > asked.grid_mm + _SLACK_MM:
            at = shapely.point_on_surface(piece)
            text = f"a piece of the skeleton of {x1 - x0:.0f} × {y1 - y0:.0f} mm is left at ({at.x:z.1f}, {at.y:z.1f})"
            yield Violation(_RULE, (), f"{text}, more than {asked.grid_mm:g} mm (cuts.scrap.grid)")


def _along(pieces: Sequence[shapely.Polygon], side: Side, nest: Nest) -> shapely.Polygon | None:
    """The largest rectangle among the pieces at a side of the sheet."""
    number = {"left": 0, "bottom": 1, "right": 2, "top": 3}[side]
    edge = nest.sheet.bounds[number]
    found = [
        piece
        for piece in pieces
        if abs(piece.bounds[number] - edge) < _SLACK_MM
        and piece.area > _FILLED * shapely.box(*piece.bounds).area
        and min(piece.bounds[2] - piece.bounds[0], piece.bounds[3] - piece.bounds[1]) > _LEAST_MM - _SLACK_MM
    ]
    return max(found, key=lambda piece: piece.area, default=None)
