"""The plan: which contour when, where and which way round, and what is proven of it (kerfwise-plan/1)."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from kerfwise.encoder.already_cut import AlreadyCut
from kerfwise.encoder.bevels.tilted_path import TiltedPath
from kerfwise.encoder.cut import Cut, CutSequence, Pierce, Side
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Loss
from kerfwise.models.physics.time_and_cost import Cost, TimeReport
from kerfwise.rules.plan_state import Place, PlanState
from kerfwise.rules.profile.plant_sections import Origin
from kerfwise.rules.profile.values import ForOneNest
from kerfwise.rules.statements import EXEMPTION_MM, RELAXED_MM

from .zones_cost import ZonesCost

FORMAT = "kerfwise-plan/1"
RELAXED = "relaxed: "
"""How the reason of a statement begins that is relaxed because the hard rules cannot all hold."""
SIMULATION = "simulation"
"""What `Solve.found_by` says of a plan that was chosen by what a simulation shows."""
WAITS = "waits "
"""How the reason of a wait begins, among the reasons of a cut."""
IN_PASS = "begins at a hole of the pierce pass"
"""How the reason of a pierce in a pass begins, among the reasons of the cut that begins there."""
LINKED = "linked: "
"""How the reason of a link begins, among the reasons of the cut that it leads to."""
Status = Literal["optimal", "feasible"]


@dataclass(frozen=True, eq=False)
class PlannedCut:
    """A cut with what the plan says of it: its part, kind, torch-on length and the reasons for its place.

    The torch waits over the pierce, off, for `dwell_s` before the cut begins, so that metal may cool. `across` are the
    mouths of slots, notches and necks narrower than the kerf that it cuts straight across. A bevel is cut in
    `passes` of a torch that leans.
    """

    cut: Cut
    part: str
    kind: str
    length_mm: float
    because: tuple[str, ...] = ()
    dwell_s: float = 0.0
    across: tuple[Point, ...] = ()
    passes: tuple[TiltedPath, ...] = ()

    @property
    def linked_because(self) -> str:
        """Why the torch stays on before the cut; "" if it does not, or the plan does not say."""
        return next((text for text in self.because if text.startswith(LINKED)), "") if self.cut.linked else ""

    @property
    def pierced_because(self) -> str:
        """In which pierce pass its hole is made; "" in none."""
        return next((text for text in self.because if text.startswith(IN_PASS)), "")

    @property
    def waits_because(self) -> str:
        """Why the torch waits; "" if it does not, or the plan does not say."""
        return next((text for text in self.because if text.startswith(WAITS)), "") if self.dwell_s > 0 else ""


@dataclass(frozen=True, slots=True)
class Totals:
    """Sums over the whole program: mm, pierces, s, and heat (see `models/physics/heat`)."""

    cut_mm: float
    idle_mm: float
    pierces: int
    time_s: float
    heat: float


@dataclass(frozen=True, slots=True)
class SolveReport:
    """What is known of the plan's cost; `bound` and `gap` are None unless proven for the whole model.

    `objective` and `bound` are in mm of idle travel (soft rules weigh in at their weights); `gap` is
    (objective - bound) / objective. `proved_by` names the engine behind the bound, `found_by` the one behind the plan.
    `excuses` is how many hard statements the plan could not keep: each weighs 1000 m in the objective.
    """

    engine: str
    status: Status
    objective: float
    bound: float | None
    gap: float | None
    seconds: float
    seed: int
    found_by: str = ""
    proved_by: str = ""
    excuses: int = 0


@dataclass(frozen=True, slots=True)
class Prices:
    """What the objective is made of, mm: travel, breaches of soft and excused rules, and what a simulation shows.

    A breach is the rule, its contours, what is not kept there, and what that costs. A simulation shows overheats, or
    how far parts are off, where the profile has a price on these.
    """

    travel_mm: float
    breaches: tuple[tuple[str, tuple[str, ...], str, float], ...] = ()
    simulated_mm: float = 0.0

    @property
    def sum_mm(self) -> float:
        """All of it."""
        return self.travel_mm + self.simulated_mm + sum(mm for *_, mm in self.breaches)

    @property
    def by_rule(self) -> dict[str, tuple[int, float]]:
        """How many breaches each rule has, and what they cost, the dearest first."""
        found: dict[str, tuple[int, float]] = {}
        for rule, _, _, mm in self.breaches:
            count, before = found.get(rule, (0, 0.0))
            found[rule] = count + 1, before + mm
        return dict(sorted(found.items(), key=lambda of: -of[1][1]))

    def as_json(self) -> dict[str, Any]:
        """As a plan has it."""
        rows = [{"rule": r, "contours": list(c), "why": why, "mm": _round(mm)} for r, c, why, mm in self.breaches]
        simulated = {"simulated": _round(self.simulated_mm)} if self.simulated_mm else {}
        return {"travel": _round(self.travel_mm), **simulated, "breaches": rows}

    @staticmethod
    def of_json(data: Mapping[str, Any]) -> Prices:
        """As read from a plan."""
        rows = ((b["rule"], tuple(b["contours"]), b["why"], b["mm"]) for b in data["breaches"])
        return Prices(data["travel"], tuple(rows), data.get("simulated", 0.0))


@dataclass(frozen=True, slots=True)
class RuleReport:
    """One rule of the profile: whether it holds in the plan, and where it was excused and why.

    `breaches` are where a soft rule does not hold: the contours, and what is wrong there. A rule of the plant's own
    names the file that it stands in, with its sha256, and whether it takes the place of a shipped one.
    """

    id: str
    strength: str
    holds: bool
    exceptions: tuple[tuple[tuple[str, ...], str], ...] = ()
    breaches: tuple[tuple[tuple[str, ...], str], ...] = ()
    file: str = ""
    file_sha256: str = ""
    in_place_of_shipped: bool = False


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A hole of the nest that the plan does not cut because the profile leaves it out, and why."""

    contour: str
    why: str


