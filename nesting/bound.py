"""What no layout can cost less than: by the area that parts take, the gap between them included."""

from __future__ import annotations

import math

import numpy as np
import shapely
from scipy.optimize import Bounds, LinearConstraint, milp

from kerfwise.encoder.nest import Part, Sheet

from .wanted import Spacing, Wanted


def least_worth(wanted: Wanted, spacing: Spacing) -> float:
    """The least that whole sheets are worth, remnants for nothing, on which all parts would fit if they were liquid.

    Half the gap lies around each part, in its holes too, and no two parts share any of it. A knapsack, solved by HiGHS.
    Infinite where all that there is would be too little.

    Examples
    --------
    Four squares of 46 mm, 4 mm apart, need all of a sheet of 100 mm, and a fifth needs another one:

    >>> from kerfwise.encoder.by_hand import part, rect
    >>> from kerfwise.nesting.wanted import PartType, Stock
    >>> square, sheets = part("A", rect(0, 0, 46, 46)), (Stock("100x100", Sheet.rectangle(100, 100), price=7.0),)
    >>> [least_worth(Wanted((PartType("A", square, n),), sheets), Spacing(4.0, 2.0)) for n in (4, 5)]
    [7.0, 14.0]
    """
    needed_mm2 = sum(kind.quantity * _taken_mm2(kind.part, spacing) for kind in wanted.types)
    ground_mm2 = np.array([_ground_mm2(stock.sheet, spacing) for stock in wanted.stocks])
    worth = np.array([0.0 if stock.remnant else stock.worth for stock in wanted.stocks])
    most = [math.inf if stock.count is None else stock.count for stock in wanted.stocks]
    enough = LinearConstraint(ground_mm2[None, :] / needed_mm2, lb=1.0 - 1e-9)
    whole, exact = np.ones(len(worth)), {"mip_rel_gap": 0.0}
    found = milp(worth, integrality=whole, bounds=Bounds(0, most), constraints=enough, options=exact)
    return round(float(found.fun), 3) if found.success else math.inf


def _taken_mm2(part: Part, spacing: Spacing) -> float:
    """Within half a gap of the part's metal."""
    return float(part.polygon.buffer(spacing.gap_mm / 2).area)


def _ground_mm2(sheet: Sheet, spacing: Spacing) -> float:
    """Within half a gap of where metal of parts may be."""
    metal: shapely.Geometry = sheet.polygon.buffer(-spacing.edge_mm)
    return float(metal.buffer(spacing.gap_mm / 2, join_style="mitre").area)
