"""Why a contour is cut where it is, then, and so: everything that can be said of one contour of a finished plan."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.slits import narrow_because
from kerfwise.encoder.small_holes import uncut_hole_reasons
from kerfwise.models.heat_prices import HEAT
from kerfwise.models.plan.make_plan import bevels_because, common_because, tabs_because
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.technique import Technique
from kerfwise.rules.statements import (
    EXEMPTION_MM,
    About,
    Before,
    Statement,
    by_kind,
)
from kerfwise.rules.stating.state_rules import Stated

from .alternatives import (
    Entry,
    Hold,
    OtherEntry,
    PositionCosts,
    Relocation,
    blocking_orders,
    chain,
    explain_entry,
    explain_moves,
    other_statements,
)
from .context import PlanContext, make_context
from .reasons import EXEMPTION_UM, KeptOrders, Reasons, price_split


def explain(facts: Facts, profile: Technique, stated: Stated, plan: Plan, contour: str) -> Explanation:
    """Explain one contour of a plan under the facts and statements as they are now.

    Raises InputError if the nest has no such contour (the nearest names are given), or the plan is not one of this
    nest.
    """
    expect_planned(facts, plan, contour)
    return explained(make_context(facts, profile, stated, plan), plan, contour)


def expect_planned(facts: Facts, plan: Plan, contour: str) -> None:
    """Make sure that the plan cuts such a contour; InputError with the nearest id, or why it does not."""
    index = facts.nest.index
    left = next((left for left in plan.left_out if left.contour == contour), None)
    if contour not in index and left is not None:
        raise InputError(f"{contour} is not in the plan: {left.why}")
    if contour in (already := [cut.contour for cut in facts.already_cut]):
        raise InputError(
            f"{contour} was cut before the stop, as cut {already.index(contour) + 1}: the old plan explains it"
        )
    if contour not in index:
        raise InputError(unknown("contour", contour, index))


def explained(
    setting: PlanContext,
    plan: Plan,
    contour: str,
    along: PositionCosts | None = None,
    reasons: Reasons | None = None,
) -> Explanation:
    """One contour of a plan whose setting is made already, and perhaps what is known `along` its order."""
    along = along or PositionCosts(setting)
    reasons = reasons or Reasons(setting, along)
    facts, profile = setting.facts, setting.profile
    number = facts.nest.index[contour]
    order, budget_kj = setting.order, facts.options.zone_heat_kj
    k = order.index(number)
    planned = plan.items[k]
    return Explanation(
        contour,
        k + 1 + setting.made,
        len(order) + setting.made,
        int(facts.zone[number]),
        setting.name(order[k - 1]) if k else "",
        setting.name(order[k + 1]) if k + 1 < len(order) else "",
        blocking_orders(setting, number, earlier=True),
        blocking_orders(setting, number, earlier=False),
        chain(setting, number, earlier=True),
        chain(setting, number, earlier=False),
        other_statements(setting, number, along.asked),
        explain_entry(along, number),
        explain_moves(along, number),
        setting.notes,
        heat_prices(setting, number),
        planned.dwell_s,
        planned.waits_because,
        None if budget_kj is None else float(facts.zone_heat_kj[facts.zone[number] - 1]),
        budget_kj,
        uncut_hole_reasons(facts.whole_nest, profile.hole_limits()).get(contour, ""),
        narrow_because(facts.whole_nest, profile.material.kerf_mm).get(contour, ""),
        planned.linked_because,
        tabs_because(facts, profile).get(contour, "") or bevels_because(facts, profile).get(contour, ""),
        planned.pierced_because,
        "".join(common_because(facts, facts.candidates[setting.candidates[k]], contour)),
        facts.nest.contours[number].source.told(),
        reasons.of(number).lines(contour) or KeptOrders(setting).sentences(number),
        tuple((rule, why, mm) for rule, names, why, mm in price_split(setting).breaches if contour in names),
    )


# An explanation in a planner's words, or as JSON.

FEW = 3


@dataclass(frozen=True, slots=True)
class Explanation:
    """What there is to say of one contour; places count from 1.

    `previous` and `following` are its neighbours in the plan, "" for the machine's home. `earlier` and `later` hold
    it, nearest first; the chains lead on from there to the ends of the plan. `also` are statements of other kinds,
    `heat` prices on orders and entries that overheat metal. The torch waits for `dwell_s` before the contour is cut,
    and why. Where zones have a budget of heat, `zone_heat_kj` says how much goes into this one at the most. `small`
    says why a small hole is not cut but marked, `slit` what a slit opens and costs. `linked` says that the
    torch stays on before it, and why, `tabs` why tabs hold the part, `common` which neighbours have cut some of it,
    `drawn` what its drawing says of it. `why` says without
    which statements another place would cost less, or that there is none. `costs` are the soft and excused rules that
    are not kept here: rule, sentence, and mm.
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
    drawn: str = ""
    why: tuple[str, ...] = ()
    costs: tuple[tuple[str, str, float], ...] = ()

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
    yield from filter(None, (e.drawn, e.small, e.slit, e.tabs))
    if e.zone_heat_kj is not None:
        yield f"zone {e.zone} takes up {e.zone_heat_kj:.1f} kJ at the most, of a budget of {e.zone_budget_kj:g} kJ"
    if e.dwell_s:
        yield e.waits_because or f"waits {e.dwell_s:g} s first, so that metal may cool"
    yield from filter(None, (e.linked, e.pierced, e.common))
    yield "what decides its place"
    yield from (f"  - {line}" for line in e.why)
    if e.costs:
        yield "not kept here"
        yield from _listed([f"{rule}: {why} ({price(mm)})" for rule, why, mm in e.costs], everything)
    yield from _holds("not earlier", e.earlier, everything)
    yield from _holds("not later", e.later, everything)
    if e.also:
        yield "also"
        yield from _listed([f"{about.rule}: {about.sentence}" for about in e.also], everything)
    if e.heat:
        yield "heat"
        prices = [f"{'kept' if p.kept else f'broken, costs {p.price_mm:.0f} mm'}: {p.about.sentence}" for p in e.heat]
        yield from _listed(prices, everything)
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
    how = "on the link" if e.linked else entry_words(entry.used)
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
        where = f"enters there too, but is {entry_words(best)}"
    yield f"  - the next best {where}: {difference(best.more_um)}{others}"


