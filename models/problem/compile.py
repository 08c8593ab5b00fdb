"""Facts and statements compiled to a problem: candidates become sites, statements conditions on what is out."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain
from operator import attrgetter

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.tolerances import cost_um, points_um
from kerfwise.models.physics.motion import Feeds
from kerfwise.rules.statements import (
    AtLeast,
    Contiguous,
    Crossing,
    Enough,
    Forbid,
    Kinds,
    Link,
    Move,
    Precede,
    Statement,
    by_kind,
)

from .bitsets import digest
from .conditions import Condition, LoweredStatements, lower_statements, starts_with
from .crossings import Crossings, Going, TooManyMoves, find_crossings, from_home
from .moves import MovePrices, without_near_lags
from .precedence import close
from .problem import Durations, Links, Problem, SoftGroup
from .simplify import sites_of


def make_problem(
    facts: Facts,
    statements: tuple[Statement, ...],
    home_mm: tuple[float, float],
    feeds: Feeds | None = None,
    earlier: Problem | None = None,
    going: Going = lambda share: True,
) -> Problem:
    """Compile facts and statements; `feeds` are needed for statements that count seconds.

    `earlier` is a problem made of the same facts, home and feeds, and some of these statements: its sites are taken
    over where what is new says nothing of candidates, and the moves that were looked at for it need not be looked at
    again where they are the same, and are not where it left them out. `going` is asked now and then, with the share of
    the moves that has been looked at; where it says no a soft rule about moves is left out. For a hard one it can only
    raise. Raises RulesConflict if the hard orders form a cycle, or a contour has no candidate left; InputError if costs
    could overflow, see `check_magnitude`.
    """
    kinds = by_kind(statements)
    contour_of = np.repeat(np.arange(facts.n), np.diff(facts.first)).tolist()
    lowered = lower_statements(statements, contour_of, LoweredStatements() if earlier is None else earlier.told)
    blocks = _blocks(facts.n, [g for g in kinds.contiguous if g.weight is None])
    orders = digest(lowered.pairs, blocks)
    before = (
        earlier.before if earlier is not None and earlier.orders == orders else close(facts.n, lowered.pairs, blocks)
    )
    if before.diagonal().any():
        raise _contradiction(before, [s for s in kinds.precede if s.weight is None])
    new = kinds
    if earlier is not None and _same_sites(statements, earlier):
        problem, new = _gone_on(earlier, lowered), by_kind(statements[len(earlier.told.statements) :])
    else:
        problem = _on_sites(facts, lowered, kinds, home_mm, feeds)
    problem = replace(
        problem,
        travel_weight=sum(s.weight for s in kinds.idle_travel),
        before=before,
        block=blocks,
        orders=orders,
        soft_groups=tuple(
            SoftGroup(g.contours, cost_um(g.weight), g.about) for g in kinds.contiguous if g.weight is not None
        ),
    )
    if new.lag or new.move:
        problem = _with_moves(problem, kinds)
    problem = _with_links(problem, kinds.link)
    problem = _with_crossings(problem, kinds.crossing, earlier, going)
    check_magnitude(problem)
    return problem


def _on_sites(
    facts: Facts, lowered: LoweredStatements, kinds: Kinds, home_mm: tuple[float, float], feeds: Feeds | None
) -> Problem:
    """Sites, and what is asked of them; nothing of orders yet."""
    allowed, costs = _candidate_costs(facts, kinds.forbid)
    candidate_site, chosen = sites_of(
        facts.candidates, allowed, costs, lowered.conditions, lowered.general, kinds.link, kinds.move
    )
    some = [facts.candidates[c] for c in chosen.tolist()]
    contours = np.array([c.contour for c in some], dtype=np.int64)
    return Problem(
        n=facts.n,
        first=np.searchsorted(contours, np.arange(facts.n + 1)).astype(np.int64),
        site_contour=contours,
        site_candidate=chosen,
        candidate_site=candidate_site,
        pierce_um=points_um([c.pierce for c in some], home_mm),
        end_um=points_um([c.end for c in some], home_mm),
        site_cost=costs[chosen] if len(chosen) else np.zeros(0, dtype=np.int64),
        home_um=points_um([home_mm], home_mm)[0],
        travel_weight=0.0,
        before=np.zeros((0, 0), dtype=np.bool_),
        block=np.zeros(0, dtype=np.int64),
        told=lowered,
        conditions=_on_site(lowered.conditions, candidate_site, chosen),
        soft_groups=(),
        lags=(),
        general=lowered.general,
        ids=tuple(c.id for c in facts.nest.contours),
        pace=Durations() if feeds is None else Durations.of(facts, chosen.tolist(), feeds),
    )


def _same_sites(statements: tuple[Statement, ...], earlier: Problem) -> bool:
    """Whether a problem of these statements has the sites of the earlier one, for what is new is about none of them."""
    known = earlier.told.statements
    if not starts_with(statements, known):
        return False
    new, old = by_kind(statements[len(known) :]), by_kind(known)
    by_entry = any(s.leaving is not None or s.reaching is not None for s in new.move)
    out_before = any(s.over is None for s in (*old.crossing, *new.crossing))
    return not (new.forbid or new.link or new.at_least or by_entry or out_before)


def _gone_on(earlier: Problem, lowered: LoweredStatements) -> Problem:
    """The sites and moves of an earlier problem with what is asked of them, and what is new of sites."""
    new = dict.fromkeys(lowered.conditions[len(earlier.told.conditions) :])
    at = {condition.contour for condition in new}
    known = {condition for condition in earlier.conditions if condition.contour in at}
    conditions = (*earlier.conditions, *(condition for condition in new if condition not in known))
    return replace(earlier, told=lowered, conditions=conditions, links=Links(), crossings=Crossings(), left_out=())


def _with_moves(problem: Problem, kinds: Kinds) -> Problem:
    """The lags, but for those of one cut; these and other statements about moves are prices of moves."""
    far, near = without_near_lags(kinds.lag)
    moves: tuple[Move, ...] = (*near, *kinds.move)
    prices = MovePrices.of(moves, problem.site_contour, problem.candidate_site, problem.n)
    return replace(problem, lags=far, moves=prices)


def _with_links(problem: Problem, statements: Sequence[Link]) -> Problem:
    """The links that cost less than idle travel, between contours that may follow each other.

    A lag in seconds keeps its two contours from being linked: a link leaves no time between them.
    """
    if not statements:
        return problem
    links = Links.of(statements, problem.candidate_site, problem.m)
    one, other = problem.site_contour[links.leave], problem.site_contour[links.reach]
    lawful = problem.followers().at(one, other) & (one != other)
    timed = np.array([(lag.first, lag.second) for lag in problem.lags if lag.seconds > 0]).reshape(-1, 2)
    for first, second in timed.tolist():
        lawful &= ~(((one == first) & (other == second)) | ((one == second) & (other == first)))
    idle = problem.legs(links.leave, links.reach) - problem.moves.price.each(links.leave, links.reach)
    return replace(problem, links=links.only(lawful & (links.cost < idle)))


def _with_crossings(problem: Problem, statements: Sequence[Crossing], earlier: Problem | None, going: Going) -> Problem:
    if not statements:
        return problem
    sites = np.append(problem.first, problem.m + 1)
    if any(s.over is None for s in statements):
        lawful, pierces = problem.followers(), problem.pierces()
        begun = [_not_first(problem, site, statements[k]) for site, k in from_home(statements, lawful, sites, pierces)]
        problem = replace(problem, conditions=(*problem.conditions, *begun))
    if earlier is not None and (earlier.left_out or _same_moves(problem, earlier)):
        return replace(problem, crossings=earlier.crossings, left_out=earlier.left_out)
    hard = any(s.weight is None for s in statements)
    lawful, ends, pierces = problem.followers(), problem.ends(), problem.pierces()
    try:
        key = (statements, problem.before, lawful, sites, ends, pierces)
        found = find_crossings(*key, (lambda share: going(share) or True) if hard else going)
    except TooManyMoves as error:
        if hard:
            raise
        return replace(problem, left_out=((statements[0].about.rule, error.message),))
    idle = problem.links.rows_of(found.leave, found.reach) < 0  # a link runs through waste, with the torch down
    return replace(problem, crossings=found if idle.all() else found.only(idle))


def _not_first(problem: Problem, site: int, statement: Crossing) -> Condition:
    """The torch does not come to a site from home: some contour is cut before."""
    contour = int(problem.site_contour[site])
    others = tuple(k for k in range(problem.n) if k != contour)
    cost = None if statement.weight is None else cost_um(statement.weight)
    return Condition(contour, others, (1,) * len(others), 1, statement.about, when=site, cost=cost)


def _same_moves(one: Problem, other: Problem) -> bool:
    """Whether the same sites may follow each other in both."""
    return (
        np.array_equal(one.site_candidate, other.site_candidate)
        and np.array_equal(one.links.leave, other.links.leave)
        and np.array_equal(one.links.reach, other.links.reach)
        and np.array_equal(one.before, other.before)
        and np.array_equal(one.block, other.block)
        and one.moves.statements == other.moves.statements
        and one.lags == other.lags
    )


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
    sentences = [p.about.sentence for p in hard if stuck[p.before] and stuck[p.after]]
    return RulesConflict("the order rules contradict each other", tuple(dict.fromkeys(sentences)))


def _candidate_costs(facts: Facts, forbidden: Sequence[Forbid]) -> tuple[Bools, Ints]:
    allowed = np.ones(len(facts.candidates), dtype=np.bool_)
    costs = np.zeros(len(facts.candidates), dtype=np.int64)
    reasons: dict[int, list[str]] = defaultdict(list)
    for s in forbidden:
        if s.weight is None:
            allowed[s.candidate] = False
            reasons[facts.candidates[s.candidate].contour].append(s.about.sentence)
        else:
            costs[s.candidate] += cost_um(s.weight)
    ways = np.diff(np.append(0, np.cumsum(allowed))[facts.first])
    for contour in np.flatnonzero(ways == 0).tolist():
        name = facts.nest.contours[contour].id
        raise RulesConflict(f"{name} has no lawful entry left", tuple(dict.fromkeys(reasons[contour])))
    return allowed, costs


def _on_site(conditions: Sequence[Condition], candidate_site: Ints, chosen: Ints) -> tuple[Condition, ...]:
    """Conditions on candidates as such on sites, each once.

    Candidates of one site are asked alike: what is asked of the one that it stands for counts, once.
    """
    site: list[int | None] = [None] * len(candidate_site)
    for number, candidate in enumerate(chosen.tolist()):
        site[candidate] = number
    found: dict[Condition, None] = {}
    for c in conditions:
        if c.when is None or site[c.when] == c.when:
            found[c] = None
        elif (when := site[c.when]) is not None:
            found[Condition(c.contour, c.members, c.weights, c.bound, c.about, when, c.cost)] = None
    return tuple(found)


# No sum overflows: what the dearest plan could cost is added up in Python's own integers before any engine begins.

MOST_UM = 10**14
"""100,000 km of idle travel: below it every engine's sums are exact, those in doubles included."""

