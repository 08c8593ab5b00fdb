"""The same problem, smaller: conditions that the hard orders decide, and sites that no plan needs.

Rules about how a contour is cut (which way round, what the tail faces) come as many conditions, most of them decided
by the orders alone. Once those are folded into what a site costs, sites with the same pierce and end often differ in
nothing but that cost, and the dearer ones can go.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from kerfwise.arrays import Bools, Floats, Int32s, Ints
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.geometry.tolerances import cost_um
from kerfwise.rules.statements import EXEMPTION_MM, AtLeast, Link, Move, Pick, plain

from .bitsets import LastAnswer
from .conditions import Condition, ConditionRows, starts_with
from .crossings import Crossings
from .problem import Links, Problem


def without_wishes(problem: Problem) -> Problem | None:
    """The problem without wishes that reach over the whole order; None where there are none.

    These are soft runs, soft lags, and soft sums of sums or of entries: they tie
    zones together and leave sweeps too many sets. Sites, hard statements and excuses from them are the same, so a plan
    is lawful with the wishes, too, and a bound is one of the problem.
    """

    def stays(weight: float | None) -> bool:
        return weight is None or weight >= EXEMPTION_MM

    lags = tuple(lag for lag in problem.lags if stays(lag.weight))
    general = tuple(s for s in problem.general if stays(s.weight))
    groups = tuple(group for group in problem.soft_groups if group.cost >= cost_um(EXEMPTION_MM))
    if (len(lags), len(general), len(groups)) == (len(problem.lags), len(problem.general), len(problem.soft_groups)):
        return None
    return replace(problem, lags=lags, general=general, soft_groups=groups)


def simplify(problem: Problem) -> Problem:
    """A problem with the same optimum; every route of it is a route of the given one at the same cost."""
    decided, unlawful = _decided(problem)
    needed = ~_spare(decided, unlawful)
    for i in range(problem.n):
        sites = slice(problem.first[i], problem.first[i + 1])
        if not needed[sites].any():  # every site is unlawful: an engine is to find that out
            needed[sites] = True
    return _with_sites(decided, needed)


def _decided(problem: Problem) -> tuple[Problem, Bools]:
    """The problem without conditions that are always met, or soft and never met; and the sites never lawful."""
    unlawful = np.zeros(problem.m, dtype=np.bool_)
    more = [0] * problem.m
    left: list[Condition] = []
    for rest, can_be_met in _undecided(problem):
        if can_be_met:
            left.append(rest)
            continue
        sites = problem.sites(rest.contour) if rest.when is None else (rest.when,)
        if rest.cost is None:
            left.append(rest)
            unlawful[list(sites)] = True
        else:
            for site in sites:
                more[site] += rest.cost
    cost = problem.site_cost + np.array(more, dtype=np.int64)
    return replace(problem, conditions=tuple(left), site_cost=cost), unlawful


_Undecided = tuple[tuple[Condition, bool], ...]
_last = LastAnswer[tuple[tuple[Condition, ...], _Undecided]]()


def _undecided(problem: Problem) -> _Undecided:
    """Conditions on the members of which no hard order says whether they are out before, and whether they can be met.

    Those that are always met are left out. What a round of a solve adds is looked at alone.
    """
    known, found = _last.known(problem.before, b"") or ((), ())
    if not starts_with(problem.conditions, known):
        known, found = (), ()
    found = (*found, *_undecided_of(problem, problem.conditions[len(known) :]))
    _last.keep(problem.before, b"", (problem.conditions, found))
    return found


def _undecided_of(problem: Problem, conditions: Sequence[Condition]) -> Iterator[tuple[Condition, bool]]:
    """The same of some of its conditions."""
    if not conditions:
        return
    rows = ConditionRows.of(conditions)
    members, weights, contours = rows.member, rows.weight, rows.contour[rows.row]
    until = np.searchsorted(rows.row, np.arange(1, len(conditions) + 1))
    out = problem.before[members, contours]
    free = ~out & (members != contours) & ~problem.before[contours, members] & (weights != 0)

    def summed(values: Ints) -> Ints:
        return np.asarray(np.diff(np.append(0, np.cumsum(values))[until], prepend=0))

    bounds = rows.bound - summed(np.where(out, weights, 0))
    least, most = (summed(np.where(free, some(weights, 0), 0)) for some in (np.minimum, np.maximum))
    counts = summed(free.astype(np.int64))
    chosen = np.flatnonzero(least < bounds)
    free_until, free_members, free_weights = np.cumsum(counts), members[free].tolist(), weights[free].tolist()
    columns = (chosen, bounds[chosen], (most >= bounds)[chosen], counts[chosen], free_until[chosen])
    for k, bound, can_be_met, count, end in zip(*(column.tolist() for column in columns), strict=True):
        c = conditions[k]
        if count < len(c.members):
            row = slice(end - count, end)
            kept = tuple(free_members[row]), tuple(free_weights[row])
            c = Condition(c.contour, *kept, bound, c.about, c.when, c.cost)
        yield c, can_be_met


def _spare(problem: Problem, unlawful: Bools) -> Bools:
    """Sites that are never lawful, or for which another with the same pierce and end is never worse."""
    spare = unlawful.copy()
    groups = _alike(problem)
    compared = np.zeros(problem.m + 1, dtype=np.bool_)
    compared[[s for sites in groups for s in sites]] = True
    counts = _conditions_by_site(problem, compared)
    crossings, links, timed = problem.crossings, problem.links, _timed(problem)
    crossed = _moves_by_site(crossings, crossings.over, crossings.cost, compared)
    linked = _moves_by_site(links, links.cost, links.ms, compared)  # cheaper than idle travel: none makes a site worse
    for sites in groups:
        for s in sites:
            for t in sites:
                if t == s or spare[t] or _has_more(crossed, t, s) or _has_more(linked, s, t):
                    continue
                if timed and _has_more(linked, t, s):  # it would change when others are cut
                    continue
                more = counts[t] - counts[s]
                costs = [cost for _, _, _, cost in more.elements()]
                dearest = sum(cost for cost in costs if cost is not None) + int(problem.site_cost[t])
                if None not in costs and dearest <= problem.site_cost[s]:
                    spare[s] = True
                    break
    return spare


def _alike(problem: Problem) -> list[list[int]]:
    """Sites that can be compared, in groups of at least two."""
    named = _named(problem)
    timed = _timed(problem)
    groups: dict[object, list[int]] = defaultdict(list)
    for s in range(problem.m) if problem.matrix is not None else duplicate_rows(_places(problem, timed)):
        if s not in named:
            groups[_place(problem, s, timed)].append(s)
    return [sites for sites in groups.values() if len(sites) > 1]


def _places(problem: Problem, timed: bool) -> list[Ints]:
    """As `_place`, of all sites, where there is no matrix: columns."""
    price = problem.moves.price
    columns = [problem.site_contour, *problem.pierce_um.T, *problem.end_um.T]
    columns += [price.row[:-1], price.column[:-1]] if len(price) else []
    return [*columns, problem.pace.cut_ms] if timed else columns


def _timed(problem: Problem) -> bool:
    """Whether it counts how long cuts take."""
    return any(lag.seconds > 0 for lag in problem.lags) and len(problem.pace.cut_ms) > 0


def _place(problem: Problem, site: int, timed: bool) -> object:
    """What two sites must share to be compared: contour, pierce, end, prices of moves, and the time where it counts."""
    price = problem.moves.price
    if problem.matrix is None:
        reached, left = problem.pierce_um[site].tobytes(), problem.end_um[site].tobytes()
        if len(price):
            reached, left = reached + price.column[site].tobytes(), left + price.row[site].tobytes()
    else:
        reached, left = problem.matrix[:, site].tobytes(), problem.matrix[site].tobytes()
    return (
        int(problem.site_contour[site]),
        reached,
        left,
        int(problem.pace.cut_ms[site]) if timed else 0,
    )


def _named(problem: Problem) -> set[int]:
    """Sites that general statements are about."""
    candidates = {lit.c for s in problem.general for lit in plain(s.literals) if isinstance(lit, Pick)}
    candidates |= {s.when for s in problem.general if s.when is not None}
    return {int(problem.candidate_site[c]) for c in candidates} - {-1}


def _conditions_by_site(
    problem: Problem, compared: Bools
) -> dict[int, Counter[tuple[object, object, int, int | None]]]:
    counts: dict[int, Counter[tuple[object, object, int, int | None]]] = defaultdict(Counter)
    for c in problem.conditions:
        if c.when is not None and compared[c.when]:
            counts[c.when][c.members, c.weights, c.bound, c.cost] += 1
    return counts


def _moves_by_site(
    moves: Crossings | Links, one: Ints | Int32s, other: Ints, compared: Bools
) -> dict[int, tuple[Ints, ...]]:
    """The moves of each site that is compared: the other site (below 0: to it) and two columns, in one order."""
    found: dict[int, list[Ints]] = {site: [] for site in np.flatnonzero(compared).tolist()}
    for here, there, to in ((moves.leave, moves.reach, False), (moves.reach, moves.leave, True)):
        rows = np.flatnonzero(compared[here])
        rows = rows[np.argsort(here[rows], kind="stable")]
        sites, begin = np.unique(here[rows], return_index=True)
        place = there[rows].astype(np.int64)
        table = np.stack((~place if to else place, one[rows], other[rows]))
        pieces = np.split(table, begin[1:], axis=1) if len(rows) else []
        for site, columns in zip(sites.tolist(), pieces, strict=True):
            found[site].append(columns)
    none = np.zeros((3, 0), dtype=np.int64)
    tables = {site: np.concatenate((none, *columns), axis=1) for site, columns in found.items()}
    return {site: tuple(table[:, np.lexsort(table)]) for site, table in tables.items()}


def _has_more(moves: dict[int, tuple[Ints, ...]], site: int, than: int) -> bool:
    """Whether a site has a move oftener than another."""
    of, others = moves[site], moves[than]
    if all(np.array_equal(column, other) for column, other in zip(of, others, strict=True)):
        return False
    counts, beside = (Counter(zip(*(c.tolist() for c in columns), strict=True)) for columns in (of, others))
    return not counts <= beside


def _with_sites(problem: Problem, kept: Bools) -> Problem:
    """The problem with these sites alone, numbered anew."""
    if kept.all():
        return problem
    number = np.append(np.where(kept, np.cumsum(kept) - 1, -1), kept.sum())  # the last is home
    contours = problem.site_contour[kept]
    timed = len(problem.pace.cut_ms) > 0
    return replace(
        problem,
        first=np.searchsorted(contours, np.arange(problem.n + 1)).astype(np.int64),
        site_contour=contours,
        site_candidate=problem.site_candidate[kept],
        candidate_site=np.where(problem.candidate_site >= 0, number[problem.candidate_site], -1),
        pierce_um=problem.pierce_um[kept],
        end_um=problem.end_um[kept],
        site_cost=problem.site_cost[kept],
        conditions=tuple(
            c if c.when is None else replace(c, when=int(number[c.when]))
            for c in problem.conditions
            if c.when is None or kept[c.when]
        ),
        crossings=problem.crossings.renumbered(number),
        links=problem.links.renumbered(number[:-1], int(kept.sum())),
        moves=problem.moves.of_sites(np.flatnonzero(np.append(kept, True))),
        pace=replace(problem.pace, cut_ms=problem.pace.cut_ms[kept]) if timed else problem.pace,
        matrix=None if problem.matrix is None else problem.matrix[np.ix_(np.append(kept, True), np.append(kept, True))],
    )


# Candidates become sites: those of a contour that nothing tells apart, with the same pierce and end, are one.


def sites_of(
    candidates: Sequence[Candidate],
    allowed: Bools,
    costs: Ints,
    conditions: Sequence[Condition],
    general: Sequence[AtLeast],
    links: Sequence[Link] = (),
    moves: Sequence[Move] = (),
) -> tuple[Ints, Ints]:
    """The site of every candidate, -1 of one that is not `allowed`, and the candidate that each site stands for.

    A site stands for the first of its candidates, and sites are numbered as these are. `costs` are what candidates
    cost by themselves; the rest are the statements that may be about single candidates.
    """
    leader, lawful = np.arange(len(candidates)), np.flatnonzero(allowed).tolist()
    if alike := [lawful[k] for k in duplicate_rows(_site_places([candidates[c] for c in lawful]))]:
        told_apart = _told_apart(frozenset(alike), conditions, general, links, moves)
        first: dict[object, int] = {}
        for number in alike:
            candidate = candidates[number]
            key = (int(costs[number]), *told_apart[number])
            leader[number] = first.setdefault((candidate.contour, candidate.pierce, candidate.end, key), number)
    leads = allowed & (leader == np.arange(len(candidates)))
    site = np.cumsum(leads) - 1
    return np.where(allowed, site[leader], -1), np.flatnonzero(leads)


def duplicate_rows(columns: Sequence[Ints | Floats]) -> list[int]:
    """The rows that are in all columns (k,) like some other row, in rising order.

    Examples
    --------
    >>> duplicate_rows([np.array([1, 2, 1, 1]), np.array([5, 5, 5, 6])])
    [0, 2]
    """
    order = np.lexsort(columns)
    same = np.ones(max(len(order) - 1, 0), dtype=np.bool_)
    for column in columns:
        same &= column[order[1:]] == column[order[:-1]]
    shared = np.append(False, same) | np.append(same, False) if len(order) else same
    found: list[int] = np.sort(order[shared]).tolist()
    return found


def _site_places(candidates: Sequence[Candidate]) -> list[Ints | Floats]:
    """Contours, pierces and ends."""
    ends = ([c.pierce for c in candidates], [c.end for c in candidates])
    contours = np.array([c.contour for c in candidates], dtype=np.int64)
    return [contours, *(axis for points in ends for axis in np.array(points, dtype=np.float64).reshape(-1, 2).T)]


def _told_apart(
    numbers: frozenset[int],
    conditions: Sequence[Condition],
    general: Sequence[AtLeast],
    links: Sequence[Link],
    moves: Sequence[Move],
) -> dict[int, list[object]]:
    """What is said of each of these candidates."""
    found: dict[int, list[object]] = defaultdict(list)
    for condition in conditions:
        if condition.when in numbers:
            found[condition.when].append((condition.members, condition.weights, condition.bound, condition.cost))
    for number, s in enumerate(general):
        for c in numbers & ({lit.c for lit in plain(s.literals) if isinstance(lit, Pick)} | {s.when}):
            found[c].append(number)
    ends = [(s.leave, s.reach) for s in links] + [(s.leaving or (), s.reaching or ()) for s in moves]
    for number, of in enumerate(ends):
        for end, some in zip(("leave", "reach"), of, strict=True):
            for c in numbers.intersection(some):
                found[c].append((end, number))
    return found
