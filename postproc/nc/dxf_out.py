"""A plan's torch paths as a drawing, for controls and CAM systems that take DXF: a polyline a cut, in cutting order."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.profile import Profile

from .plan_paths import Toolpath, toolpaths

LAYERS: Mapping[str, str] = {
    "outer": "CUT_OUTER",
    "hole": "CUT_HOLE",
    "slit": "CUT_SLIT",
    "mark": "MARK",
    "scrap": "CUT_SCRAP",
}
"""The layer of each kind of contour."""


def write_dxf(plan: Plan, nest: Nest, profile: Profile) -> str:
    """The torch paths of `plan` as DXF R12, in mm: polylines in the order of the cuts, each in its direction.

    Each begins at the pierce and ends where the torch goes off, leads included, kerf allowed for; arcs are bulges.
    What is linked is one polyline. Coordinates are the program's. The same plan gives the same bytes.

    Raises
    ------
    InputError
        If the plan was made from another nest, or for several torches, which no drawing can tell.
    """
    if any(planned.cut.torch > 1 for planned in plan.cuts):
        raise InputError("a drawing of the torch's paths knows one torch, and the plan uses several (machine.torches)")
    from ezdxf.addons.r12writer import r12writer  # loaded by those who ask for a drawing only

    profile = profile.at_origin(plan.origin)
    x, y = profile.frame_on(profile.as_cut(nest)).corner
    text = io.StringIO(newline="")
    with r12writer(text) as drawing:
        for made in _burns(toolpaths(plan, nest, profile)):
            for piece in made.pieces[::2]:
                rows = piece.moved(-x, -y).vertices.tolist()
                drawing.add_polyline_2d(rows, format="xyb", closed=False, layer=LAYERS[made.planned.kind])
    return text.getvalue()


def _burns(paths: Iterable[Toolpath]) -> Iterator[Toolpath]:
    """The paths, what is linked as one, of the kind of its first."""
    burn: Toolpath | None = None
    for made in paths:
        if burn is not None and made.linked:
            rows = np.vstack([burn.path.vertices[:-1], made.path.vertices])
            burn = replace(burn, path=Curve(rows, closed=False))
            continue
        if burn is not None:
            yield burn
        burn = made
    if burn is not None:
        yield burn
