"""A plan's torch paths as a drawing, for controls and CAM systems that take DXF: a polyline a cut, in cutting order."""

from __future__ import annotations

import io
from collections.abc import Mapping

from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.profile import Profile

from .plan_paths import toolpaths

LAYERS: Mapping[str, str] = {"outer": "CUT_OUTER", "hole": "CUT_HOLE", "slit": "CUT_SLIT", "mark": "MARK"}
"""The layer of each kind of contour."""


def write_dxf(plan: Plan, nest: Nest, profile: Profile) -> str:
    """The torch paths of `plan` as DXF R12, in mm: polylines in the order of the cuts, each in its direction.

    Each begins at the pierce and ends where the torch goes off, leads included, kerf allowed for; arcs are bulges.
    Coordinates are the program's. The same plan gives the same bytes.

    Raises
    ------
    InputError
        If the plan was made from another nest.
    """
    from ezdxf.addons.r12writer import r12writer  # loaded by those who ask for a drawing only

    profile = profile.at_origin(plan.origin)
    x, y = profile.frame_on(profile.as_cut(nest)).corner
    text = io.StringIO(newline="")
    with r12writer(text) as drawing:
        for made in toolpaths(plan, nest, profile):
            rows = made.path.moved(-x, -y).vertices.tolist()
            drawing.add_polyline_2d(rows, format="xyb", closed=False, layer=LAYERS[made.planned.kind])
    return text.getvalue()
