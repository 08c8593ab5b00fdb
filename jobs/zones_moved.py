"""Zones that cost a plan less than those of geometry: runs of a plan that was found without them.

The best plan known without zones is looked for first. Where its runs do not do what zones are for, a plan is looked
for that keeps to the zones there are but for their borders: contours of zones that follow each other may be mixed.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.facts.zone_runs import movable, zones_along
from kerfwise.models.engines.solution import Progress, Solution, SolveOptions
from kerfwise.models.kernels import running_s
from kerfwise.models.plan.zones_cost import ZonesCost
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import About, Precede, Statement
from kerfwise.rules.stating.lazy import afterthoughts
from kerfwise.rules.stating.state_rules import Stated, state_rules

from .ask import Asked
from .zones_cost import Free, without_zones, zoned_by, zones_cost
from .zones_limits import FEW, STATED, beside, look_again, look_for, once_more

TRIES = 2
"""Ways to make zones along a plan that are tried."""
A_TRY = 0.6
"""Share of what is left that one of them may take, but for the last."""
LEAST_S = 0.05
"""Seconds of a limit that are left for it, however long its rules have taken to be stated."""


@dataclass(slots=True)
class Account:
    """What has been `spent` on plans by zones, of no avail or not; `limits` says what that leaves (None: no more)."""

    spent: float
    limits: Callable[[float], SolveOptions | None]

    def left(self) -> SolveOptions | None:
        """How long the next plan may take."""
        return self.limits(self.spent)


@dataclass(frozen=True, eq=False, slots=True)
class ByZones:
    """A plan by zones: what was asked of it, its solution, and the best plan known without zones, if one was asked for.

    `proven_elsewhere` is the objective of a plan that is proven within other zones and dearer, mm, where this one is
    not proven.
    """

    asked: Asked
    solution: Solution
    free: Free | None
    proven_elsewhere: float | None = None

    def cost(self, limits: SolveOptions) -> ZonesCost | None:
        """What its zones cost; None where no plan without zones is known."""
        if self.free is None:
            return None
        cost = zones_cost(self.asked, self.solution, self.free, limits)
        return replace(cost, proven_elsewhere_mm=self.proven_elsewhere)


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
) -> ByZones:
    """The best plan by any zones that are tried, proven or not, and the best plan known without zones.

    Of plans that cost the same, one that is proven is better. So more time makes no worse plan only because it is
    enough for a proof within worse zones.

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
    contours = asked.facts.n
    began_s, looked = running_s(), look_for(contours, limits, ends_s, solution, asked.seconds)
    if looked is None:
        return ByZones(asked, solution, None)
    free = without_zones(asked, further, profile, solution, looked, progress)
    if free is None or not may_move or not movable(asked.facts):
        return ByZones(asked, solution, free)
    if free.cost_mm(asked, solution, limits) <= free.solution.objective:
        return ByZones(asked, solution, free)
    beside_s = running_s() - began_s - (looked.time_s or 0.0)  # other zones take as long to be stated, at least
    if contours > FEW:
        beside_s = STATED * asked.seconds

    def left(spent: float) -> SolveOptions | None:
        in_time = ends_s is None or running_s() + beside_s < ends_s
        stopped = progress is not None and not progress("zones", None, None)
        return once_more(contours, limits, ends_s, spent) if in_time and not stopped else None

    kept = beside(contours, free.seconds, limits)
    account, mixed_s = Account(solution.seconds + kept, left), 0.0
    found = list(along(asked, profile, solution, free, account, progress))
    looked = look_again(contours, limits, ends_s)
    none_better = not any(_rank(other) < _rank(solution) for _, other in found)
    if none_better and looked is not None and account.left() is not None:
        borders = tuple(of_neighbours(asked.facts, zoned_by(asked, profile)))
        mixed = without_zones(asked, further, profile, solution, looked, progress, borders)
        mixed_s = 0.0 if mixed is None else mixed.seconds
        if mixed is not None and mixed.solution.route != free.solution.route:
            found += along(asked, profile, solution, mixed, account, progress)
    every = [(asked, solution), *found]
    by, best = min(every, key=lambda plan: _rank(plan[1]))
    elsewhere = _proven(best, [other for _, other in every])
    if best is solution:
        return ByZones(asked, solution, free, elsewhere)
    notes = (*solution.notes, "zones: moved along the best plan known without them", *best.notes)
    spent = account.spent - kept + free.seconds + mixed_s
    if limits.time_s is not None:
        spent = solution.seconds + running_s() - began_s
    return ByZones(by, replace(best, seconds=spent, notes=notes), free, elsewhere)


