"""The problem: facts and statements as the numbers that every engine works on.

Costs are whole micrometres (of idle travel, or of what a soft rule is worth in it), so that all engines agree to
the last digit. Candidates of a contour that no statement tells apart and that share pierce and end are one *site*.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.models.physics.timing.constant import Feeds
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.statements import (
    About,
    AtLeast,
    Contiguous,
    Crossing,
    Forbid,
    IdleTravel,
    Lag,
    NoGood,
    Pick,
    Precede,
    Statement,
)

from .closure import close
from .conditions import Condition, of_at_least, of_no_good, of_soft_precede
from .crossed_areas import Going
from .crossings import Crossings, TooManyMoves, find_crossings, from_home
from .pace import Pace
from .successors import lawful_successors

UM_PER_MM = 1000
HALF = 0.501
"""What is added before a length in µm is cut off: coordinates carry rounding, and a half must not fall either way."""
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class SoftGroup:
    """Contours that should follow each other: every piece beyond the first costs `cost` µm."""

    contours: tuple[int, ...]
    cost: int
    about: About


@dataclass(frozen=True, eq=False, slots=True)
class Problem:
    """n contours, m sites.

    `site_candidate[s]` is the candidate that site s stands for, `candidate_site[c]` the site of candidate c or -1;
    sites of contour i are `first[i]` … `first[i+1] - 1`.
    `pierce_um`, `end_um` are (m, 2) coordinates, µm; `site_cost` (m,) what using a site costs (soft `Forbid`).
    `before[i, j]` says that i must come before j (closure, lifted over contiguous blocks); `block[i]` numbers the
    contiguous block that i belongs to. `conditions` are about sites (`when` is a site here). `general` are statements
    that only an engine with the whole order in hand can judge, as are `lags` but for those of one cut. `crossings`
    are moves that cost more, or are unlawful, once some contour is out. `pace` tells how long cuts and moves take.
    `left_out` are soft rules that could not be priced on a problem of this size, and why. `matrix` (m + 1, m + 1), home
    last, replaces idle travel between points where costs are given by a table.
    """

    n: int
    first: Ints
    site_contour: Ints
    site_candidate: Ints
    candidate_site: Ints
    pierce_um: Ints
    end_um: Ints
    site_cost: Ints
    home_um: Ints
    travel_weight: float
    before: Bools
    block: Ints
    conditions: tuple[Condition, ...]
    soft_groups: tuple[SoftGroup, ...]
    lags: tuple[Lag, ...]
    general: tuple[AtLeast, ...]
    ids: tuple[str, ...]
    crossings: Crossings = field(default_factory=Crossings)
    pace: Pace = field(default_factory=Pace)
    matrix: Ints | None = None
    left_out: tuple[tuple[str, str], ...] = ()

    @property
    def m(self) -> int:
        """Number of sites."""
        return len(self.site_contour)

    def sites(self, contour: int) -> range:
        """Site numbers of a contour."""
        return range(int(self.first[contour]), int(self.first[contour + 1]))

    def successors(self) -> Bools:
        """Matrix (n + 1, n + 1): which contour may directly follow which; n is the machine's home."""
        return lawful_successors(self.before, self.block, self.apart())

    def apart(self) -> list[tuple[int, int]]:
        """Contours that may not follow each other, whichever comes first."""
        return [(lag.first, lag.second) for lag in self.lags if lag.weight is None and lag.cuts > 0]

    def travel(self, leave: Ints | Sequence[int], reach: Ints | Sequence[int]) -> Ints:
        """Cost matrix of idle travel from the end of each site in `leave` (k,) to the pierce of each in `reach` (l,).

        Home is site m. Whole µm, or whatever unit `matrix` has.
        """
        if self.matrix is not None:
            return np.asarray(self.matrix[np.ix_(np.asarray(leave), np.asarray(reach))], dtype=np.int64)
        gap = self._at(self.end_um, leave)[:, None, :] - self._at(self.pierce_um, reach)[None, :, :]
        return np.asarray(np.rint(self.travel_weight * np.sqrt((gap**2).sum(axis=2))), dtype=np.int64)

    def legs(self, leave: Ints | Sequence[int], reach: Ints | Sequence[int]) -> Ints:
        """Cost of idle travel from the end of `leave[k]` to the pierce of `reach[k]`, (k,); home is site m."""
        if self.matrix is not None:
            return np.asarray(self.matrix[leave, reach], dtype=np.int64)
        gap = self._at(self.end_um, leave) - self._at(self.pierce_um, reach)
        return np.asarray(np.rint(self.travel_weight * np.sqrt((gap**2).sum(axis=1))), dtype=np.int64)

    def _at(self, points_um: Ints, sites: Ints | Sequence[int]) -> Floats:
        """The points of some sites, home included, (k, 2)."""
        chosen = np.asarray(sites, dtype=np.int64)
        at = np.empty((len(chosen), 2))
        home = chosen == self.m
        at[home], at[~home] = self.home_um, points_um[chosen[~home]]
        return at

    def ends(self) -> Ints:
        """Where the torch is after every site and at home, (m + 1, 2), µm."""
        return np.vstack([self.end_um, self.home_um])

    def pierces(self) -> Ints:
        """Where every site is pierced, and home, (m + 1, 2), µm."""
        return np.vstack([self.pierce_um, self.home_um])


