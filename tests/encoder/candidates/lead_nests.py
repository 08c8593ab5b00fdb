"""Random nests with parts of all shapes, and options of all kinds, for leads."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import strategies as st

from kerfwise import Nest
from kerfwise.rule_kit import LeadOptions, Part, circle, nest, part
from kerfwise.tests.encoder.geometry.rings import is_simple, star_rings

CELL_MM = 60


@st.composite
def lead_nests(draw: st.DrawFn) -> Nest:
    """Stars of lines and arcs, tilted plates with a hole, and discs that host a disc, close together."""
    columns, rows = draw(st.integers(1, 3)), draw(st.integers(1, 2))
    gap_mm = draw(st.floats(3.5, 12))
    parts: list[Part] = []
    for k in range(columns * rows):
        x, y = CELL_MM * (k % columns + 0.5), CELL_MM * (k // columns + 0.5)
        r = (CELL_MM - gap_mm) / 2
        match draw(st.sampled_from(["star", "plate", "disc"])):
            case "star":
                ring = draw(star_rings().filter(is_simple))
                parts.append(part(f"S{k}", ring.moved(x, y).as_rows()))
            case "plate":
                angles = draw(st.floats(0, math.pi / 2)) + np.arange(4) * math.pi / 2
                corners = [(x + r * math.cos(a), y + r * math.sin(a)) for a in angles.tolist()]
                parts.append(part(f"R{k}", corners, [circle(x, y, draw(st.floats(2.5, r / 2)))]))
            case "disc":
                host = part(f"H{k}", circle(x, y, r), [circle(x, y, r - 3)])
                parts += [host, part(f"G{k}", circle(x, y, r - 3 - gap_mm))]
    return nest(CELL_MM * columns, CELL_MM * rows, *parts)


def lead_options() -> st.SearchStrategy[LeadOptions]:
    """Leads of all kinds that fit into gaps of 3.5 mm."""
    return st.builds(
        LeadOptions,
        entries=st.integers(1, 9),
        kerf_mm=st.sampled_from([0.0, 0.3, 1.5]),
        lead=st.sampled_from(["line", "arc"]),
        lead_in_mm=st.floats(2, 8),
        lead_in_min_mm=st.just(0.4),
        lead_out=st.sampled_from(["none", "line", "arc"]),
        lead_out_mm=st.floats(1, 6),
        pierce_clearance_mm=st.floats(0.5, 1.2),
        hole_overcut_mm=st.sampled_from([0.0, 1.0]),
        edge_start=st.just(True),
        reach=st.just((-100.0, -100.0, 3000.0, 1500.0)),
    )