@dataclass(frozen=True, slots=True)
class Dropped:
    """A statement left out because hard rules contradict each other: an order on a cycle, or one that was relaxed."""

    rule: str
    contours: tuple[str, ...]
    why: str

    @property
    def relaxed(self) -> bool:
        """Whether it was relaxed, as a planner asked, and not dropped by the rules themselves."""
        return self.why.startswith(RELAXED)


@dataclass(frozen=True, eq=False)
class Plan:
    """The whole answer; `nest` and `profile` name files and their sha256.

    `made_with` names the job file likewise, and what was set and locked beside it; None for a plan without.

    Coordinates are the drawing's; `zero` is the point of it that is the machine's zero, as its `origin` says. `time`
    says by which model the times are, and what they are spent on; None where no program has been timed. `cost` is what
    one sheet costs, None where the profile has no prices. `left_out` are small holes that are not cut, `losses` what
    parts that touch lose to the cut between them. `zones_cost` is
    what cutting zone after zone costs, where that was looked for. Where a
    program goes on after a stop, `already_cut` are the cuts made before, with times of the program that made them, and
    `cuts` go on from there; `broken_off` is the one that is cut again, as it was begun. `pierces` are the holes that
    are pierced in passes of their own, in order; the cuts of their contours begin there. `begun` are cuts along
    stretches of ways that leave their contours unfinished, each with the number of the cut that comes after it. `state`
    says whether every hard rule holds, as the check found when the plan was made; None in plans of before.
    """

    nest: Mapping[str, str]
    profile: Mapping[str, str]
    start_side: Side
    start_side_because: str
    cuts: tuple[PlannedCut, ...]
    totals: Totals
    solve: SolveReport
    rules: tuple[RuleReport, ...] = ()
    dropped: tuple[Dropped, ...] = field(default=())
    time: TimeReport | None = None
    cost: Cost | None = None
    made_with: ForOneNest | None = None
    left_out: tuple[LeftOut, ...] = ()
    losses: tuple[Loss, ...] = ()
    zones_cost: ZonesCost | None = None
    origin: Origin = "drawing"
    zero: Point = (0.0, 0.0)
    already_cut: tuple[PlannedCut, ...] = ()
    broken_off: PlannedCut | None = None
    pierces: tuple[Pierce, ...] = ()
    state: PlanState | None = None
    prices: Prices | None = None
    begun: tuple[tuple[int, PlannedCut], ...] = ()

    @property
    def burns(self) -> tuple[PlannedCut, ...]:
        """All that is still to be burnt, in the torch's order: the cuts, and stretches of ways before them."""
        return tuple(planned for _, planned in self._numbered(self.cuts, self.resumed_after + 1))

    @property
    def items(self) -> tuple[PlannedCut, ...]:
        """The same with each way as one: a cut named by the way, of kind `stretch`, as its first stretch begins."""
        found: list[PlannedCut] = []
        for planned in self.burns:
            way = planned.cut.way
            if way and found and found[-1].cut.contour == way:
                last = found[-1]
                cut = replace(last.cut, lead_out=planned.cut.lead_out, end_s=planned.cut.end_s)
                found[-1] = replace(last, cut=cut, length_mm=last.length_mm + planned.length_mm)
            elif way:
                found.append(
                    replace(planned, cut=replace(planned.cut, contour=way, span=None), part="", kind="stretch")
                )
            else:
                found.append(planned)
        return tuple(found)

    def with_items(self, items: Sequence[PlannedCut]) -> Plan:
        """The plan with the reasons of these items, which are its own: those of a way stand at its first stretch."""
        reasons = {item.cut.contour: item.because for item in items if item.kind == "stretch"}
        begun = tuple((k, replace(p, because=reasons.pop(p.cut.way, p.because))) for k, p in self.begun)
        return replace(self, cuts=tuple(item for item in items if item.kind != "stretch"), begun=begun)

    def _numbered(self, cuts: Sequence[PlannedCut], first: int) -> Iterator[tuple[int, PlannedCut]]:
        """Cuts with their numbers, and before each the stretches that come before it, with its number."""
        for k, planned in enumerate(cuts, first):
            yield from ((k, stretch) for at, stretch in self.begun if at == k)
            yield k, planned

    @property
    def resumed_after(self) -> int:
        """How many cuts were made before: the first of `cuts` has the number after it."""
        return len(self.already_cut)

    @property
    def already(self) -> AlreadyCut:
        """What was made before, as geometry."""
        broken_off = None if self.broken_off is None else self.broken_off.cut
        begun = tuple((k, planned.cut) for k, planned in self.begun if k <= self.resumed_after)
        return AlreadyCut(tuple(p.cut for p in self.already_cut), broken_off, begun)

    @property
    def waits(self) -> tuple[PlannedCut, ...]:
        """The cuts before which the torch waits for metal to cool, in order."""
        return tuple(planned for planned in self.cuts if planned.dwell_s > 0)

    @property
    def wait_s(self) -> float:
        """How long it waits altogether, s."""
        return sum(planned.dwell_s for planned in self.cuts)

    @property
    def heavy_mm(self) -> float:
        """What excuses and relaxed statements weigh in the objective, mm: each more than any plan travels."""
        excused_mm = self.solve.excuses * EXEMPTION_MM
        if not any(dropped.relaxed for dropped in self.dropped):
            return excused_mm
        return excused_mm + (self.solve.objective - excused_mm) // RELAXED_MM * RELAXED_MM

    @property
    def light_gap(self) -> float | None:
        """The gap without the weight of excuses and relaxed statements.

        None where they weigh nothing, where plans with fewer of them are not ruled out, or where there is no gap.
        """
        if not self.solve.gap:
            return None
        bound_mm, rest_mm = (self.solve.bound or 0.0) - self.heavy_mm, self.solve.objective - self.heavy_mm
        return (rest_mm - bound_mm) / rest_mm if self.heavy_mm and bound_mm > 0 and rest_mm > 0 else None

    @property
    def told_gap(self) -> float | None:
        """The gap that says something: of what a plan costs beside its excuses and relaxed statements."""
        return self.light_gap if self.heavy_mm else self.solve.gap

    @property
    def none_needless(self) -> bool:
        """Whether it is proven that no plan has fewer excuses and relaxed statements."""
        return self.solve.status == "optimal" or (self.solve.bound or 0.0) >= self.heavy_mm

    @property
    def stated(self) -> PlanState:
        """The state that the plan says; of plans of before, which say none, what follows from their rules."""
        if self.state is not None:
            return self.state
        hard = [rule for rule in self.rules if rule.strength == "hard"]
        excused = [Place("excused", rule.id, contours, why) for rule in hard for contours, why in rule.exceptions]
        return PlanState.of([*(Place("broken", rule.id, (), "") for rule in hard if not rule.holds), *excused])

    def sequence(self, home: tuple[float, float] = (0.0, 0.0)) -> CutSequence:
        """The bare cuts, those made before among them, as rules judge them."""
        cuts = tuple(p.cut for p in (*self.already_cut, *self.cuts))
        begun = tuple((k, planned.cut) for k, planned in self.begun)
        return CutSequence(cuts, self.start_side, home, made=self.resumed_after, begun=begun, pierces=self.pierces)

    def to_json(self) -> str:
        """The plan as kerfwise-plan/1 text: stable key order, one cut a line, a newline at the end."""
        head: dict[str, Any] = {
            "format": FORMAT,
            "nest": dict(self.nest),
            "profile": dict(self.profile),
            **({} if self.made_with is None else {"job": self.made_with.as_json()}),
            "start_side": self.start_side,
            "start_side_because": self.start_side_because,
            **({} if self.origin == "drawing" else {"origin": self.origin, "zero": [round(v, 6) for v in self.zero]}),
        }
        if self.already:
            head["resumed_after"] = self.resumed_after
        tail: dict[str, Any] = {
            "totals": {k: _round(getattr(self.totals, k)) for k in Totals.__slots__}
            | ({} if self.cost is None else {"cost": self.cost.as_json()}),
            **({} if self.time is None else {"time": self.time.as_json()}),
            "solve": {k: _round(getattr(self.solve, k)) for k in SolveReport.__slots__}
            | ({} if self.light_gap is None else {"gap_without_excuses": _round(self.light_gap)}),
            "rules": [
                {
                    "id": r.id,
                    "strength": r.strength,
                    "holds": r.holds,
                    "exceptions": [{"contours": list(c), "why": w} for c, w in r.exceptions],
                }
                | ({"breaches": [{"contours": list(c), "why": w} for c, w in r.breaches]} if r.breaches else {})
                | ({"file": r.file, "file_sha256": r.file_sha256} if r.file else {})
                | ({"in_place_of_shipped": True} if r.in_place_of_shipped else {})
                for r in self.rules
            ],
            "dropped": [{"rule": d.rule, "contours": list(d.contours), "why": d.why} for d in self.dropped],
        }
        if self.prices is not None:
            tail["prices"] = self.prices.as_json()
        if self.state is not None:
            tail["state"] = self.state.as_json()
        if self.zones_cost is not None:
            tail["zones_cost"] = self.zones_cost.as_json()
        if self.left_out:
            tail["left_out"] = [{"contour": left.contour, "why": left.why} for left in self.left_out]
        if self.losses:
            tail["losses"] = [
                {"contour": loss.contour, "touches": list(loss.others), "loss_mm": _round(loss.loss_mm)}
                for loss in self.losses
            ]
        lines = [f' "{k}": {json.dumps(v, ensure_ascii=False)}' for k, v in head.items()]
        if "resumed_after" in head:
            lines.append(f' "already_cut": {_rows(self._numbered(self.already_cut, 1))}')
        if self.broken_off is not None:
            row = _cut_row(self.resumed_after + 1, self.broken_off)
            lines.append(f' "broken_off": {json.dumps(row, ensure_ascii=False)}')
        lines.append(f' "cuts": {_rows(self._numbered(self.cuts, self.resumed_after + 1))}')
        if self.pierces:
            rows = ",\n  ".join(json.dumps(_pierce_row(pierce), ensure_ascii=False) for pierce in self.pierces)
            lines.append(f' "pierces": [\n  {rows}\n ]')
        lines += [f' "{k}": {json.dumps(v, ensure_ascii=False)}' for k, v in tail.items()]
        return "{\n" + ",\n".join(lines) + "\n}\n"