def make_problem(
    facts: Facts,
    statements: tuple[Statement, ...],
    home_mm: tuple[float, float],
    feeds: Feeds | None = None,
    earlier: Problem | None = None,
    going: Going = lambda share: True,
) -> Problem:
    """Compile facts and statements; `feeds` are needed for statements that count seconds.

    `earlier` is a problem made of the same facts and some of these statements: the moves that were looked at for it
    need not be looked at again where they are the same, and are not where it left them out. `going` is asked now and
    then, with the share of the moves that has been looked at; where it says no a soft rule about moves is left out.

    Raises
    ------
    RulesConflict
        If the hard orders form a cycle, or a contour has no candidate left.
    """
    contour_of = [c.contour for c in facts.candidates]
    kinds = by_kind(statements)
    hard = [s for s in kinds.precede if s.weight is None]
    blocks = _blocks(facts.n, [g for g in kinds.contiguous if g.weight is None])
    before = close(facts.n, [(p.before, p.after) for p in hard], blocks)
    if before.diagonal().any():
        raise _contradiction(before, hard)
    conditions, general = _conditions(statements, contour_of)
    allowed, costs = _candidate_costs(facts, kinds.forbid)
    site_of, representatives = _sites(facts, allowed, costs, conditions, general)
    chosen = np.array(representatives, dtype=np.int64)
    kept = set(representatives)  # candidates of one site are asked alike: what is asked of one counts once
    contours = np.array([contour_of[c] for c in representatives], dtype=np.int64)
    candidate_site = np.full(len(facts.candidates), -1, dtype=np.int64)
    candidate_site[list(site_of)] = list(site_of.values())
    first = np.searchsorted(contours, np.arange(facts.n + 1)).astype(np.int64)
    problem = Problem(
        n=facts.n,
        first=first,
        site_contour=contours,
        site_candidate=chosen,
        candidate_site=candidate_site,
        pierce_um=points_um([facts.candidates[c].pierce for c in representatives], home_mm),
        end_um=points_um([facts.candidates[c].end for c in representatives], home_mm),
        site_cost=costs[chosen] if len(chosen) else np.zeros(0, dtype=np.int64),
        home_um=points_um([home_mm], home_mm)[0],
        travel_weight=sum(s.weight for s in kinds.idle_travel),
        before=before,
        block=blocks,
        conditions=tuple(dict.fromkeys(_on_site(c, site_of) for c in conditions if c.when is None or c.when in kept)),
        soft_groups=tuple(
            SoftGroup(g.contours, _cost(g.weight), g.about) for g in kinds.contiguous if g.weight is not None
        ),
        lags=kinds.lag,
        general=tuple(general),
        ids=tuple(c.id for c in facts.nest.contours),
        pace=Pace() if feeds is None else Pace.of(facts, representatives, feeds),
    )
    return _with_crossings(problem, kinds.crossing, earlier, going)


def _with_crossings(problem: Problem, statements: Sequence[Crossing], earlier: Problem | None, going: Going) -> Problem:
    if not statements:
        return problem
    sites = np.append(problem.first, problem.m + 1)
    if any(s.over is None for s in statements):
        lawful, pierces = problem.successors(), problem.pierces()
        begun = [_not_first(problem, site, statements[k]) for site, k in from_home(statements, lawful, sites, pierces)]
        problem = replace(problem, conditions=(*problem.conditions, *begun))
    if earlier is not None and (earlier.left_out or _same_moves(problem, earlier)):
        return replace(problem, crossings=earlier.crossings, left_out=earlier.left_out)
    hard = any(s.weight is None for s in statements)
    lawful, ends, pierces = problem.successors(), problem.ends(), problem.pierces()
    try:
        asked = (statements, problem.before, lawful, sites, ends, pierces)
        found = find_crossings(*asked) if hard else find_crossings(*asked, going)
    except TooManyMoves as error:
        if hard:
            raise
        return replace(problem, left_out=((statements[0].about.rule, error.message),))
    return replace(problem, crossings=found)


def _not_first(problem: Problem, site: int, statement: Crossing) -> Condition:
    """The torch does not come to a site from home: some contour is cut before."""
    contour = int(problem.site_contour[site])
    others = tuple(k for k in range(problem.n) if k != contour)
    cost = None if statement.weight is None else _cost(statement.weight)
    return Condition(contour, others, (1,) * len(others), 1, statement.about, when=site, cost=cost)


def _same_moves(one: Problem, other: Problem) -> bool:
    """Whether the same sites may follow each other in both."""
    return (
        np.array_equal(one.site_candidate, other.site_candidate)
        and np.array_equal(one.before, other.before)
        and np.array_equal(one.block, other.block)
        and one.apart() == other.apart()
    )


