"""Why every contour is cut where it is, and temperatures of the sheet, as data for the page."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Iterable, Sequence
from typing import Any, Literal

import numpy as np

from kerfwise.arrays import Float32s
from kerfwise.encoder.errors import InputError
from kerfwise.jobs.explainer import Explainer
from kerfwise.jobs.heat_path import path_of_plan
from kerfwise.jobs.inputs import Inputs, of_first_torch
from kerfwise.models.physics.heat import simulate
from kerfwise.models.physics.heat.physical import point_steps
from kerfwise.models.physics.heat.timed_path import MOST_POINTS, make_grid
from kerfwise.models.plan.explain.alternatives import (
    Entry,
    Hold,
    OtherEntry,
    Relocation,
    blocking_orders,
    other_statements,
)
from kerfwise.models.plan.explain.context import PlanContext
from kerfwise.models.plan.explain.explain import Explanation, difference, entry_words
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.statements import About

from .page_html import Data, short

# Why every contour is cut where it is, as data: what `kerfwise explain` says, worked out beforehand.

FULL = 400
"""Contours of plans whose entries and moves are all tried out: the work grows with the square of their number."""
HELD = 2000
"""Contours of plans for which the rules are stated again to say what holds each."""
_PLACES = 3
Detail = Literal["none", "held", "full"]
"""How much a page says of why a contour is cut where it is: what the plan says, what holds it too, or what moving it
would cost as well."""


def reasons(inputs: Inputs, plan: Plan, detail: Detail | None = None) -> dict[str, Data]:
    """By contour id, what there is to say of it; None chooses the detail by the number of contours.

    Cuts of further torches are told with the first one's. Nothing for plans that the rules of today cannot explain.
    """
    count = len(plan.cuts)
    detail = detail or ("full" if count <= FULL else "held" if count <= HELD else "none")
    if detail == "none":
        return {}
    try:
        explainer = Explainer(inputs, plan)
        if detail == "full":
            return {p.cut.contour: why_data(explainer.explain(p.cut.contour)) for p in of_first_torch(plan).cuts}
        setting = explainer.setting
    except InputError:
        return {}
    return {p.cut.contour: _held(setting, p.cut.contour) for p in of_first_torch(plan).cuts}


def why_data(e: Explanation) -> Data:
    """One explanation, as the page shows it."""
    sentences = [e.drawn, e.small, e.slit, e.tabs, e.linked, e.pierced, e.common]
    if e.dwell_s:
        sentences.append(e.waits_because or f"waits {e.dwell_s:g} s first, so that metal may cool")
    if e.zone_heat_kj is not None:
        sentences.append(
            f"zone {e.zone} takes up {e.zone_heat_kj:.1f} kJ at the most, of a budget of {e.zone_budget_kj:g} kJ"
        )
    return {
        "full": True,
        "place": e.place,
        "of": e.of,
        "zone": e.zone,
        "after": e.previous,
        "before": e.following,
        "said": [text for text in sentences if text],
        "earlier": _holds(e.earlier),
        "later": _holds(e.later),
        "also": _abouts(e.also),
        "heat": [
            {"rule": p.about.rule, "text": p.about.sentence, "kept": p.kept, "price_mm": short(p.price_mm, 1)}
            for p in e.heat
        ],
        "entry": _entry(e.entry, bool(e.linked)),
        "moves": [_move(e.contour, move) for move in e.moves],
        "notes": list(e.notes),
    }


def _held(setting: PlanContext, contour: str) -> Data:
    """What holds a contour, without trying anything out."""
    number, order = setting.facts.nest.index[contour], setting.order
    k = order.index(number)
    return {
        "full": False,
        "place": k + 1 + setting.made,
        "of": len(order) + setting.made,
        "zone": int(setting.facts.zone[number]),
        "after": setting.name(order[k - 1]) if k else "",
        "before": setting.name(order[k + 1]) if k + 1 < len(order) else "",
        "said": [text for text in (setting.facts.nest.contours[number].source.told(),) if text],
        "earlier": _holds(blocking_orders(setting, number, earlier=True)),
        "later": _holds(blocking_orders(setting, number, earlier=False)),
        "also": _abouts(other_statements(setting, number)),
        "heat": [],
        "entry": None,
        "moves": [],
        "notes": list(setting.notes),
    }


def _holds(held: Sequence[Hold]) -> Data:
    """The nearest of every rule, and how many more there are."""
    nearest = list({h.about.rule: h for h in reversed(held)}.values())[::-1]
    rows = [{"contour": h.contour, "place": h.place, "rule": h.about.rule, "text": h.about.sentence} for h in nearest]
    return {"nearest": rows, "more": len(held) - len(nearest)}


def _abouts(abouts: Iterable[About]) -> list[Data]:
    return [{"rule": about.rule, "text": about.sentence} for about in abouts]


def _entry(entry: Entry, linked: bool) -> Data:
    against: dict[About, list[OtherEntry]] = {}
    for way in entry.unlawful:
        for about in way.against:
            against.setdefault(about, []).append(way)
    return {
        "used": _way(entry.used) | ({"text": "on the link"} if linked else {}),
        "one_way_by": list(entry.one_way_by),
        "lawful": [_way(way) | {"cost": difference(way.more_um)} for way in entry.lawful],
        "unlawful": [
            {"rule": about.rule, "text": about.sentence, "ways": [_way(way) for way in ways[:_PLACES]],
             "more": max(0, len(ways) - _PLACES)}
            for about, ways in against.items()
        ],
    }  # fmt: skip


def _way(way: OtherEntry) -> dict[str, Any]:
    x, y = way.entry
    return {"at": [short(x, 1), short(y, 1)], "direction": way.direction, "text": entry_words(way)}


def _move(contour: str, move: Relocation) -> Data:
    return {
        "label": move.label,
        "place": move.place,
        "together": [name for name in move.moved if name != contour],
        "cost": "" if move.breaks else difference(move.more_um),
        "breaks": _abouts(move.breaks),
    }


# Temperatures of the sheet over the program, as few numbers as a screen can show.

FRAMES = 60
SQUARES = 160
"""Squares of a frame along its longer side, at the most."""
OVER = 2.0
"""The numbers reach so many times as far above the air as the limit does."""
_QUICK = 5e9
"""Points times steps that are simulated unasked: some ten seconds."""


def heat_data(inputs: Inputs, plan: Plan, wanted: bool | None = None) -> Data | None:
    """Frames of the sheet, evenly over the program: a byte a square, 0 as warm as the air, 255 the hottest.

    All frames follow each other, rows from the bottom up, deflated and in base64. None where heat is not `wanted`, the
    plan states no times, or nobody asked (None) and it would take long.
    """
    nest, heat = inputs.nest, inputs.profile.heat
    timed = any(planned.cut.end_s for planned in plan.cuts)
    if wanted is False or not timed or plan.already or not heat.absorbed_power_w:
        return None
    area_mm2 = nest.sheet.polygon.area
    long = point_steps(area_mm2, plan.totals.time_s, heat) > _QUICK or area_mm2 / heat.grid_mm**2 > MOST_POINTS
    if wanted is None and long:
        return None
    try:
        path = path_of_plan(plan, nest, inputs.profile)
        grid = make_grid(nest, heat.grid_mm)
        step = max(1, -(-max(grid.shape) // SQUARES))
        top_c = heat.ambient_c + OVER * (heat.limit_c - heat.ambient_c)
        frames: list[bytes] = []
        at_s: list[float] = []

        def look(now_s: float, field: Float32s) -> None:
            if len(frames) < FRAMES:
                frames.append(_squares(field, step, heat.ambient_c, top_c))
                at_s.append(short(now_s, 2))

        thickness_mm = inputs.profile.material.thickness_mm
        found = simulate(nest, path, heat, thickness_mm, (path.end_s / FRAMES, look), grid)
    except InputError:
        if wanted:
            raise
        return None
    wide, high = (-(-count // step) for count in grid.shape)
    return {
        "model": found.model,
        "at_s": at_s,
        "wide": wide,
        "high": high,
        "left_mm": short(grid.x0_mm - grid.step_mm / 2),
        "bottom_mm": short(grid.y0_mm - grid.step_mm / 2),
        "square_mm": short(grid.step_mm * step),
        "ambient_c": heat.ambient_c,
        "limit_c": heat.limit_c,
        "top_c": top_c,
        "peak_c": round(found.peak_c, 1),
        "overheats": found.overheats,
        "frames": base64.b64encode(zlib.compress(b"".join(frames), 9)).decode(),
    }


def _squares(field: Float32s, step: int, ambient_c: float, top_c: float) -> bytes:
    """The hottest point of each square, as bytes, row by row."""
    wide, high = (-(-count // step) * step for count in field.shape)
    padded = np.full((wide, high), ambient_c, dtype=np.float32)
    padded[: field.shape[0], : field.shape[1]] = field
    hottest = padded.reshape(wide // step, step, high // step, step).max(axis=(1, 3))
    scaled = np.clip((hottest - ambient_c) / (top_c - ambient_c), 0, 1) * 255
    return bytes(np.round(scaled).astype(np.uint8).T.tobytes())
