"""What single rules need beside the facts: their options, and what they look at alone, as MiniZinc data."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.tolerance import tolerance_mm
from kerfwise.models.problem.microns import UM_PER_MM
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.catalogue.cut_direction import CutDirectionOptions
from kerfwise.rules.catalogue.heat_lag import HeatLagOptions
from kerfwise.rules.catalogue.locks import LocksOptions
from kerfwise.rules.catalogue.marks_first import MarksFirstOptions
from kerfwise.rules.catalogue.no_islands import NoIslandsOptions
from kerfwise.rules.catalogue.part_contiguous import PartContiguousOptions
from kerfwise.rules.catalogue.part_rigidity import PartRigidityOptions
from kerfwise.rules.catalogue.pierce import PierceOptions
from kerfwise.rules.catalogue.shared_metal import SharedMetalOptions
from kerfwise.rules.options.option import NoOptions
from kerfwise.rules.profile.sections import RuleSetting
from kerfwise.rules.stating.state_rules import Stated

from .dzn import Fields, assignments, flag, flags, number_set, numbers
from .rule_facts import (
    clusters,
    head_freed,
    met_kerfs,
    near_pairs,
    on_the_frame,
    pierced_waste,
    same_waste,
    tail_needed,
    tip_moves,
)


@dataclass(frozen=True, slots=True)
class Case:
    """One nest under one profile."""

    facts: Facts
    stated: Stated
    home_mm: Point


def rule_data(case: Case, settings: Mapping[str, RuleSetting]) -> str:
    """Data of the rules that read any."""
    return "".join(assignments(DATA[rule](case, s.options)) for rule, s in settings.items() if rule in DATA)


def _part_contiguous(case: Case, options: PartContiguousOptions) -> Fields:
    return [("part_contiguous_marks", flag(options.marks == "together"))]


def _marks_first(case: Case, options: MarksFirstOptions) -> Fields:
    return [("marks_first_sheet", flag(options.scope == "sheet"))]


def _cut_direction(case: Case, options: CutDirectionOptions) -> Fields:
    allowed = [options.allowed(kind) for kind in ("outer", "hole", "mark")]
    return [
        ("cut_direction_cw", flags("cw" in ways for ways in allowed)),
        ("cut_direction_ccw", flags("ccw" in ways for ways in allowed)),
    ]


def _pierce(case: Case, options: PierceOptions) -> Fields:
    waste = pierced_waste(case.facts)
    kerfs, leads = met_kerfs(case.facts, options.kerf_mm, options.splash_mm)
    return [
        ("n_pierce_waste", str(len(waste))),
        ("pierce_waste_cand", numbers(c + 1 for c, _ in waste)),
        ("pierce_waste_hole", numbers(hole + 1 for _, hole in waste)),
        ("n_pierce_kerfs", str(len(kerfs))),
        ("pierce_kerf_cand", numbers(c + 1 for c, _ in kerfs)),
        ("pierce_kerf_contour", numbers(k + 1 for _, k in kerfs)),
        ("n_pierce_leads", str(len(leads))),
        ("pierce_lead_later", numbers(c + 1 for c, _ in leads)),
        ("pierce_lead_earlier", numbers(d + 1 for _, d in leads)),
    ]


def _locks(case: Case, options: LocksOptions) -> Fields:
    number = {name: k + 1 for name, k in case.facts.nest.index.items()}
    made = len(case.facts.already_cut)
    ends = {"first": 1, "last": case.facts.n}
    locks = [lock for lock in options.locks if lock.contour in number]
    orders = [(number[lock.contour], number[lock.before]) for lock in locks if lock.contour and lock.before in number]
    places = [
        (number[lock.contour], ends[place] if isinstance(place, str) else place - made)
        for lock in locks
        if lock.contour and (place := lock.place_among(case.facts.n + made))
    ]
    out = {s.candidate + 1 for s in by_kind(case.stated.statements).forbid if s.about.rule == "locks"}
    return [
        ("n_lock_orders", str(len(orders))),
        ("lock_first", numbers(i for i, _ in orders)),
        ("lock_second", numbers(j for _, j in orders)),
        ("n_lock_places", str(len(places))),
        ("lock_contour", numbers(i for i, _ in places)),
        ("lock_position", numbers(k for _, k in places)),
        ("lock_excludes", number_set(out)),
    ]


def _no_islands(case: Case, options: NoIslandsOptions) -> Fields:
    return [
        ("no_islands_framed", flags(on_the_frame(case.facts, options.frame_share).tolist())),
        ("no_islands_cluster", numbers((clusters(case.facts) + 1).tolist())),
    ]


def _part_rigidity(case: Case, options: PartRigidityOptions) -> Fields:
    return [
        ("part_rigidity_needed", numbers(tail_needed(case.facts, options.rigid_min).tolist())),
        ("part_rigidity_freed", numbers(head_freed(case.facts, options.head_rigid_max).tolist())),
    ]


def _heat_lag(case: Case, options: HeatLagOptions) -> Fields:
    near = near_pairs(case.facts, options.heat_radius_mm)
    lag: Fields = [("heat_lag_ms", str(round(options.lag_s * 1000)))] if options.lag_s > 0 else []
    return [
        ("heat_lag_cuts", str(options.lag_cuts)),
        ("n_heat_near", str(len(near))),
        ("heat_near_one", numbers(i + 1 for i, _ in near)),
        ("heat_near_other", numbers(j + 1 for _, j in near)),
        *lag,
    ]


def _shared_metal(case: Case, options: SharedMetalOptions) -> Fields:
    near = same_waste(case.facts, options.kerf_mm)
    return [
        ("n_shared_near", str(len(near))),
        ("shared_one", numbers(i + 1 for i, _, _ in near)),
        ("shared_other", numbers(j + 1 for _, j, _ in near)),
        ("shared_gap_um", numbers(gap_um for _, _, gap_um in near)),
        ("shared_least_um", str(round((options.kerf_mm - tolerance_mm(options.kerf_mm)) * UM_PER_MM))),
    ]


def _no_tip_travel(case: Case, options: NoOptions) -> Fields:
    over = tip_moves(case.facts, case.home_mm)
    last = len(case.facts.candidates)
    moves = flags(leads for _, table in over for leads in table.ravel().tolist())
    return [
        ("n_tip_parts", str(len(over))),
        ("tip_outer", numbers(0 if outer is None else outer + 1 for outer, _ in over)),
        ("tip_over", f"array3d(1..{len(over)}, 0..{last}, 0..{last}, {moves})"),
    ]


DATA: Mapping[str, Callable[[Case, Any], Fields]] = {
    "cut-direction": _cut_direction,
    "heat-lag": _heat_lag,
    "locks": _locks,
    "marks-first": _marks_first,
    "no-islands": _no_islands,
    "no-tip-travel": _no_tip_travel,
    "part-contiguous": _part_contiguous,
    "part-rigidity": _part_rigidity,
    "pierce": _pierce,
    "shared-metal": _shared_metal,
}
"""Rule id → what its file under `rules/` reads beside the facts."""
