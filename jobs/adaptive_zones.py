"""What zones cost a plan, and zones that cost it less: runs of a plan that was found without them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.facts.zones_along_route import movable, zones_along
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.solution import LEAST_SHARE, Solution, SolveOptions
from kerfwise.models.jit import running_s
from kerfwise.models.plan.make_plan import excuses as excused
from kerfwise.models.plan.plan import RELAXED, ZonesCost
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import EXEMPTION_MM, About, Precede, Statement, by_kind
from kerfwise.rules.stating.lazy_statements import lazy_statements
from kerfwise.rules.stating.state_rules import Stated, state_rules

from .request import Request

# The best plan known without zones is looked for first. Where its runs do not do what zones are for, a plan is looked
# for that keeps to the zones there are but for their borders: contours of zones that follow each other may be mixed.

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
class ZonedPlan:
    """A plan by zones: what was asked of it, its solution, and the best plan known without zones, if one was asked for.

    `proven_elsewhere` is the objective of a plan that is proven within other zones and dearer, mm, where this one is
    not proven.
    """

    asked: Request
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
    asked: Request,
    further: Sequence[Statement],
    profile: Profile,
    solution: Solution,
    limits: SolveOptions,
    ends_s: float | None = None,
    progress: Progress | None = None,
    *,
    may_move: bool = True,
) -> ZonedPlan:
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
        return ZonedPlan(asked, solution, None)
    free = without_zones(asked, further, profile, solution, looked, progress)
    if free is None or not may_move or not movable(asked.facts):
        return ZonedPlan(asked, solution, free)
    if free.cost_mm(asked, solution, limits) <= free.solution.objective:
        return ZonedPlan(asked, solution, free)
    beside_s = running_s() - began_s - (looked.time_s or 0.0)  # other zones take as long to be stated, at least
    if contours > FEW:
        beside_s = STATED * asked.seconds

    def left(spent: float) -> SolveOptions | None:
        in_time = ends_s is None or running_s() + beside_s < ends_s
        stopped = progress is not None and not progress("zones", None, None)
        return next_look_limit_s(contours, limits, ends_s, spent) if in_time and not stopped else None

    kept = missing_look_work(contours, free.seconds, limits)
    account, mixed_s = Account(solution.seconds + kept, left), 0.0
    found = list(plans_along(asked, profile, solution, free, account, progress))
    looked = look_again(contours, limits, ends_s)
    none_better = not any(_rank(other) < _rank(solution) for _, other in found)
    if none_better and looked is not None and account.left() is not None:
        borders = tuple(without_neighbour_orders(asked.facts, zoned_by(asked, profile)))
        mixed = without_zones(asked, further, profile, solution, looked, progress, borders)
        mixed_s = 0.0 if mixed is None else mixed.seconds
        if mixed is not None and mixed.solution.route != free.solution.route:
            found += plans_along(asked, profile, solution, mixed, account, progress)
    every = [(asked, solution), *found]
    by, best = min(every, key=lambda plan: _rank(plan[1]))
    elsewhere = _proven(best, [other for _, other in every])
    if best is solution:
        return ZonedPlan(asked, solution, free, elsewhere)
    notes = (*solution.notes, "zones: moved along the best plan known without them", *best.notes)
    spent = account.spent - kept + free.seconds + mixed_s
    if limits.time_s is not None:
        spent = solution.seconds + running_s() - began_s
    return ZonedPlan(by, replace(best, seconds=spent, notes=notes), free, elsewhere)


def _rank(solution: Solution) -> tuple[float, bool]:
    """The less the better: of plans that cost the same, one that is proven."""
    return solution.objective, solution.status != "optimal"


def _proven(best: Solution, every: Sequence[Solution]) -> float | None:
    """What the cheapest of all costs that is proven, where the best one is not."""
    if best.status == "optimal":
        return None
    return min((one.objective for one in every if one.status == "optimal"), default=None)


def plans_along(
    asked: Request,
    profile: Profile,
    solution: Solution,
    free: Free,
    account: Account,
    progress: Progress | None = None,
) -> Iterator[tuple[Request, Solution]]:
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
) -> tuple[Request, Solution] | None:
    """What is proven of a plan by the zones of `facts`, from one on; `known` is what is stated by other zones.

    None where that does not keep to them and none is found, or no proof applies.
    """
    from kerfwise.models.engines.solve import solve

    limits, began_s = replace(limits, member="ideals", gap=None, no_improvement_s=None), running_s()
    try:
        stated = state_rules(facts, profile, known)
        if limits.time_s is not None:  # stating them is inside the limit
            limits = replace(limits, time_s=max(limits.time_s - (running_s() - began_s), LEAST_S))
        looks = lazy_statements(facts, profile)
        return Request(facts, stated), solve(facts, stated.statements, limits, progress, looks, start=start.route)
    except (InputError, RulesConflict):
        return None


def without_neighbour_orders(facts: Facts, rules: frozenset[str]) -> Iterator[Precede]:
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


def planned_by_zones(asked: Request, profile: Profile, limits: SolveOptions) -> ZonedPlan:
    """A plan by zones, moved where that pays, without its program: for benchmarks."""
    from kerfwise.models.engines.solve import solve

    looks = lazy_statements(asked.facts, profile)
    solution = solve(asked.facts, asked.stated.statements, limits, None, looks)
    order = [asked.facts.candidates[c].contour for c in solution.route]
    return better_zones(asked, lazy_statements(asked.facts, profile)(order), profile, solution, limits)


# What zones cost a plan: the search goes on from it without the orders of zones.

MOST_MOVES = 150
"""Contours with more of which looking at every single move takes too long."""


@dataclass(frozen=True, eq=False, slots=True)
class Free:
    """The best plan known without zones: what was asked of it, its solution, and how long it was looked for, s.

    `aside` are the rules that it was not asked to keep besides those of zones.
    """

    stated: Stated
    solution: Solution
    seconds: float
    aside: tuple[str, ...] = ()

    def cost_mm(self, asked: Request, solution: Solution, limits: SolveOptions) -> float:
        """What a plan by zones costs by the same account."""
        if set(self.aside) == {rule for rule, _ in solution.left_out}:
            return solution.objective
        timed = limits.time_s is not None  # the clock left out moves over parts: neither plan is asked for those
        statements = self.stated.statements
        problem = make_problem(asked.facts, statements, limits.home_mm, limits.feeds, going=lambda share: not timed)
        return route_cost(problem, problem.candidate_site[list(solution.route)].tolist()) / UM_PER_MM


def zoned_by(asked: Request, profile: Profile) -> frozenset[str]:
    """The rules that have the nest cut in several zones; none where there is one zone alone, or too many contours."""
    facts, book = asked.facts, profile.rulebook()
    if facts.zone.max(initial=0) < 2 or facts.n > MOST_CONTOURS:
        return frozenset()
    settings = profile.settings().items()
    return frozenset(name for name, setting in settings if book[name].makes_zones and setting.weight is None)


def without_zones(
    asked: Request,
    further: Sequence[Statement],
    profile: Profile,
    solution: Solution,
    limits: SolveOptions,
    progress: Progress | None = None,
    instead: Sequence[Statement] = (),
) -> Free | None:
    """The best plan that is found without zones, from a planned one on.

    Parameters
    ----------
    asked
        What was asked of the plan.
    further
        What geometry has found missing of it.
    solution
        The plan's route.
    limits
        How long to look: `work`, or `time_s` where that is given.
    progress
        Asked now and then whether to go on.
    instead
        What is asked in place of zones.

    Returns
    -------
    Free or None
        None where there is none: no rule makes zones, hard statements were relaxed, or it was interrupted.
    """
    from kerfwise.models.engines.solve import solve

    facts, names = asked.facts, zoned_by(asked, profile)
    relaxed = any(dropped.why.startswith(RELAXED) for dropped in asked.stated.dropped)
    if not names or not solution.route or relaxed or (progress is not None and not progress("zones", None, None)):
        return None
    moves_too = facts.n <= MOST_MOVES
    left = [s for s in (*asked.stated.statements, *further) if s.about.rule not in names] + list(instead)
    kept, unasked = (left, frozenset[str]()) if moves_too else without_moves(left)
    stated = Stated(tuple(kept), (), asked.stated.exempt)
    began_s = running_s()
    limits = replace(limits, member="search", gap=None, no_improvement_s=None)
    try:
        found = solve(facts, stated.statements, limits, progress, lazy_statements(facts, profile), start=solution.route)
    except RulesConflict:
        return None
    aside = unasked | {r for r, _ in found.left_out}
    spent_s = found.seconds if limits.time_s is None else running_s() - began_s
    return Free(stated, found, spent_s, tuple(sorted(aside)))


def zones_cost(asked: Request, solution: Solution, free: Free, limits: SolveOptions) -> ZonesCost:
    """What a plan by zones costs more than the best one known without."""
    gained_mm = free.cost_mm(asked, solution, limits) - free.solution.objective
    excuses = round(gained_mm / EXEMPTION_MM)
    if excuses < 0 or gained_mm <= 0:
        return ZonesCost(0.0, 0, (), free.seconds, free.aside)
    had, has = (excused(asked.facts, free.stated, route) for route in (solution.route, free.solution.route))
    avoided = [(name, rule) for name, rules in had.items() for rule in rules if rule not in has.get(name, ())]
    named = tuple(avoided if excuses else ())
    return ZonesCost(gained_mm - excuses * EXEMPTION_MM, excuses, named, free.seconds, free.aside)


def without_moves(statements: Sequence[Statement]) -> tuple[list[Statement], frozenset[str]]:
    """The statements but for those on moves over areas, and the rules that these come from."""
    moves = by_kind(statements).crossing
    unasked = {id(s) for s in moves}
    return [s for s in statements if id(s) not in unasked], frozenset(s.about.rule for s in moves)


# How long plans without zones, and by other zones, are looked for, and whether that is begun at all.
#
# Up to `FEW` contours a look has a share of the limit, always. In larger nests a plan by the zones of geometry is
# proven within a small part of the work, and other zones are proven about as fast: a look has what these two leave.
# It is not begun where it would have so little that all goes into its tables.

SHARE = 0.15
"""Share of a limit in which a plan without zones is looked for, at the most: of one in seconds, of which it is left so
much, or of the work, beside it. As much again is there for a plan by other zones, and what the first plan has left."""
LEAST, A_CONTOUR = 0.5, 0.02
"""Work that it takes at the least, and for every contour."""
FEW, MOST_CONTOURS = 2500, 12_000
"""Contours up to which that share is all it has, and up to which it is looked for."""
LEAST_WORK, LEAST_LOOK_S, PROVEN_S = 1e-4, 1e-3, 1e-3
"""Work, and seconds by the clock, for every contour of a larger nest, with less of which a look is not begun there; and
seconds that other zones have beside `STATED`, at the least, where there is time for them at all."""
PROOF = 4.0
"""How many times as long as the first plan took is kept for plans by other zones there, or half of what is left."""
STATED = 3.0
"""How many times as long as stating the rules took it takes there to draw zones, to state the rules by them, to make
the problem, and to look at one plan: what comes beside a proof."""
HELD_GB = 1e-4
"""What facts and statements of a contour take there in memory, beside the tables of a proof."""


def is_look_worthwhile(contours: int, limits: SolveOptions) -> bool:
    """Whether a plan without zones is looked for at all, as far as can be told before the first plan.

    Examples
    --------
    >>> (
    ...     [is_look_worthwhile(10_000, SolveOptions(work=work)) for work in (0.1, 10.0)],
    ...     is_look_worthwhile(2_000, SolveOptions(work=0.1)),
    ... )
    ([False, True], True)
    """
    if contours <= FEW:
        return True
    if contours > MOST_CONTOURS:
        return False
    if limits.time_s is None:
        return limits.work / 2 >= LEAST_WORK * contours
    return SHARE * limits.time_s >= LEAST_LOOK_S * contours


def look_for(
    contours: int, limits: SolveOptions, ends_s: float | None, first: Solution, stated_s: float = 0.0
) -> SolveOptions | None:
    """How long a plan without zones is looked for; None for not at all.

    Parameters
    ----------
    ends_s
        When a limit in seconds ends, by `running_s`.
    first
        The plan by the zones of geometry.
    stated_s
        How long it took to state the rules.
    """
    if contours <= FEW:
        return _share(contours, limits, ends_s)
    if not is_look_worthwhile(contours, limits):
        return None
    if limits.time_s is None or ends_s is None:
        left = limits.work - first.seconds
        work = max(left - min(PROOF * first.seconds, left / 2), SHARE * limits.work)
        return replace(limits, work=work) if work >= LEAST_WORK * contours else None
    left_s = ends_s - running_s()
    kept_s = min(PROOF * first.seconds, left_s / 2)
    all_s = max(kept_s, STATED * stated_s + PROVEN_S * contours)
    times_s = [left_s - all_s, left_s - kept_s]  # where zones have no time to move, what they cost is looked for alone
    time_s = next((time_s for time_s in times_s if time_s >= LEAST_LOOK_S * contours), None)
    return None if time_s is None else replace(limits, time_s=time_s)


def look_again(contours: int, limits: SolveOptions, ends_s: float | None) -> SolveOptions | None:
    """How long a plan that mixes neighbouring zones is looked for, where the other one was of no avail."""
    found = _share(contours, limits, ends_s)
    if contours <= FEW:
        return found
    if found.time_s is None:
        return found if found.work >= LEAST_WORK * contours else None
    return found if found.time_s >= LEAST_LOOK_S * contours else None


def _share(contours: int, limits: SolveOptions, ends_s: float | None) -> SolveOptions:
    if limits.time_s is None or ends_s is None:
        return replace(limits, work=min(SHARE * limits.work, max(LEAST, A_CONTOUR * contours)))
    left_s = (ends_s - running_s()) / 2
    return replace(limits, time_s=max(min(SHARE * limits.time_s, left_s), SHARE * LEAST))


def missing_look_work(contours: int, looked: float, limits: SolveOptions) -> float:
    """How much of the work of a look is missing for plans by other zones; those have as much beside it as a look."""
    return 0.0 if contours <= FEW else looked - 2 * SHARE * limits.work


def next_look_limit_s(contours: int, limits: SolveOptions, ends_s: float | None, spent: float) -> SolveOptions:
    """How long a plan by other zones may take: as long as the limit leaves, where so much work of it is spent."""
    if contours > FEW:
        limits = replace(limits, memory_gb=max(limits.memory_gb - HELD_GB * contours, LEAST_SHARE * limits.memory_gb))
    if limits.time_s is None or ends_s is None:
        return replace(limits, work=max(limits.work - spent, SHARE * limits.work))
    return replace(limits, time_s=max(ends_s - running_s(), SHARE * LEAST))