MOST_COUNTED = 10**15
"""What the weights of one condition, and what it asks for, may come to: its engines add them up in 64 bits."""

TRAVEL = "objective.idle, objective.time and machine.home"


def dearest_um(problem: Problem, roughly: bool = False) -> dict[str, int]:
    """What a plan can cost at most, whole µm, not tight: of idle travel, and of each rule that has a price.

    `roughly`: with all conditions as one, though of the sites of a contour one alone is used.
    """
    found: dict[str, int] = defaultdict(int)
    found[TRAVEL] = (problem.n + 1) * _longest_um(problem)
    dearest = np.zeros(problem.n, dtype=np.int64)
    np.maximum.at(dearest, problem.site_contour, problem.site_cost)
    found["entries that a soft rule forbids"] += sum(dearest.tolist())
    if roughly:
        found["conditions"] += sum(filter(None, map(attrgetter("cost"), problem.conditions)))
    else:
        for rule, of_rule in _by_rule(problem.conditions).items():
            found[rule] += _dearest_of(problem, of_rule)
    for g in problem.soft_groups:
        found[g.about.rule] += g.cost * (len(g.contours) - 1)
    for lag in problem.lags:
        if lag.weight is not None:
            found[lag.about.rule] += cost_um(lag.weight) * lag.cuts + round(lag.weight) * round(lag.seconds * 1000)
    for move in problem.moves.statements:
        most = min(problem.n, len(move.leave), len(move.reach))  # each is left once, and reached once
        found[move.about.rule] += 0 if move.weight is None else cost_um(move.weight) * most
    for s in problem.general:
        found[s.about.rule] += 0 if s.weight is None else cost_um(s.weight)
    if len(problem.crossings):  # of the areas that a move crosses each is charged once
        found["idle travel over parts that are out"] += (
            (problem.n + 1) * problem.n * max(0, int(problem.crossings.cost.max()))
        )
    return dict(found)


