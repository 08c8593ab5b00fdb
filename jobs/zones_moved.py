"""Zones that cost a plan less than those of geometry: runs of a plan that was found without them.

The best plan known without zones is looked for first. Where its runs do not do what zones are for, a plan is looked
for that keeps to the zones there are but for their borders: contours of zones that follow each other may be mixed.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.facts.zone_runs import movable, zones_along
from kerfwise.models.engines.solution import Progress, Solution, SolveOptions
from kerfwise.models.kernels import running_s
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import About, Precede, Statement
from kerfwise.rules.stating.lazy import afterthoughts
from kerfwise.rules.stating.state_rules import state_rules

from .ask import Asked
from .zones_cost import Free, look_for, once_more, without_zones, zoned_by

TRIES = 2
"""Ways to make zones along a plan that are tried."""


def better_zones(
    asked: Asked,
    further: Sequence[Statement],
    profile: Profile,
    solution: Solution,
    limits: SolveOptions,
    ends_s: float | None = None,
    progress: Progress | None = None,
    *,
    may_move: bool = True,
) -> tuple[Asked, Solution, Free | None]:
    """The plan by the best zones that are found, and the best plan known without zones (None where none is asked for).

    Parameters
    ----------
    asked, solution
        What was asked of a plan by zones, and the plan.
    further
        What geometry has found missing of it.
    limits
        Of the whole job: each step takes a share of it.
    ends_s
        When a limit in seconds ends, by `running_s`.
    may_move
        Whether the plan may be another; else zones stay as they are.
    """
    began_s, looked = running_s(), look_for(asked.facts, limits, ends_s)
    free = without_zones(asked, further, profile, solution, looked, progress)
    if free is None or not may_move or not movable(asked.facts):
        return asked, solution, free
    beside_s = running_s() - began_s - (looked.time_s or 0.0)  # other zones take as long to be stated, at least

    def in_time() -> bool:
        return ends_s is None or running_s() + beside_s < ends_s

    def left() -> SolveOptions | None:
        return once_more(limits, ends_s) if in_time() else None

    def along_it(found: Free) -> tuple[Asked, Solution] | None:
        return along(asked, profile, solution, found, left, progress)

    if free.cost_mm(asked, solution, limits) <= free.solution.objective:
        return asked, solution, free
    better = along_it(free)
    if better is None and in_time():
        borders = tuple(of_neighbours(asked.facts, zoned_by(asked, profile)))
        looked = look_for(asked.facts, limits, ends_s)
        mixed = without_zones(asked, further, profile, solution, looked, progress, borders)
        better = None if mixed is None else along_it(mixed)
    return (asked, solution, free) if better is None else (*better, free)


def along(
    asked: Asked,
    profile: Profile,
    solution: Solution,
    free: Free,
    limits: Callable[[], SolveOptions | None],
    progress: Progress | None = None,
) -> tuple[Asked, Solution] | None:
    """A better plan, by zones along another one; None where its runs are no zones, or none better is proven.

    They are as large as a proof bears, so a proof alone is tried, within `limits` as they are when it begins (None: no
    more); where it fails, by smaller ones. A plan that is proven gives way to none that is not.
    """
    facts = asked.facts
    tried, unproven = 0, 0
    for zone in zones_along(facts, [facts.candidates[c].contour for c in free.solution.route]):
        if int(zone.max()) <= unproven:  # as large as zones of which a proof took too long
            continue
        if tried == TRIES or (left := limits()) is None:
            break
        tried += 1
        found = _by_zones(replace(facts, zone=zone), profile, free.solution, left, progress)
        if found is None or found[1].left_out != solution.left_out:  # the one is not asked for what the other pays for
            continue
        by, moved = found
        if moved.status != "optimal":
            unproven = int(zone.max())
        if moved.objective < solution.objective and (moved.status == "optimal" or solution.status != "optimal"):
            spent = solution.seconds + free.seconds + moved.seconds
            notes = (*solution.notes, "zones: moved along the best plan known without them", *moved.notes)
            return by, replace(moved, seconds=spent, notes=notes)
    return None


def _by_zones(
    facts: Facts, profile: Profile, start: Solution, limits: SolveOptions, progress: Progress | None
) -> tuple[Asked, Solution] | None:
    """What is proven of a plan by the zones of `facts`, from one on that keeps to them; None where it does not."""
    from kerfwise.models.engines.rounds import solve

    limits = replace(limits, member="ideals", gap=None, no_improvement_s=None)
    try:
        stated = state_rules(facts, profile)
        looks = afterthoughts(facts, profile)
        return Asked(facts, stated), solve(facts, stated.statements, limits, progress, looks, start=start.route)
    except RulesConflict:
        return None


def of_neighbours(facts: Facts, rules: frozenset[str]) -> Iterator[Precede]:
    """What is left of the orders of zones where zones that follow each other may be mixed, and no others.

    Only what does not follow from the rest is stated: of the zones after the next, the first two.
    """
    members: dict[int, list[int]] = defaultdict(list)
    for k, zone in enumerate(facts.zone.tolist()):
        if facts.nest.contours[k].kind != "mark":
            members[zone].append(k)
    rule = min(rules)
    for zone, here in sorted(members.items()):
        apart = [other for other in sorted(members) if other >= zone + 2]
        for other in (later for later in apart if later <= apart[0] + 1):
            for before in here:
                for after in members[other]:
                    names = facts.nest.contours[before].id, facts.nest.contours[after].id
                    sentence = f"{names[0]} is cut before {names[1]}: zone {zone} comes before zone {other}"
                    yield Precede(before, after, About(rule, names, sentence))


def planned_by_zones(asked: Asked, profile: Profile, limits: SolveOptions) -> tuple[Asked, Solution, Free | None]:
    """A plan by zones, moved where that pays, without its program: for benchmarks."""
    from kerfwise.models.engines.rounds import solve

    looks = afterthoughts(asked.facts, profile)
    solution = solve(asked.facts, asked.stated.statements, limits, None, looks)
    order = [asked.facts.candidates[c].contour for c in solution.route]
    return better_zones(asked, afterthoughts(asked.facts, profile)(order), profile, solution, limits)
