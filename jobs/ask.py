"""What is asked of a plan: the facts of a nest, and what a profile's rules state of them."""

from __future__ import annotations

from dataclasses import dataclass, replace

from kerfwise.encoder.already_cut import NOTHING_CUT, AlreadyCut
from kerfwise.encoder.candidates import build_with_older_kerfs
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.candidates.older_kerfs import OlderKerfs
from kerfwise.encoder.copies import Group, alike, drawn_alike, entries_of_copies
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.errors import MOST_DETAILS, InputError, RulesConflict
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.facts.links import with_links
from kerfwise.encoder.facts.remaining import loose_in, remaining
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.still_going import long_job, so_much
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.kernels import running_s
from kerfwise.postproc.clock.contour_heat import contour_heat_kj
from kerfwise.rules.lock import check_locks
from kerfwise.rules.profile.common_use import expect_common_cuts
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.state_rules import (
    HOPELESS,
    DroppedStatement,
    Stated,
    hopeless_anyway,
    loose_orders,
    state_rules,
)

from .one_torch import expect_torches
from .torches import at_best_spacing, facts_of_torches, first_groups, of_parts
from .whole_limit import Took

RELAX = 0.5
"""Share of a limit in seconds in which what gives way is to be found; a plan is to be made in the rest."""


@dataclass(frozen=True, eq=False, slots=True)
class Asked:
    """What is asked of a plan: the facts of the nest, and what the profile's rules state of them.

    `seconds` is how long it took to state them, by the clock.
    """

    facts: Facts
    stated: Stated
    seconds: float = 0.0


def _measuring(nest: Nest, profile: Profile, already: AlreadyCut = NOTHING_CUT, took: Took | None = None) -> str:
    return f"measuring {nest.file or 'the nest'}"


@long_job(_measuring)
def facts_of(nest: Nest, profile: Profile, already: AlreadyCut = NOTHING_CUT, took: Took | None = None) -> Facts:
    """All facts of the nest, as the profile has it cut, under the profile's thresholds.

    Where some of it is `already` cut they are those of what is left. `took` is told how long finding candidates takes.

    Raises
    ------
    InputError
        If a lock names what the nest does not have, a contour cannot be cut as the profile asks, or a rule in a model
        file is on and there is no MiniZinc, or more contours than it bears.
    RulesConflict
        If contours cannot be cut and hard rules cannot hold in any order: the second is mostly the reason of the first.
    """
    if rules := profile.model_rules():
        from kerfwise.rules.flat.compiler import minizinc_program

        minizinc_program()
        for rule in rules:
            rule.expect_small(nest)
    so_much(len(nest.contours), "contour", "contours")
    nest = profile.as_cut(nest)
    check_locks(profile.locks, nest)
    expect_common_cuts(profile)
    expect_torches(profile, nest, bool(already))
    if unknown := sorted(already.contours - nest.index.keys()):
        had = f"the plan says of contours that {nest.file or 'the nest'} does not have that they are cut already"
        raise InputError(f"{had}: it was made from another nest", details=tuple(unknown))
    loose = loose_in(nest, already.contours)
    profile = at_best_spacing(nest, profile)
    groups, step = first_groups(nest, profile), profile.machine.torches.step
    try:
        drawn = drawn_alike(nest, groups, step) if groups else nest
        leads = profile.lead_options(nest)
        leads = replace(leads, entry_points=entries_of_copies(drawn, leads.entry_points, groups, step))
        began_s = running_s()
        candidates, met = build_with_older_kerfs(drawn, leads, already, loose)
        if took is not None:
            took.candidates_s = running_s() - began_s
    except InputError as error:
        unheated = replace(profile.fact_options(nest), zone_heat_kj=None)  # without candidates no heat is known
        if alone := hopeless_anyway(_left(compute_facts(nest, unheated, ()), already), profile):
            besides = (
                f"besides, {error.message}, and --relax (in Python: relax=True) does not help there:",
                *error.details[:MOST_DETAILS],
            )
            raise RulesConflict(HOPELESS, (*(f"{about.rule}: {about.sentence}" for about in alone), *besides)) from None
        raise
    if groups:
        candidates, met, groups = _cut_alike(candidates, met, groups, step)
    heat_kj = contour_heat_kj(nest, candidates, profile)
    facts = compute_facts(nest, profile.fact_options(nest), candidates, heat_kj, met)
    if profile.machine.torches.several and nest.contours:
        return facts_of_torches(facts, groups, profile)
    links = None if profile.no_links(nest) else profile.link_options()
    return _left(with_links(facts, links, _burnt(already)), already)


def _cut_alike(
    candidates: tuple[Candidate, ...], met: OlderKerfs | None, groups: list[Group], step: Point
) -> tuple[tuple[Candidate, ...], OlderKerfs | None, list[Group]]:
    """Candidates of groups that all torches can make alike; a group that has none is none."""
    kept, bare = alike(candidates, groups, step)
    while bare:
        groups = of_parts(groups, bare)
        kept, bare = alike(candidates, groups, step)
    return tuple(candidates[k] for k in kept), None if met is None else met.of_kept(kept, len(candidates)), groups


def _burnt(already: AlreadyCut) -> tuple[Cut, ...]:
    return already.cuts if already.broken_off is None else (*already.cuts, already.broken_off)


def _left(facts: Facts, already: AlreadyCut) -> Facts:
    return remaining(facts, already) if already else facts


def ask(
    facts: Facts,
    profile: Profile,
    relax: bool = False,
    limits: SolveOptions | None = None,
) -> Asked:
    """What the rules state of the facts; `relax` lets the cheapest statements give way where they clash.

    The look for them ends within `limits`.

    Raises
    ------
    RulesConflict
        If hard orders contradict each other (and nothing that may give way helps), or, unless `relax` leaves them out,
        if contours are left in metal that has fallen out.
    """
    loose, began_s = loose_orders(facts), running_s()
    if relax:
        from kerfwise.models.engines.budget import Budget
        from kerfwise.models.plan.conflict import state_relaxed
        from kerfwise.models.plan.plan import RELAXED

        budget = None if limits is None else Budget.of(replace(limits, time_s=limits.time_s and RELAX * limits.time_s))
        stated = state_relaxed(facts, profile, budget=budget)
        left_out = (DroppedStatement(order, f"{RELAXED}{order.about.sentence}") for order in loose)
        return Asked(facts, replace(stated, dropped=(*stated.dropped, *left_out)), running_s() - began_s)
    if loose:
        raise RulesConflict(
            "some contours cannot be cut any more (--relax, in Python relax=True, leaves them out)",
            tuple(o.about.sentence for o in loose),
        )
    stated = state_rules(facts, profile)
    return Asked(facts, stated, running_s() - began_s)