def entry_words(way: OtherEntry) -> str:
    """How a cut begins, and where."""
    how = "begun in a neighbour's kerf" if way.in_kerf else "begun off the edge of the sheet"
    return f"{how if way.from_edge or way.in_kerf else 'pierced'} at {_at(way.pierce)}"


def _unlawful(entry: Entry, everything: bool) -> Iterator[str]:
    lines = []
    for about in dict.fromkeys(about for way in entry.unlawful for about in way.against):
        where = list(dict.fromkeys(f"{_at(w.entry)} {w.direction}" for w in entry.unlawful if about in w.against))
        shown = join_names(where, len(where) if everything else FEW)
        lines.append(f"unlawful: {shown}, {about.rule}: {about.sentence}")
    yield from _listed(lines, everything)


def _moved(contour: str, move: Relocation) -> str:
    run = [name for name in move.moved if name != contour]
    together = f" together with {', '.join(run[:FEW])}{' …' if len(run) > FEW else ''}" if run else ""
    head = f"{move.label} ({_nth(move.place)}){together}: "
    if not move.breaks:
        return head + difference(move.more_um)
    rules = join_names([f"{about.rule} ({about.sentence})" for about in move.breaks], 1)
    return head + f"breaks {rules}"


def difference(more_um: int | None) -> str:
    """A difference in cost; excuses from hard rules are told apart from millimetres."""
    um = more_um or 0
    excuses = round(um / EXEMPTION_UM)
    um -= excuses * EXEMPTION_UM
    mm = f"{abs(um) / UM_PER_MM:.1f} mm {'more' if um > 0 else 'less'}" if um else "as long"
    if not excuses:
        return mm
    if abs(excuses) == 1:
        return f"1 more excuse from hard rules, {mm}" if excuses > 0 else f"1 fewer excuse from hard rules, {mm}"
    return (
        f"{excuses} more excuses from hard rules, {mm}"
        if excuses > 0
        else f"{-excuses} fewer excuses from hard rules, {mm}"
    )


def price(mm: float) -> str:
    """What a breach costs; one that is excused counts before all travel."""
    return "excused" if mm >= EXEMPTION_MM else f"costs {mm:.1f} mm"


def _at(point: Point) -> str:
    return f"({point[0]:.1f}, {point[1]:.1f})"


def _nth(place: int) -> str:
    suffix = {1: "st", 2: "nd", 3: "rd"}.get(place % 10, "th") if place % 100 not in (11, 12, 13) else "th"
    return f"{place}{suffix}"


# What a contour's place and entry have to do with metal that overheats: the prices, and which the plan keeps.


@dataclass(frozen=True, slots=True)
class HeatPrice:
    """An order or an entry that overheats less metal: whether the plan keeps it, and what breaking it costs, mm.

    `others` are the further contours that it is about: none where it matters in any order how this one is entered.
    """

    others: tuple[str, ...]
    kept: bool
    price_mm: float
    about: About


def heat_prices(setting: PlanContext, contour: int) -> tuple[HeatPrice, ...]:
    """The prices of heat that are about a contour, the highest first.

    What is asked of one contour's cut while two others are out, or are not, is told of that one and not of the two.
    What is asked of an entry while another contour is out is told where the plan uses that entry.
    """
    found: dict[About, HeatPrice] = {}  # candidates that are no different share theirs
    for s in setting.stated.statements:
        if s.weight is None or s.about.rule != HEAT or setting.name(contour) not in s.about.contours:
            continue
        kept = _kept(setting, s, contour)
        if kept is not None:
            others = tuple(name for name in s.about.contours if name != setting.name(contour))
            found[s.about] = HeatPrice(others, kept, s.weight, s.about)
    return tuple(sorted(found.values(), key=lambda price: -price.price_mm))


def _kept(setting: PlanContext, statement: Statement, contour: int) -> bool | None:
    """Whether the plan keeps it; None where it asks nothing of how this contour is cut."""
    place = {contour: k for k, contour in enumerate(setting.order)}
    site_of = setting.problem.candidate_site
    kinds = by_kind([statement])  # no price of heat is of another kind
    for order in kinds.precede:
        return place[order.before] < place[order.after]
    for entry in kinds.forbid:
        return int(site_of[entry.candidate]) not in setting.route if site_of[entry.candidate] >= 0 else None
    for s in kinds.at_least:
        orders = [x for x in s.literals if isinstance(x, Before) and contour in (x.i, x.j)]
        unused = s.when is not None and int(site_of[s.when]) not in setting.route
        if unused or len(orders) < len(s.literals):
            return None
        true = (w for x, w in zip(orders, s.weights, strict=True) if place[x.i] < place[x.j])
        return sum(true) >= s.bound
    return None