def points_um(points_mm: Sequence[Point], home_mm: Point) -> Ints:
    """Points (k, 2) in whole µm, counted from home: a nest that is shifted with its home has the same travel.

    Half a micrometre is rounded away from home, and so is what is less by no more than rounding.

    Examples
    --------
    >>> points_um([(1.0005, -0.0005)], (0.0, 0.0)).tolist(), points_um([(0.3005, 0.1)], (0.1, 0.1)).tolist()
    ([[1001, -1]], [[301, 100]])
    """
    from_home = (np.array(points_mm, dtype=np.float64).reshape(-1, 2) - home_mm) * UM_PER_MM
    whole = np.copysign(np.floor(np.abs(from_home) + HALF), from_home)
    return np.asarray(whole + np.rint(np.array(home_mm) * UM_PER_MM), dtype=np.int64)


def _cost(weight_mm: float | None) -> int:
    return round((weight_mm or 0.0) * UM_PER_MM)


def _blocks(n: int, groups: list[Contiguous]) -> Ints:
    """Number of the contiguous block of every contour: groups that share a contour must be one block."""
    block = np.arange(n, dtype=np.int64)
    owner: dict[int, Contiguous] = {}
    for group in groups:
        for contour in group.contours:
            if contour in owner:
                other = owner[contour]
                raise RulesConflict(
                    "contours can be kept together in one group only",
                    (other.about.sentence, group.about.sentence),
                )
            owner[contour] = group
            block[contour] = group.contours[0]
    return block


def _contradiction(before: Bools, hard: list[Precede]) -> RulesConflict:
    """Names the orders between contours that stand on a cycle (`rules.stating.cycles` names the shortest first)."""
    stuck = before.diagonal()
    said = [p.about.sentence for p in hard if stuck[p.before] and stuck[p.after]]
    return RulesConflict("the order rules contradict each other", tuple(dict.fromkeys(said)))


def _conditions(statements: tuple[Statement, ...], contour_of: list[int]) -> tuple[list[Condition], list[AtLeast]]:
    """What becomes conditions on sites, and what no condition can say; other kinds are fields of their own."""
    conditions: list[Condition] = []
    general: list[AtLeast] = []
    for s in statements:
        match s:
            case Precede():
                if s.weight is not None:
                    conditions.append(of_soft_precede(s, _cost(s.weight)))
            case NoGood():
                conditions.extend(of_no_good(s, None if s.weight is None else _cost(s.weight)))
            case AtLeast():
                made = of_at_least(s, contour_of, None if s.weight is None else _cost(s.weight))
                if made is None:
                    general.append(s)
                else:
                    conditions.append(made)
            case Forbid() | Contiguous() | Lag() | Crossing() | IdleTravel():
                pass  # `make_problem` reads them
            case _:
                assert_never(s)
    return conditions, general


def _candidate_costs(facts: Facts, forbidden: Sequence[Forbid]) -> tuple[Bools, Ints]:
    allowed = np.ones(len(facts.candidates), dtype=np.bool_)
    costs = np.zeros(len(facts.candidates), dtype=np.int64)
    reasons: dict[int, list[str]] = defaultdict(list)
    for s in forbidden:
        if s.weight is None:
            allowed[s.candidate] = False
            reasons[facts.candidates[s.candidate].contour].append(s.about.sentence)
        else:
            costs[s.candidate] += _cost(s.weight)
    for contour in range(facts.n):
        span = facts.candidates_of(contour)
        if not allowed[span.start : span.stop].any():
            name = facts.nest.contours[contour].id
            raise RulesConflict(f"{name} has no lawful entry left", tuple(dict.fromkeys(reasons[contour])))
    return allowed, costs


def _sites(
    facts: Facts, allowed: Bools, costs: Ints, conditions: list[Condition], general: list[AtLeast]
) -> tuple[dict[int, int], list[int]]:
    """Site of every candidate that is kept, and the candidate each site stands for."""
    told_apart: dict[int, list[object]] = defaultdict(list)
    for condition in conditions:
        if condition.when is not None:
            told_apart[condition.when].append((condition.members, condition.weights, condition.bound, condition.cost))
    for number, s in enumerate(general):
        for c in {lit.c for lit in s.literals if isinstance(lit, Pick)} | {s.when}:
            if c is not None:
                told_apart[c].append(number)
    site_of: dict[int, int] = {}
    seen: dict[object, int] = {}
    representatives: list[int] = []
    for number, candidate in enumerate(facts.candidates):
        if not allowed[number]:
            continue
        key = (candidate.contour, candidate.pierce, candidate.end, int(costs[number]), tuple(told_apart[number]))
        if key not in seen:
            seen[key] = len(representatives)
            representatives.append(number)
        site_of[number] = seen[key]
    return site_of, representatives


def _on_site(condition: Condition, site_of: dict[int, int]) -> Condition:
    if condition.when is None:
        return condition
    return Condition(
        condition.contour,
        condition.members,
        condition.weights,
        condition.bound,
        condition.about,
        site_of[condition.when],
        condition.cost,
    )