def _by_rule(conditions: Sequence[Condition]) -> dict[str, list[Condition]]:
    found: dict[str, list[Condition]] = defaultdict(list)
    for condition in conditions:
        found[condition.about.rule].append(condition)
    return found


def _dearest_of(problem: Problem, conditions: Sequence[Condition]) -> int:
    """What breaking conditions of one rule can cost at most; of the sites of a contour one is used."""
    total, of_site = 0, dict[int, int]()
    for c in conditions:
        if c.when is None:
            total += c.cost or 0
        else:
            of_site[c.when] = of_site.get(c.when, 0) + (c.cost or 0)
    contours, of_contour = problem.site_contour.tolist(), dict[int, int]()
    for site, cost in of_site.items():
        of_contour[contours[site]] = max(of_contour.get(contours[site], cost), cost)
    return total + sum(of_contour.values())


def check_magnitude(problem: Problem) -> None:
    """Refuse a problem whose costs, or the weights of whose conditions, could overflow.

    Raises InputError if the dearest plan could cost more than `MOST_UM`; names what most of it comes from. If the
    weights of a condition come to more than `MOST_COUNTED`; names the rule and the contour.
    """
    statements: tuple[Condition | AtLeast, ...] = (*problem.conditions, *problem.general)
    for statement in () if _surely_counted(problem) else statements:
        if _counted(statement) > MOST_COUNTED:
            about = statement.about
            contours = f" of {', '.join(about.contours)}" if about.contours else ""
            raise InputError(
                f"rule {about.rule} counts what is asked{contours} by weights that come to {_counted(statement):.3g}, "
                f"more than can be counted exactly ({MOST_COUNTED:.0e}): make them, and what they must come to, smaller"
            )
    if sum(dearest_um(problem, roughly=True).values()) <= MOST_UM:
        return
    found = dearest_um(problem)
    if sum(found.values()) > MOST_UM:
        most = max(found, key=lambda name: found[name])
        key = most if most == TRAVEL else f"weight of {most}"
        raise InputError(
            f"a plan could cost {sum(found.values()) / 1e9:.3g} km of idle travel, more than can be counted exactly "
            f"({MOST_UM // 10**9:,} km), most of it by {key}: state less there"
        )


