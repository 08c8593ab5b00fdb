"""Why every contour is cut where it is, as data: what `kerfwise explain` says, worked out beforehand."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Literal

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.explaining import Explainer
from kerfwise.jobs.given import Given
from kerfwise.models.plan.explain import Explanation
from kerfwise.models.plan.explain.entry import Entry, OtherEntry
from kerfwise.models.plan.explain.holding import Hold, holds, others
from kerfwise.models.plan.explain.moves import Relocation
from kerfwise.models.plan.explain.setting import Setting
from kerfwise.models.plan.explain.words import begun, difference
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.report.page_data import Data, short
from kerfwise.rules.statements import About

FULL = 400
"""Contours of plans whose entries and moves are all tried out: the work grows with the square of their number."""
HELD = 2000
"""Contours of plans for which the rules are stated again to say what holds each."""
_PLACES = 3
Detail = Literal["none", "held", "full"]
"""How much a page says of why a contour is cut where it is: what the plan says, what holds it too, or what moving it
would cost as well."""


def reasons(given: Given, plan: Plan, detail: Detail | None = None) -> dict[str, Data]:
    """By contour id, what there is to say of it; None chooses the detail by the number of contours.

    Nothing for plans that the rules of today cannot explain.
    """
    count = len(plan.cuts)
    detail = detail or ("full" if count <= FULL else "held" if count <= HELD else "none")
    if detail == "none":
        return {}
    try:
        explainer = Explainer(given, plan)
        if detail == "full":
            return {p.cut.contour: why_data(explainer.explain(p.cut.contour)) for p in plan.cuts}
        setting = explainer.setting
    except InputError:
        return {}
    return {p.cut.contour: _held(setting, p.cut.contour) for p in plan.cuts}


def why_data(e: Explanation) -> Data:
    """One explanation, as the page shows it."""
    said = [e.small, e.slit, e.tabs, e.linked, e.pierced, e.common]
    if e.dwell_s:
        said.append(e.waits_because or f"waits {e.dwell_s:g} s first, so that metal may cool")
    if e.zone_heat_kj is not None:
        said.append(
            f"zone {e.zone} takes up {e.zone_heat_kj:.1f} kJ at the most, of a budget of {e.zone_budget_kj:g} kJ"
        )
    return {
        "full": True,
        "place": e.place,
        "of": e.of,
        "zone": e.zone,
        "after": e.previous,
        "before": e.following,
        "said": [text for text in said if text],
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


def _held(setting: Setting, contour: str) -> Data:
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
        "said": [],
        "earlier": _holds(holds(setting, number, earlier=True)),
        "later": _holds(holds(setting, number, earlier=False)),
        "also": _abouts(others(setting, number)),
        "heat": [],
        "entry": None,
        "moves": [],
        "notes": list(setting.notes),
    }


def _holds(held: Sequence[Hold]) -> Data:
    """The nearest of every rule, and how many more there are."""
    nearest = list({h.about.rule: h for h in reversed(held)}.values())[::-1]
    told = [{"contour": h.contour, "place": h.place, "rule": h.about.rule, "text": h.about.sentence} for h in nearest]
    return {"nearest": told, "more": len(held) - len(nearest)}


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
    return {"at": [short(x, 1), short(y, 1)], "direction": way.direction, "text": begun(way)}


def _move(contour: str, move: Relocation) -> Data:
    return {
        "label": move.label,
        "place": move.place,
        "together": [name for name in move.moved if name != contour],
        "cost": "" if move.breaks else difference(move.more_um),
        "breaks": _abouts(move.breaks),
    }