def _rank(solution: Solution) -> tuple[float, bool]:
    """The less the better: of plans that cost the same, one that is proven."""
    return solution.objective, solution.status != "optimal"


def _proven(best: Solution, every: Sequence[Solution]) -> float | None:
    """What the cheapest of all costs that is proven, where the best one is not."""
    if best.status == "optimal":
        return None
    return min((one.objective for one in every if one.status == "optimal"), default=None)


def along(
    asked: Asked,
    profile: Profile,
    solution: Solution,
    free: Free,
    account: Account,
    progress: Progress | None = None,
) -> Iterator[tuple[Asked, Solution]]:
    """Plans by zones along another plan, until one is proven and costs less than `solution` by the zones there are.

    The zones are as large as a proof bears, so a proof alone is tried; where it fails, by smaller ones. `account` is
    told what every try takes.
    """
    facts, tried, unproven = asked.facts, 0, 0
    known = asked.stated if facts.n > FEW else None  # what is stated twice would take up memory
    zones = zones_along(facts, [facts.candidates[c].contour for c in free.solution.route])
    while tried < TRIES and account.left() is not None and (zone := next(zones, None)) is not None:
        if int(zone.max()) <= unproven:  # as large as zones of which a proof took too long
            continue
        tried += 1
        if (left := account.left()) is None:
            break
        if tried < TRIES:
            left = replace(left, work=A_TRY * left.work, time_s=left.time_s and A_TRY * left.time_s)
        began_s = running_s()
        found = _by_zones(replace(facts, zone=zone), profile, free.solution, left, progress, known)
        if found is None:
            account.spent += left.work if left.time_s is None else running_s() - began_s
            unproven = int(zone.max())
            continue
        by, moved = found
        account.spent += moved.seconds
        if not _asked_alike(moved, solution, facts.n):  # the one is not asked for what the other pays for
            continue
        yield by, moved
        if moved.status != "optimal":
            unproven = int(zone.max())
        elif moved.objective < solution.objective:
            break


def _asked_alike(one: Solution, other: Solution, contours: int) -> bool:
    """Whether the objectives of two plans count the same. In large nests what is left out says how much it is, too."""
    if contours <= FEW:
        return one.left_out == other.left_out
    return {rule for rule, _ in one.left_out} == {rule for rule, _ in other.left_out}


def _by_zones(
    facts: Facts,
    profile: Profile,
    start: Solution,
    limits: SolveOptions,
    progress: Progress | None,
    known: Stated | None = None,
) -> tuple[Asked, Solution] | None:
    """What is proven of a plan by the zones of `facts`, from one on; `known` is what is stated by other zones.

    None where that does not keep to them and none is found, or no proof applies.
    """
    from kerfwise.models.engines.rounds import solve

    limits, began_s = replace(limits, member="ideals", gap=None, no_improvement_s=None), running_s()
    try:
        stated = state_rules(facts, profile, known)
        if limits.time_s is not None:  # stating them is inside the limit
            limits = replace(limits, time_s=max(limits.time_s - (running_s() - began_s), LEAST_S))
        looks = afterthoughts(facts, profile)
        return Asked(facts, stated), solve(facts, stated.statements, limits, progress, looks, start=start.route)
    except (InputError, RulesConflict):
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


def planned_by_zones(asked: Asked, profile: Profile, limits: SolveOptions) -> ByZones:
    """A plan by zones, moved where that pays, without its program: for benchmarks."""
    from kerfwise.models.engines.rounds import solve

    looks = afterthoughts(asked.facts, profile)
    solution = solve(asked.facts, asked.stated.statements, limits, None, looks)
    order = [asked.facts.candidates[c].contour for c in solution.route]
    return better_zones(asked, afterthoughts(asked.facts, profile)(order), profile, solution, limits)