def _surely_counted(problem: Problem) -> bool:
    """Whether nothing comes near what can be counted: told of all weights and bounds together."""
    if problem.general:
        return False
    of_each = list(map(attrgetter("weights"), problem.conditions))
    weights, bounds = set(chain.from_iterable(of_each)), set(map(attrgetter("bound"), problem.conditions))
    most = max(map(abs, weights), default=0) * max(map(len, of_each), default=0)
    return most + max(map(abs, bounds), default=0) <= MOST_COUNTED


def _counted(statement: Condition | AtLeast | Enough) -> int:
    """What the weights of a condition, those in it and what it asks for come to at most."""
    within = () if isinstance(statement, Condition) else statement.literals
    inner = max((_counted(literal) for literal in within if isinstance(literal, Enough)), default=0)
    return max(inner, sum(map(abs, statement.weights)) + abs(statement.bound))


def _longest_um(problem: Problem) -> int:
    """No move costs more."""
    if problem.matrix is not None:
        return max(map(abs, map(int, (problem.matrix.min(), problem.matrix.max())))) if problem.matrix.size else 0
    points = np.vstack([problem.ends(), problem.pierces()]).astype(np.float64)
    return int(problem.travel_weight * float(np.linalg.norm(np.ptp(points, axis=0)))) + 1
