"""The job: an order becomes nests, which are checked before anything is written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.nesting.allot import Layout
from kerfwise.nesting.fitting import too_large
from kerfwise.nesting.shapes import Shapes
from kerfwise.nesting.wanted import Spacing, Wanted
from kerfwise.nesting.written import nest_json, nests_of
from kerfwise.postproc.check.nests import AskedCommon, AskedPart, AskedSheet, AskedSpacing, nest_faults


@dataclass(frozen=True, eq=False, slots=True)
class Nested:
    """What came of an order: the layout, a nest and its text for each sheet, and what the check found wrong."""

    layout: Layout
    nests: tuple[Nest, ...]
    texts: tuple[str, ...]
    faults: tuple[str, ...]

    @property
    def names(self) -> list[str]:
        """What the nests are called: `sheet1`, `sheet2`…"""
        return [f"sheet{k}" for k in range(1, len(self.nests) + 1)]


def expect_room(wanted: Wanted, spacing: Spacing) -> None:
    """Refuse an order with a part that fits on no sheet."""
    shapes = Shapes(wanted.types, spacing.gap_mm, spacing.common)
    if never := too_large(wanted, shapes, spacing):
        raise InputError(
            f"{len(never)} of {len(wanted.types)} parts fit on no sheet, not even on an empty one, with "
            f"{spacing.edge_mm:g} mm to its edge",
            details=tuple(_size(wanted, kind) for kind in never),
        )


def _size(wanted: Wanted, kind: int) -> str:
    part = wanted.types[kind]
    x0, y0, x1, y1 = part.part.outer.polygon.bounds
    return f"{part.name} is {x1 - x0:.1f} × {y1 - y0:.1f} mm: give a larger sheet, or allow other rotations"


def nests_from(layout: Layout) -> Nested:
    """A layout as nests, with what the check finds wrong in their texts."""
    nests = nests_of(layout)
    texts = [nest_json(nest) for nest in nests]
    faults = faults_of(texts, layout.wanted, layout.spacing, layout.missing)
    return Nested(layout, tuple(nests), tuple(texts), tuple(faults))


def faults_of(texts: Sequence[str], wanted: Wanted, spacing: Spacing, missing: Sequence[int]) -> list[str]:
    """What the check finds wrong in nests of an order; it is told what the order was, and nothing of the layout."""
    parts = [
        AskedPart(
            kind.name,
            kind.part,
            kind.quantity,
            None if kind.free else kind.turns_deg,
            kind.mirror,
            kind.quantity - lost,
        )
        for kind, lost in zip(wanted.types, missing, strict=True)
    ]
    sheets = [AskedSheet(stock.name, stock.sheet, stock.count) for stock in wanted.stocks]
    written = {f"sheet{k}": text.encode() for k, text in enumerate(texts, 1)}
    common = spacing.common
    edges = None if common is None else AskedCommon(common.apart_mm, common.shortest_mm, common.tolerance_mm)
    return nest_faults(written, parts, sheets, AskedSpacing(spacing.gap_mm, spacing.edge_mm, edges))
