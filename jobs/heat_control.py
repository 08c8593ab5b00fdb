"""Plans that stay cool: prices of overheats, and a limit of temperature kept by other orders and by waits."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import shapely

from kerfwise.encoder.cut import HotSpot
from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.engines.tuning import COOLER_ROUNDS as COOLER_ORDERS_ROUNDS
from kerfwise.models.engines.tuning import FIRST_PRICE_SHARE, LONGEST_S, MARGIN_K, REPEATS, SOON_S
from kerfwise.models.engines.tuning import HEAT_FIRST as FIRST
from kerfwise.models.engines.tuning import HEAT_RAISE as RAISE
from kerfwise.models.engines.tuning import HEAT_ROUNDS as ROUNDS
from kerfwise.models.heat_prices import NEAR_BANDS
from kerfwise.models.jit import running_s
from kerfwise.models.physics.heat.pacing import Heated, Pacing, hot_spots, pace
from kerfwise.models.physics.heat.timed_path import Grid, TimedPath, make_grid
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.plan.plan import SIMULATION, WAITS, Plan
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.postproc.clock import read_program, with_times
from kerfwise.postproc.nc.program import write_program
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import TemperatureLimit
from kerfwise.rules.statements import About, Lag, NoGood, Statement
from kerfwise.rules.stating.state_rules import Stated

from .by_engine import by_all_rules
from .cooler_orders import CoolerOrders, SimulatedOrders
from .heat_path import path_of_plan, path_of_program
from .request import Request
from .route_paths import RoutePaths

LATER = (1 - FIRST) / COOLER_ORDERS_ROUNDS
"""Share for each plan with prices."""

SolveStated = Callable[[float, Stated], Solution]
"""Solves with a share of the limits."""


def cooler_orders(facts: Facts, profile: Profile, stated: Stated) -> CoolerOrders:
    """What finds cooler orders that keep the statements; nothing is simulated yet."""
    problem = make_problem(facts, stated.statements, profile.home_on(facts.nest), feeds_of(profile))
    paths = RoutePaths(facts, profile, stated)
    return CoolerOrders(facts, problem, profile.heat, profile.material.thickness_mm, paths)


def with_heat_prices(facts: Facts, profile: Profile, stated: Stated) -> Stated:
    """The statements with the prices that random orders tell; as they are where overheats cost nothing.

    The prices that a plan was made with in the end are fitted to routes near to it as well, and so differ somewhat.
    Raises RulesConflict if no lawful order came of many attempts at random.
    """
    if not profile.objective.heat or not profile.heat.absorbed_power_w:
        return stated
    cooler = cooler_orders(facts, profile, stated)
    cooler.start()
    found = cooler.statements(cooler.prices(), profile.objective.heat)
    return replace(stated, statements=(*stated.statements, *found))


def solve_priced(
    request: Request,
    profile: Profile,
    limits: SolveOptions,
    solved: SolveStated,
    progress: Progress | None = None,
    orders: SimulatedOrders | None = None,
) -> tuple[Solution, Stated]:
    """The best plan by simulation at the profile's price of an overheat, and the statements with the last prices.

    Other `orders` have a price on what another simulation shows. The objective is what the plan costs by the rules and
    by what is simulated. A sheet might have none of that, so the bound is that of the rules alone. A time limit ends
    the simulations, too. Raises RulesConflict if no lawful plan exists, or none was found.
    """
    facts, stated = request.facts, request.stated
    orders = orders or cooler_orders(facts, profile, stated)
    price_mm = orders.price_mm(profile)
    began_s, solutions = running_s(), list[Solution]()

    def going() -> bool:
        in_time = limits.time_s is None or running_s() - began_s < limits.time_s * (1 - LATER)
        return in_time and (progress is None or progress("heat", None, None))

    def planner(k: int, further: tuple[Statement, ...]) -> Sequence[int]:
        part = replace(stated, statements=(*stated.statements, *further))
        solutions.append(solved(LATER if k else FIRST, part))
        return solutions[-1].route

    def judge(route: Sequence[int]) -> float | None:
        problem, sites = by_all_rules(route, facts, profile, stated.statements)
        return None if broken(problem, sites) else route_cost(problem, sites) / UM_PER_MM

    found = orders.find(price_mm, planner, judge, going, limits.seed)
    first, objective = solutions[0], found.cost_mm + price_mm * found.shown
    bound = None if first.bound is None else min(first.bound, objective)
    solution = replace(
        first,
        route=found.route,
        objective=objective,
        bound=bound,
        status="optimal" if bound is not None and objective <= bound else "feasible",
        found_by=SIMULATION,
        seconds=sum(one.seconds for one in solutions),
        notes=tuple(note for one in solutions for note in one.notes),
    )
    return solution, replace(stated, statements=(*stated.statements, *found.statements))


# Plans that keep a limit of temperature: simulated, planned again where they get too hot, and given waits.
#
# Only a whole order shows what heated a place, so demands are made afterwards (Verkhoturov et al. choose by simulated
# temperatures as well). For each burn that was too hot, the near contour cut last before it should lie further away
# in time, at a price for each second that is missing. Where a burn is too hot even on a cold sheet, near contours
# should not all be out before it. These demands are attempts and no statements of the rule: they may forbid orders
# that keep to the limit. So the cost of the plan, and what is proven of it, are those without them.


Attempt = Callable[[float, tuple[Statement, ...]], Solution]
"""Solves with a share of the limits, and further statements."""
Planned = Callable[[Solution], Plan]
"""Makes the plan of a solution, with its times."""


@dataclass(frozen=True, eq=False, slots=True)
class TriedPlan:
    """A solution, its plan, and the waits that it needs; `waits` (s) and why, `heated`, are those that the plan has."""

    solution: Solution
    plan: Plan
    pace: Pacing
    waits: Mapping[str, float] = field(default_factory=dict)
    heated: Mapping[str, Heated] = field(default_factory=dict)

    @property
    def least_s(self) -> float:
        """When its program is done at the earliest: the waits may turn out longer, never shorter."""
        return self.plan.totals.time_s + self.pace.wait_s


@dataclass(frozen=True, eq=False, slots=True)
class Cooler:
    """Finds a plan that keeps to the limit, by the facts and profile given."""

    facts: Facts
    profile: Profile
    limit: TemperatureLimit
    statements: tuple[Statement, ...]
    attempt: Attempt
    timed: Planned
    """The plan without its reasons, which take long: what is tried."""
    planned: Planned
    """The whole plan: of what is chosen."""
    going: Callable[[], bool] = lambda: True
    """Asked between orders whether to go on: not once somebody has had enough."""

    def find(self, again: bool = True) -> tuple[Solution, Plan]:
        """The first plan that keeps to the limit as it is; else, of those that waits make keep it, the one done first.

        `again` says that other orders may be asked for. Raises RulesConflict if none does: with the temperature of the
        coolest, and the waits that would do.
        """
        grid = make_grid(self.facts.nest, self.profile.heat.grid_mm)
        tried: list[TriedPlan] = []
        statements: dict[tuple[str, ...], Lag | NoGood] = {}
        for k in range(ROUNDS if again else 1):
            share = 1.0 if not again else FIRST_PRICE_SHARE if k == 0 else (1 - FIRST_PRICE_SHARE) / (ROUNDS - 1)
            try:
                solution = self.attempt(share, tuple(statements.values()))
            except RulesConflict:
                if not tried:
                    raise
                break  # the limits left no time for another order
            found = self._tried(solution, grid)
            tried.append(found)
            if not found.pace.heated or not self.going():
                break
            for demand in self._demands(found):
                again_asked = statements.get(demand.about.contours)
                if again_asked is not None and again_asked.weight is not None:  # it was not worth the price
                    demand = replace(demand, weight=again_asked.weight * RAISE)
                statements[demand.about.contours] = demand
            if not statements:
                break
        best = next((one for one in tried if not one.pace.heated), None) or self._soonest_done(tried, grid)
        if best is None:
            raise too_hot(list(map(self._hottest, tried)), [one.pace for one in tried], self.limit)
        first = tried[0].solution
        solution = first if best.solution is first else self._proven(best.solution, first)
        plan = self.planned(solution)
        if best.waits:
            plan = with_times(_waiting(plan, best.waits, best.heated, self.limit), self.facts.nest, self.profile)
        return solution, plan

    def _tried(self, solution: Solution, grid: Grid) -> TriedPlan:
        """The plan of a solution, and the waits that it needs, however long."""
        plan = self.timed(solution)
        return TriedPlan(solution, plan, self._pace(path_of_plan(plan, self.facts.nest, self.profile), grid))

    def _pace(self, path: TimedPath, grid: Grid) -> Pacing:
        profile = self.profile
        limit_c = self.limit.most_c - MARGIN_K
        return pace(self.facts.nest, path, profile.heat, profile.material.thickness_mm, limit_c, LONGEST_S, grid)

    def _allowed(self, paced: Pacing) -> bool:
        """Whether the profile lets the torch wait as long as the order needs."""
        return paced.possible and max(paced.waits.values(), default=0.0) <= self.limit.allowed_dwell_s

    def _hottest(self, one: TriedPlan) -> tuple[str, HotSpot]:
        """The burn, and the place, with which a plan is hottest as it stands."""
        nest, profile = self.facts.nest, self.profile
        path = path_of_plan(one.plan, nest, profile)
        spots = hot_spots(nest, path, profile.heat, profile.material.thickness_mm, math.inf)
        hottest = zip((burn.contour for burn in path.burns), spots, strict=True)
        return max(hottest, key=lambda found: found[1].peak_c)

    def _soonest_done(self, tried: Sequence[TriedPlan], grid: Grid) -> TriedPlan | None:
        """Of the plans that waits make keep to the limit the one that is done first; None if the waits are too long."""
        best: TriedPlan | None = None
        for one in sorted((one for one in tried if self._allowed(one.pace)), key=lambda one: one.least_s):
            if best is not None and one.least_s >= best.plan.totals.time_s:
                break
            waiting = self._with_waits(one, grid)
            if waiting is not None and (best is None or waiting.plan.totals.time_s < best.plan.totals.time_s):
                best = waiting
        return best

    def _with_waits(self, one: TriedPlan, grid: Grid) -> TriedPlan | None:
        """The plan with its waits, by the plan's clock and by the program's; None if they get too long."""
        nest, profile, plan = self.facts.nest, self.profile, one.plan
        waits = dict(one.pace.waits)
        heated = {hot.contour: hot for hot in one.pace.heated}
        for _ in range(REPEATS):
            plan = with_times(_waiting(plan, waits, heated, self.limit), nest, profile)
            written = read_program(write_program(plan, nest, profile), nest, profile)
            paces = [self._pace(path, grid) for path in (path_of_plan(plan, nest, profile), path_of_program(written))]
            if not any(paced.heated for paced in paces):
                return replace(one, plan=plan, waits=waits, heated=heated)
            for contour in dict.fromkeys(name for paced in paces for name in paced.waits):
                more_s = max(paced.waits.get(contour, 0.0) for paced in paces)
                waits[contour] = waits.get(contour, 0.0) + more_s
            heated = {hot.contour: hot for paced in paces for hot in paced.heated} | heated
            if max(waits.values()) > self.limit.allowed_dwell_s or not all(paced.possible for paced in paces):
                return None
        return None

    def _proven(self, best: Solution, first: Solution) -> Solution:
        """The solution at the price of the rules alone, with what is proven of them: further demands prove nothing."""
        cost_mm = route_cost(*by_all_rules(best.route, self.facts, self.profile, self.statements)) / UM_PER_MM
        bound = None if first.bound is None else min(first.bound, cost_mm)
        optimal = bound is not None and cost_mm <= bound
        return replace(
            best,
            objective=cost_mm,
            bound=bound,
            status="optimal" if optimal else "feasible",
            proved_by=first.proved_by if bound is not None else "",
            seconds=first.seconds + best.seconds,
            notes=(*first.notes, *best.notes),
        )

    def _demands(self, found: TriedPlan) -> Iterator[Lag | NoGood]:
        """What would have kept the burns of a plan cooler."""
        facts, heat = self.facts, self.profile.heat
        contours, index = facts.nest.contours, facts.nest.index
        price_mm = self.profile.machine.travel_mm_s
        near_mm = NEAR_BANDS * max(heat.kerf_band_mm, heat.grid_mm)
        cuts = [planned.cut for planned in found.plan.cuts]
        position = {cut.contour: k for k, cut in enumerate(cuts)}
        for hot in found.pace.heated:
            k = position[hot.contour]
            spot = shapely.Point(hot.spot.at)
            near = [
                cut
                for cut in cuts[:k]
                if (contour := contours[index[cut.contour]]).kind != "mark" and contour.line.dwithin(spot, near_mm)
            ]
            if not near:
                continue
            last, sentence = near[-1], hot_spot_sentence(hot.contour, hot.spot)
            ids = (last.contour, hot.contour)
            if hot.wait_s is not None and hot.wait_s <= SOON_S:
                pause_s = float(math.ceil(cuts[k].start_s - last.end_s + hot.wait_s))
                about = About(self.limit.rule, ids, sentence)
                yield Lag(index[ids[0]], index[ids[1]], about, seconds=pause_s, weight=price_mm)
            else:
                about = About(self.limit.rule, (*(cut.contour for cut in near), hot.contour), sentence)
                out = frozenset(index[cut.contour] for cut in near)
                yield NoGood(out, frozenset({index[hot.contour]}), about, SOON_S * price_mm)


def _waiting(plan: Plan, waits: Mapping[str, float], heated: Mapping[str, Heated], limit: TemperatureLimit) -> Plan:
    """The plan with waits (contour id to s) before the torch is lit, each with its reason: what would get too hot."""
    cuts = []
    for planned in plan.cuts:
        wait_s = round(waits.get(planned.cut.contour, 0.0), 3)
        because = tuple(text for text in planned.because if not text.startswith(WAITS))
        if wait_s:
            hot = heated[planned.cut.contour]
            without, limit_text = (
                hot_spot_sentence(hot.contour, hot.spot),
                f"{limit.most_c:g} °C, less {MARGIN_K:g} K to be sure",
            )
            because += (f"{WAITS}{wait_s:g} s first: without, {without}; {limit.rule} asks for {limit_text}",)
        cuts.append(replace(planned, dwell_s=wait_s, because=because))
    return replace(plan, cuts=tuple(cuts))


# Why no plan keeps a limit of temperature: how cool the coolest order gets, and which waits would do.

LISTED = 5
"""Waits that are told one by one."""


def too_hot(unpaced: Sequence[tuple[str, HotSpot]], tried: Sequence[Pacing], limit: TemperatureLimit) -> RulesConflict:
    """The conflict, from the orders that were tried: at least one, and none of them allowed.

    `unpaced` are the contour and the place with which each is hottest without any waits.
    """
    contour, spot = min(unpaced, key=lambda hottest: hottest[1].peak_c)
    orders = f"of {len(tried)} orders tried the coolest" if len(tried) > 1 else "the one order tried"
    without = f"{orders} gets to {spot.peak_c:.1f} °C without waits: {hot_spot_sentence(contour, spot)}"
    paced = min(tried, key=lambda one: (not one.possible, one.peak_c if not one.possible else one.wait_s))
    with_waits = _waits(paced, limit) if paced.possible else _no_wait(paced)
    message = f"{limit.rule}: no plan was found that keeps the metal at {limit.most_c:g} °C or less"
    return RulesConflict(message, (without, with_waits))


def hot_spot_sentence(contour: str, spot: HotSpot) -> str:
    """What a burn heats, as a sentence."""
    x, y = spot.at
    where = f"part {spot.part}" if spot.part else "the metal between parts"
    return f"{contour} makes {where} {spot.peak_c:.1f} °C hot at ({x:.0f}, {y:.0f})"


def _waits(paced: Pacing, limit: TemperatureLimit) -> str:
    waits = join_names([f"{wait_s:.1f} s before {contour}" for contour, wait_s in paced.waits.items()], LISTED)
    allowed = f"longest_dwell is {limit.longest_dwell_s:g} s" if limit.dwells else "dwells are not allowed"
    longest_s = max(paced.waits.values())
    if longest_s <= limit.allowed_dwell_s:  # enough by the plan's clock
        allowed = f"by the program's own times it takes more than {allowed.replace(' is', ',')}"
        longest_s = 1.5 * limit.longest_dwell_s
    return (
        f"waits of {paced.wait_s:.1f} s in all would keep it ({waits}), but {allowed}: "
        f"give {limit.rule} {{dwells: true, longest_dwell: {longest_s + 1:.0f} s}}"
    )


def _no_wait(paced: Pacing) -> str:
    alone = max((hot for hot in paced.heated if hot.wait_s is None), key=lambda hot: hot.least_c)
    return (
        f"no wait helps: the least temperature that was reached is {paced.peak_c:.1f} °C, with waits however long; "
        f"{alone.contour} heats metal to {alone.least_c:.1f} °C on a cold sheet"
    )