def _rows(cuts: Iterable[tuple[int, PlannedCut]]) -> str:
    """Numbered cuts as a list, one a line."""
    rows = ",\n  ".join(json.dumps(_cut_row(k, c), ensure_ascii=False) for k, c in cuts)
    return f"[\n  {rows}\n ]"


def _round(value: object, digits: int = 6) -> object:
    return round(value, digits) if isinstance(value, float) else value


def _path(curve: Curve | None) -> list[list[float]]:
    return [] if curve is None else [[round(v, 6) for v in row] for row in curve.as_rows()]


def _pierce_row(pierce: Pierce) -> dict[str, Any]:
    times = {"start_s": round(pierce.start_s, 3), "end_s": round(pierce.end_s, 3)}
    return {"contour": pierce.contour, "at": [round(v, 6) for v in pierce.at], "before": pierce.before, **times}


def _cut_row(order: int, planned: PlannedCut) -> dict[str, Any]:
    cut = planned.cut
    row: dict[str, Any] = {
        "order": order,
        "contour": cut.contour,
        "part": planned.part,
        "kind": planned.kind,
        "zone": cut.zone,
        "entry": [round(v, 6) for v in cut.entry],
        "pierce": [round(v, 6) for v in cut.pierce],
        "lead_in": _path(cut.lead_in),
        "lead_out": _path(cut.lead_out),
        "direction": cut.direction,
        "length_mm": round(planned.length_mm, 3),
        "start_s": round(cut.start_s, 3),
        "end_s": round(cut.end_s, 3),
        "because": list(planned.because),
    }
    if cut.torch > 1:
        row["torch"], row["together"] = cut.torch, cut.together
    if cut.linked:
        row["linked"] = True
    if cut.span is not None:
        ends = {"from": [round(v, 6) for v in cut.span.begin], "to": [round(v, 6) for v in cut.span.end]}
        row |= {"stretch": ends | {"way": cut.way}} if cut.way else {"span": ends}
    if cut.tabs:
        row["tabs"] = [{"at": [round(v, 6) for v in tab.at], "width": round(tab.width_mm, 6)} for tab in cut.tabs]
    if planned.across:
        row["across"] = [[round(v, 6) for v in at] for at in planned.across]
    if planned.passes:
        row["passes"] = [one.as_json() for one in planned.passes]
    if planned.dwell_s:
        row["dwell_s"] = round(planned.dwell_s, 3)
    return row | ({"excused": list(cut.excused)} if cut.excused else {})
