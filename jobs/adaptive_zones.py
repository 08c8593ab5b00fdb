"""What zones cost a plan, and zones that cost it less: runs of a plan that was found without them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.facts.zones_along_route import movable, zones_along
from kerfwise.models.engines import Member
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.engines.tuning import A_CONTOUR, IN_VAIN, PROOF_CONTOURS, RUNG_CONTOURS, SEEDS_APART, TIMED_S
from kerfwise.models.engines.tuning import LARGE_NEST as FEW
from kerfwise.models.engines.tuning import UNZONED_LEAST as LEAST
from kerfwise.models.engines.tuning import UNZONED_MOST_MOVES as MOST_MOVES
from kerfwise.models.engines.tuning import UNZONED_SHARE as SHARE
from kerfwise.models.engines.tuning import UNZONED_STATED as STATED
from kerfwise.models.engines.tuning import UNZONED_UNPROVEN as UNPROVEN
from kerfwise.models.engines.tuning import ZONES_A_TRY as A_TRY
from kerfwise.models.engines.tuning import ZONES_FIRST as FIRST
from kerfwise.models.engines.tuning import ZONES_GAIN as GAIN
from kerfwise.models.engines.tuning import ZONES_GEOMETRY as GEOMETRY
from kerfwise.models.engines.tuning import ZONES_LEAST_S as LEAST_S
from kerfwise.models.engines.tuning import ZONES_RUNGS as RUNGS
from kerfwise.models.engines.tuning import ZONES_TIMED as TIMED
from kerfwise.models.engines.tuning import ZONES_TIMES as TIMES
from kerfwise.models.engines.tuning import ZONES_TRIES as TRIES
from kerfwise.models.jit import running_s
from kerfwise.models.plan.zones_cost import ZonesCost
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import EXEMPTION_MM, Statement
from kerfwise.rules.stating.lazy_statements import lazy_statements
from kerfwise.rules.stating.state_rules import Stated, state_rules

from .plan_without_zones import (
    Free,
    is_relaxed,
    look_for,
    next_look_limit_s,
    paying_for_crossings,
    prices_crossings,
    restated,
    searched,
    sorted_mm,
    without_zones,
    zones_cost,
)
from .request import Found, Request

# Where the plant leaves zones to us, the best plan known without zones is looked for first, and zones are runs of it.
# Of all plans found the cheapest is taken. If no zones that do what zones are for let it be as cheap as the one without
# them, its runs are zones whatever their shape, or the sheet is one zone.


def rungs(contours: int, limit: float, first: float = FIRST) -> Iterator[float]:
    """Limits up to one, which is the last of them.

    Examples
    --------
    >>> list(rungs(100, 30.0)), list(rungs(1000, 20.0)), list(rungs(40, 0.05))
    ([0.1, 0.3, 1.0, 3.0, 10.0, 30.0], [0.3, 1.0, 3.0, 10.0, 20.0], [0.05])
    """
    least = max(first, contours / RUNG_CONTOURS)
    every = (round(rung * 10.0**power, 9) for power in range(-1, 9) for rung in RUNGS)
    yield from (rung for rung in every if least <= rung < limit)
    yield limit


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
    request: Request,
    further: Sequence[Statement],
    profile: Profile,
    solution: Solution,
    limits: SolveOptions,
    ends_s: float | None = None,
    progress: Progress | None = None,
    *,
    may_move: bool = True,
) -> ZonedPlan:
    """The cheapest plan by any zones that are tried, proven or not, and the best plan known without zones.

    Of plans that cost the same, one that is proven is better. So more time makes no worse plan only because it is
    enough for a proof within worse zones. `request` and `solution`: what was asked of a plan by zones, and the plan.
    `further`: what geometry has found missing of it. `limits`: of the whole job: each step takes a share of it.
    `ends_s`: when a limit in seconds ends, by `running_s`. `may_move`: whether the plan may be another; else zones stay
    as they are.
    """
    contours = request.facts.n
    moves = may_move and movable(request.facts)
    if moves and contours <= FEW:
        return plan_by_rungs(request, profile, limits, ends_s, progress, solution) or ZonedPlan(request, solution, None)
    began_s, looked = running_s(), look_for(contours, limits, ends_s, solution, request.seconds)
    if looked is None:
        return ZonedPlan(request, solution, None)
    free = without_zones(request, further, profile, solution.route, looked, progress)
    if free is None or not moves or free.cost_mm(request, solution, limits) <= free.solution.objective:
        return ZonedPlan(request, solution, free)
    beside_s = STATED * request.seconds  # other zones take as long to be stated

    def left(spent: float) -> SolveOptions | None:
        in_time = ends_s is None or running_s() + beside_s < ends_s
        stopped = progress is not None and not progress("zones", None, None)
        return next_look_limit_s(contours, limits, ends_s, spent) if in_time and not stopped else None

    kept = free.seconds - 2 * SHARE * limits.work  # what a look took of that beside the work is missing
    account = Account(solution.seconds + kept, left)
    found = list(plans_along(request, profile, free, account, limits, progress))
    best = _best([(request, solution), *found], free)
    if best.asked is request:
        return best
    spent = account.spent - kept + free.seconds
    if limits.time_s is not None:
        spent = solution.seconds + running_s() - began_s
    return _told(best, spent, solution.notes)


def plan_by_rungs(
    asked: Request,
    profile: Profile,
    limits: SolveOptions,
    ends_s: float | None = None,
    progress: Progress | None = None,
    solution: Solution | None = None,
    found: Found | None = None,
    start: Sequence[int] = (),
) -> ZonedPlan | None:
    """The same where geometry alone has made the zones, with a plan by these zones or without one.

    A plan without zones is looked for from the route `start`, or from nothing; then from nothing, by other random
    numbers and about three times as long each time; of large nests, where that goes region by region, from where it is.
    Wherever it has become better, or nothing is proven, plans by zones along it are tried. All of this is the same
    under a larger limit, and so a larger limit finds no dearer plan. `found` is told each better plan: one without
    zones as one by a single zone.

    Returns
    -------
    ZonedPlan or None
        None where none is found.
    """
    contours, began_s, timed = asked.facts.n, running_s(), limits.time_s is not None
    whole = limits.work if ends_s is None else max(ends_s - began_s, SHARE * LEAST)
    tried = list[tuple[Request, Solution]]()
    free: Free | None = None
    spent = 0.0
    in_vain = 0

    def within(rest: float) -> SolveOptions | None:
        stopped = rest <= 0 or (progress is not None and not progress("zones", None, None))
        return None if stopped else replace(limits, work=rest, time_s=rest if timed else None)

    first, share = (TIMED_S, TIMED) if timed else (FIRST, SHARE)
    times = TIMES if solution is None else TIMES / 2  # that has taken some of it
    one = replace(asked.facts, zone=asked.facts.zone.clip(max=1))
    unzoned = None if is_relaxed(asked) else restated(one, profile, asked.stated)
    unpriced = contours > MOST_MOVES and prices_crossings(asked.stated.statements)
    told_mm = inf if solution is None else solution.objective

    def hear(by: Request, better: Solution) -> None:
        nonlocal told_mm
        if found is not None and (better.left_out or better.objective < told_mm):
            told_mm = told_mm if better.left_out else better.objective
            found(by, better)

    for number, rung in enumerate(rungs(contours, whole, first)):
        known, proves = free, rung * PROOF_CONTOURS >= contours
        if unzoned is None:
            break
        looked = UNPROVEN if unpriced and rung == whole and not (proves or timed) else share
        if (part := within(min(looked * rung, max(LEAST, A_CONTOUR * contours)))) is not None:
            if free is not None:
                start = () if contours <= MOST_MOVES else free.solution.route
            part = replace(part, seed=part.seed + number * SEEDS_APART)
            newer = searched(one, unzoned, profile, start, part, progress, found=hear)
            if newer is not None:
                spent += newer.seconds
                free = newer if free is None else free.or_better(newer)
        if free is None:
            break
        in_vain = in_vain + 1 if known is not None and free.solution.route == known.solution.route else 0
        best = _cheapest(tried)
        settled = best is not None and best[1].status == "optimal"
        if in_vain >= IN_VAIN and settled:
            break
        if (in_vain and settled) or not (proves or rung == whole):
            continue

        def left(
            taken: float,
            rung: float = rung,
            proves: bool = proves,
            aside: bool = bool(free.aside),
            before: float = spent,
        ) -> SolveOptions | None:
            if not proves and not aside:
                return replace(limits, work=LEAST_S, time_s=LEAST_S if timed else None)
            rest = began_s + rung - running_s() if timed else times * rung - taken
            return None if unpriced and taken > before and rest < contours / RUNG_CONTOURS else within(rest)

        account = Account(spent, left)
        known_mm = inf if best is None else best[1].objective
        tried += plans_along(
            asked, profile, free, account, limits, progress, prove=proves or bool(free.aside), known_mm=known_mm
        )
        spent, best = account.spent, _cheapest(tried)
        if best is not None:
            hear(*best)
        if best is not None and not free.aside and best[1].objective < free.solution.objective:
            free = replace(free, solution=best[1])  # a plan by zones is one without them, too
    given = [] if solution is None else [(asked, solution)]
    if not (every := [*given, *tried]):
        return None
    best_of_all = _best(every, free)
    if best_of_all.asked is asked:
        return best_of_all
    seconds = running_s() - began_s if timed else spent
    if solution is None:
        return _told(best_of_all, seconds, ())
    return _told(best_of_all, solution.seconds + seconds, solution.notes)


def _rank(solution: Solution) -> tuple[float, bool]:
    """The less the better: of plans that cost the same, one that is proven."""
    return solution.objective, solution.status != "optimal"


def _on_one_account(every: Sequence[tuple[Request, Solution]]) -> Sequence[tuple[Request, Solution]]:
    """The plans, each at the price of all that is asked where only some pay for what single moves cross."""
    if len({frozenset(rule for rule, _ in one.left_out) for _, one in every}) < 2:
        return every
    return [(by, paying_for_crossings(by, one)) for by, one in every]


def _cheapest(every: Sequence[tuple[Request, Solution]]) -> tuple[Request, Solution] | None:
    return min(_on_one_account(every), key=lambda plan: _rank(plan[1]), default=None)


def _best(every: Sequence[tuple[Request, Solution]], free: Free | None) -> ZonedPlan:
    """The cheapest of plans, and what the cheapest of all costs that is proven, where it is not."""
    every = _on_one_account(every)
    by, best = min(every, key=lambda plan: _rank(plan[1]))
    elsewhere = None
    if best.status != "optimal":
        elsewhere = min((one.objective for _, one in every if one.status == "optimal"), default=None)
    return ZonedPlan(by, best, free, elsewhere)


def _told(best: ZonedPlan, seconds: float, before: tuple[str, ...]) -> ZonedPlan:
    """The plan with what all of it took, and notes on it."""
    shape = "zones: moved along the best plan known without them"
    if best.asked.facts.zone.max(initial=0) < 2:
        shape = (
            "zones: the whole sheet is one, as no others let the plan be as short as the best one known without them"
        )
    notes = (*before, shape, *best.solution.notes)
    return replace(best, solution=replace(best.solution, seconds=seconds, notes=notes))


def plans_along(
    request: Request,
    profile: Profile,
    free: Free,
    account: Account,
    limits: SolveOptions,
    progress: Progress | None = None,
    *,
    prove: bool = True,
    known_mm: float = inf,
) -> Iterator[tuple[Request, Solution]]:
    """Plans by zones along another plan.

    Zones that do what zones are for come first, until a plan is proven and no dearer than the other; then, where all
    are dearer, zones of any shape, and then a single one. The zones are as large as a proof bears, so a proof alone is
    tried; where it fails, by smaller ones. `account` is told what every try takes. Without `prove` any plan will do
    that is no dearer. Where that plan does not pay for its moves, zones are passed over that break it too much for a
    plan cheaper than one of `known_mm`, and those that break it no less than others which were proven.
    """
    facts, unproven, tries, dear = request.facts, 0, 0, True
    stated = request.stated if facts.n > FEW else None  # what is stated twice would take up memory
    order = [facts.candidates[c].contour for c in free.solution.route]
    shaped, seen = zones_along(facts, order), list[list[int]]()
    unpriced, most_mm = bool(free.aside) and facts.n <= FEW, (1.0 + GAIN) * known_mm if known_mm < EXEMPTION_MM else inf
    while tries < TRIES and account.left() is not None and (zone := next(shaped, None)) is not None:
        if int(zone.max()) <= unproven:  # as large as zones of which a proof took too long
            continue
        tries += 1
        broken_mm = sorted_mm(request, free, zone) if unpriced else 0.0
        if broken_mm >= most_mm:
            continue
        if (left := account.left()) is None:
            break
        if tries < TRIES:
            left = replace(left, work=A_TRY * left.work, time_s=left.time_s and A_TRY * left.time_s)
        unproven = int(zone.max())
        seen.append(zone.tolist())
        for plan in _tried(replace(facts, zone=zone), profile, free, left, progress, account, stated):
            yield plan
            dear = dear and free.dearer(*plan, limits)
            if plan[1].status == "optimal":
                unproven = 0
                most_mm = min(most_mm, broken_mm) if unpriced and plan[1].objective < EXEMPTION_MM else most_mm
        if not dear and not (prove and unproven):
            return
    any_zones = (zone for zone in zones_along(facts, order, any_shape=True) if zone.tolist() not in seen)
    if dear and (left := account.left()) is not None and (zone := next(any_zones, None)) is not None:
        if unpriced and sorted_mm(request, free, zone) >= most_mm:
            return
        for plan in _tried(replace(facts, zone=zone), profile, free, left, progress, account, stated):
            yield plan
            dear = dear and free.dearer(*plan, limits)
    if dear and not free.aside and (left := account.left()) is not None:
        one = replace(facts, zone=facts.zone.clip(max=1))
        yield from _tried(one, profile, free, left, progress, account, stated, member=None)


def _tried(
    facts: Facts,
    profile: Profile,
    free: Free,
    limits: SolveOptions,
    progress: Progress | None,
    account: Account,
    known: Stated | None,
    member: Member | None = "ideals",
) -> Iterator[tuple[Request, Solution]]:
    """The plan by the zones of `facts`, if there is one that is asked for as much as the one without zones."""
    began_s = running_s()
    found = _by_zones(facts, profile, free.solution, limits, progress, known, None if free.aside else member)
    if found is None:
        account.spent += limits.work if limits.time_s is None else running_s() - began_s
        return
    account.spent += found[1].seconds
    if free.aside or _asked_alike(found[1], free.solution, facts.n):
        yield found


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
    member: Member | None = "ideals",
) -> tuple[Request, Solution] | None:
    """What is proven of a plan by the zones of `facts`, from one on; `known` is what is stated by other zones.

    None where that does not keep to them and none is found, or no proof applies.
    """
    from kerfwise.models.engines.solve import solve

    limits, began_s = replace(limits, member=member, gap=None, no_improvement_s=None), running_s()
    try:
        stated = state_rules(facts, profile, known)
        if limits.time_s is not None:  # stating them is inside the limit
            limits = replace(limits, time_s=max(limits.time_s - (running_s() - began_s), LEAST_S))
        looks = lazy_statements(facts, profile)
        return Request(facts, stated), solve(facts, stated.statements, limits, progress, looks, start=start.route)
    except (InputError, RulesConflict):
        return None


def zones_follow(asked: Request) -> bool:
    """Whether zones are drawn along a plan from the start: geometry made them, of neither few nor many contours."""
    return GEOMETRY < asked.facts.n <= FEW and movable(asked.facts)
