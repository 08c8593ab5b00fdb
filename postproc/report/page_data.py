"""A nest and its plan as the data of the page: what can be said without a profile."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from kerfwise.encoder.cut import Cut, Pierce
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan, PlannedCut

from .legend import nest_name

FORMAT = "kerfwise-page/1"
Data = dict[str, Any]


def page_of(nest: Nest, sides: Sequence[Data], title: str, alert: Iterable[str] = (), caption: str = "") -> Data:
    """The data of a page: the nest and its sides, none, one, or two that are compared.

    Contours in `alert` are drawn in red, and `caption` says why.
    """
    return {
        "format": FORMAT,
        "title": title,
        "caption": caption,
        "nest": nest_data(nest),
        "alert": [nest.index[name] for name in alert if name in nest.index],
        "sides": list(sides),
        "comparison": None,
    }


def plain_page(nest: Nest, plan: Plan | None, home: Point, alert: Iterable[str] = (), caption: str = "") -> Data:
    """The page of a nest, with its plan if there is one, as far as both tell by themselves."""
    sides = [] if plan is None else [side_data(nest, plan, home)]
    return page_of(nest, sides, nest_name(nest, plan), alert, caption)


def nest_data(nest: Nest) -> Data:
    """Sheet, parts and contours; rows are x, y, bulge, x, y, bulge, …, mm."""
    number = {part.id: k for k, part in enumerate(nest.parts)}
    return {
        "file": nest.file,
        "sha256": nest.sha256,
        "bounds": [round(v, 3) for v in nest.sheet.bounds],
        "sheet": [rows_of(curve) for curve in (nest.sheet.outline, *nest.sheet.holes)],
        "parts": [part.id for part in nest.parts],
        "contours": [
            {
                "id": contour.id,
                "part": number.get(contour.part, -1),
                "kind": contour.kind,
                "rows": rows_of(contour.curve),
                "closed": contour.curve.closed,
            }
            for contour in nest.contours
        ],
        "left_out": [rows_of(hole.curve) for hole in nest.not_cut],
        "notes": [note.text for note in nest.notes],
    }


def rows_of(curve: Curve) -> list[float]:
    """A curve as x, y, bulge of each vertex in one list, mm to 3 decimals.

    Examples
    --------
    >>> rows_of(Curve.of([(0, 0), (1, 0, 0.5), (1, 1)]))
    [0, 0, 0, 1, 0, 0.5, 1, 1, 0]
    """
    return [short(value, 3 + 3 * (k % 3 == 2)) for k, value in enumerate(curve.vertices.ravel().tolist())]


def short(value: float, digits: int = 3) -> float:
    """A number that is written shortly: whole ones without a point."""
    rounded = round(value, digits)
    return int(rounded) if rounded == int(rounded) else rounded


def side_data(nest: Nest, plan: Plan, home: Point) -> Data:
    """One plan: its cuts, its figures, and what it says of each rule. Paths are as drawn: no kerf is known."""
    solve, totals = plan.solve, plan.totals
    return {
        "name": "",
        "profile": plan.profile.get("name", ""),
        "kerf_mm": 0,
        "home": [short(v) for v in home],
        "made": plan.resumed_after,
        "end_s": short(totals.time_s),
        "figures": {
            "cut_mm": short(totals.cut_mm),
            "idle_mm": short(totals.idle_mm),
            "pierces": totals.pierces,
            "status": solve.status,
            "gap": solve.gap,
            "light_gap": plan.light_gap,
        },
        "said": [],
        "ok": all(rule.holds for rule in plan.rules if rule.strength == "hard"),
        "cuts": [cut_data(nest, planned) for planned in plan.cuts],
        "pierces": [pierce_data(nest, pierce) for pierce in plan.pierces],
        "already": [nest.index[p.cut.contour] for p in plan.already_cut if p.cut.contour in nest.index],
        "rules": _rules_of(plan),
        "dropped": [{"rule": d.rule, "contours": list(d.contours), "why": d.why} for d in plan.dropped],
        "left_out": [{"contour": left.contour, "why": left.why} for left in plan.left_out],
        "why": {},
        "heat": None,
        "nc": None,
    }


def cut_data(nest: Nest, planned: PlannedCut, path: Curve | None = None) -> Data:
    """One cut; `path` is the torch's way, else leads and contour as they are drawn."""
    cut = planned.cut
    return {
        "contour": nest.index[cut.contour],
        "zone": cut.zone,
        "direction": cut.direction,
        "entry": [short(v) for v in cut.entry],
        "from_s": short(cut.start_s),
        "to_s": short(cut.end_s),
        "stand_s": 0,
        "wait_s": short(planned.dwell_s),
        "length_mm": short(planned.length_mm, 1),
        "because": list(planned.because),
        "linked": cut.linked,
        "excused": list(cut.excused),
        "tabs": [[*(short(v) for v in tab.at), short(tab.width_mm)] for tab in cut.tabs],
        "path": rows_of(path if path is not None else _as_drawn(nest, cut)),
        "unlit": [],
        "slow": [],
    }


def pierce_data(nest: Nest, pierce: Pierce) -> Data:
    """One hole of a pierce pass."""
    return {
        "contour": nest.index.get(pierce.contour, -1),
        "at": [short(v) for v in pierce.at],
        "before": pierce.before,
        "from_s": short(pierce.start_s),
        "to_s": short(pierce.end_s),
    }


def _as_drawn(nest: Nest, cut: Cut) -> Curve:
    """Lead-in, the contour from its entry on, lead-out, one after the other."""
    curve = nest.contour(cut.contour).curve
    if curve.closed:
        turned = curve.towards(cut.direction)
        curve = turned.opened_at(turned.project(cut.entry)[0])
    elif cut.direction == "cw":
        curve = curve.reversed()
    rows: list[list[float]] = []
    for piece in (cut.lead_in, curve, cut.lead_out):
        if piece is not None:
            rows += piece.vertices.tolist()
            rows[-1] = [*rows[-1][:2], 0.0]
    return Curve.of(rows, closed=False)


def _rules_of(plan: Plan) -> list[Data]:
    return [
        {
            "id": rule.id,
            "sentence": "",
            "strength": rule.strength,
            "verdict": "holds" if rule.holds and not rule.exceptions else "excused" if rule.holds else "broken",
            "cost_mm": 0,
            "unjudged": "",
            "breaches": [{"contours": list(ids), "text": why} for ids, why in rule.breaches],
            "excused": [{"contours": list(ids), "text": "", "why": why} for ids, why in rule.exceptions],
        }
        for rule in plan.rules
    ]
