"""An explanation in a planner's words, or as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.listed import listed
from kerfwise.rules.statements import EXEMPTION_MM, About

from .entry import Entry, OtherEntry
from .heat_prices import HeatPrice
from .holding import Hold
from .moves import Relocation

FEW = 3
EXEMPTION_UM = round(EXEMPTION_MM * UM_PER_MM)


@dataclass(frozen=True, slots=True)
class Explanation:
    """What there is to say of one contour; places count from 1.

    `previous` and `following` are its neighbours in the plan, "" for the machine's home. `earlier` and `later` hold
    it, nearest first; the chains lead on from there to the ends of the plan. `also` are statements of other kinds,
    `heat` prices on orders and entries that overheat metal. The torch waits for `dwell_s` before the contour is cut,
    and why. Where zones have a budget of heat, `zone_heat_kj` says how much goes into this one at the most. `small`
    says why a small hole is not cut but marked, `slit` what a slit opens and costs. `linked` says that the
    torch stays on before it, and why, `tabs` why tabs hold the part, `common` which neighbours have cut some of it.
    """

    contour: str
    place: int
    of: int
    zone: int
    previous: str
    following: str
    earlier: tuple[Hold, ...]
    later: tuple[Hold, ...]
    earlier_chain: tuple[Hold, ...]
    later_chain: tuple[Hold, ...]
    also: tuple[About, ...]
    entry: Entry
    moves: tuple[Relocation, ...]
    notes: tuple[str, ...]
    heat: tuple[HeatPrice, ...] = ()
    dwell_s: float = 0.0
    waits_because: str = ""
    zone_heat_kj: float | None = None
    zone_budget_kj: float | None = None
    small: str = ""
    slit: str = ""
    linked: str = ""
    tabs: str = ""
    pierced: str = ""
    common: str = ""

    def __str__(self) -> str:
        return as_text(self)


def as_text(explanation: Explanation, everything: bool = False) -> str:
    """The explanation as lines of text; with `everything`, all that holds the contour and the chains to the ends."""
    return "\n".join(_lines(explanation, everything))


def explanation_as_json(explanation: Explanation) -> str:
    """The explanation as JSON: the fields of `Explanation`, lengths that end in `_um` in µm."""
    data: dict[str, Any] = asdict(explanation)
    return json.dumps(data, ensure_ascii=False, indent=1)


def _lines(e: Explanation, everything: bool) -> Iterator[str]:
    yield (
        f"{e.contour} is cut {_nth(e.place)} of {e.of}, in zone {e.zone}: after {e.previous or 'leaving home'}, "
        f"before {e.following or 'going home'}"
    )
    yield from filter(None, (e.small, e.slit, e.tabs))
    if e.zone_heat_kj is not None:
        yield f"zone {e.zone} takes up {e.zone_heat_kj:.1f} kJ at the most, of a budget of {e.zone_budget_kj:g} kJ"
    if e.dwell_s:
        yield e.waits_because or f"waits {e.dwell_s:g} s first, so that metal may cool"
    yield from filter(None, (e.linked, e.pierced, e.common))
    yield from _holds("not earlier", e.earlier, everything)
    yield from _holds("not later", e.later, everything)
    if e.also:
        yield "also"
        yield from _listed([f"{about.rule}: {about.sentence}" for about in e.also], everything)
    if e.heat:
        yield "heat"
        prices = [f"{'kept' if p.kept else f'broken, costs {p.price_mm:.0f} mm'}: {p.about.sentence}" for p in e.heat]
        yield from _listed(prices, everything)
    if not (e.earlier or e.later or e.also or e.heat):
        yield f"no order rule is about {e.contour}: it is cut here for the shortest travel"
    if everything:
        yield from _chain("the chain back", e.contour, e.earlier_chain)
        yield from _chain("the chain on", e.contour, e.later_chain)
    yield from _entry(e, everything)
    yield "if it were moved"
    yield from (f"  - {_moved(e.contour, move)}" for move in e.moves)
    if all(move.breaks for move in e.moves):
        yield "  - no other place is lawful for it while the other contours keep their order"
    yield from (f"note: {note}" for note in e.notes)


def _holds(title: str, held: Sequence[Hold], everything: bool) -> Iterator[str]:
    """What holds the contour: the nearest of every rule, unless all is asked for."""
    if held:
        yield title
        nearest = held if everything else list({h.about.rule: h for h in reversed(held)}.values())[::-1]
        yield from (f"  - cut {h.place}, {h.about.rule}: {h.about.sentence}" for h in nearest)
        if len(held) > len(nearest):
            yield f"  - and {len(held) - len(nearest)} more of these rules (--all shows them)"


def _listed(lines: Sequence[str], everything: bool) -> Iterator[str]:
    shown = lines if everything else lines[:FEW]
    yield from (f"  - {line}" for line in shown)
    if len(lines) > len(shown):
        yield f"  - and {len(lines) - len(shown)} more (--all shows them)"


def _chain(title: str, contour: str, held: Sequence[Hold]) -> Iterator[str]:
    if held:
        yield f"{title}: {contour}" + "".join(f" – {h.contour} (cut {h.place}, {h.about.rule})" for h in held)


def _entry(e: Explanation, everything: bool) -> Iterator[str]:
    entry = e.entry
    how = "on the link" if e.linked else begun(entry.used)
    yield f"entered at {_at(entry.used.entry)} and cut {entry.used.direction}, {how}"
    if entry.one_way_by:
        yield f"  - {' and '.join(entry.one_way_by)} leaves no other way round than {entry.used.direction}"
    yield from _lawful(entry)
    yield from _unlawful(entry, everything)


def _lawful(entry: Entry) -> Iterator[str]:
    if not entry.lawful:
        yield "  - no other entry is lawful in this order"
        return
    best = entry.lawful[0]
    others = "" if len(entry.lawful) == 1 else f" ({len(entry.lawful)} others are lawful, this is the best of them)"
    where = f"enters at {_at(best.entry)}, {best.direction}"
    if (best.entry, best.direction) == (entry.used.entry, entry.used.direction):
        where = f"enters there too, but is {begun(best)}"
    yield f"  - the next best {where}: {difference(best.more_um)}{others}"


def begun(way: OtherEntry) -> str:
    """How a cut begins, and where."""
    how = "begun in a neighbour's kerf" if way.in_kerf else "begun off the edge of the sheet"
    return f"{how if way.from_edge or way.in_kerf else 'pierced'} at {_at(way.pierce)}"


def _unlawful(entry: Entry, everything: bool) -> Iterator[str]:
    lines = []
    for about in dict.fromkeys(about for way in entry.unlawful for about in way.against):
        where = list(dict.fromkeys(f"{_at(w.entry)} {w.direction}" for w in entry.unlawful if about in w.against))
        shown = listed(where, len(where) if everything else FEW)
        lines.append(f"unlawful: {shown}, {about.rule}: {about.sentence}")
    yield from _listed(lines, everything)


def _moved(contour: str, move: Relocation) -> str:
    run = [name for name in move.moved if name != contour]
    together = f" together with {', '.join(run[:FEW])}{' …' if len(run) > FEW else ''}" if run else ""
    head = f"{move.label} ({_nth(move.place)}){together}: "
    if not move.breaks:
        return head + difference(move.more_um)
    rules = listed([f"{about.rule} ({about.sentence})" for about in move.breaks], 1)
    return head + f"breaks {rules}"


def difference(more_um: int | None) -> str:
    """A difference in cost; excuses from hard rules are told apart from millimetres."""
    um = more_um or 0
    excuses = round(um / EXEMPTION_UM)
    um -= excuses * EXEMPTION_UM
    mm = f"{abs(um) / UM_PER_MM:.1f} mm {'more' if um > 0 else 'less'}" if um else "as long"
    if not excuses:
        return mm
    return f"{abs(excuses)} {'more' if excuses > 0 else 'fewer'} excuses from hard rules, {mm}"


def _at(point: Point) -> str:
    return f"({point[0]:.1f}, {point[1]:.1f})"


def _nth(place: int) -> str:
    suffix = {1: "st", 2: "nd", 3: "rd"}.get(place % 10, "th") if place % 100 not in (11, 12, 13) else "th"
    return f"{place}{suffix}"
