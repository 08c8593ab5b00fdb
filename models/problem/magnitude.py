"""No sum overflows: what the dearest plan could cost is added up in Python's own integers before any engine begins."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from itertools import chain
from operator import attrgetter

import numpy as np

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.microns import cost_um
from kerfwise.rules.statements import AtLeast, Enough

from .conditions import Condition
from .problem import Problem

MOST_UM = 10**14
"""100,000 km of idle travel: below it every engine's sums are exact, those in doubles included."""

MOST_COUNTED = 10**15
"""What the weights of one condition, and what it asks for, may come to: its engines add them up in 64 bits."""

TRAVEL = "objective.idle, objective.time and machine.home"


def dearest_um(problem: Problem) -> dict[str, int]:
    """What a plan can cost at most, whole µm, not tight: of idle travel, and of each rule that has a price."""
    found: dict[str, int] = defaultdict(int)
    found[TRAVEL] = (problem.n + 1) * _longest_um(problem)
    dearest = np.zeros(problem.n, dtype=np.int64)
    np.maximum.at(dearest, problem.site_contour, problem.site_cost)
    found["entries that a soft rule forbids"] += sum(dearest.tolist())
    for rule, of_rule in _by_rule(problem.conditions).items():
        found[rule] += _dearest_of(problem, of_rule)
    for g in problem.soft_groups:
        found[g.about.rule] += g.cost * (len(g.contours) - 1)
    for lag in problem.lags:
        if lag.weight is not None:
            found[lag.about.rule] += cost_um(lag.weight) * lag.cuts + round(lag.weight) * round(lag.seconds * 1000)
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

    Raises
    ------
    InputError
        If the dearest plan could cost more than `MOST_UM`; names what most of it comes from. If the weights of a
        condition come to more than `MOST_COUNTED`; names the rule and the contour.
    """
    given: tuple[Condition | AtLeast, ...] = (*problem.conditions, *problem.general)
    for asked in () if _surely_counted(problem) else given:
        if _counted(asked) > MOST_COUNTED:
            about = asked.about
            contours = f" of {', '.join(about.contours)}" if about.contours else ""
            raise InputError(
                f"rule {about.rule} counts what is asked{contours} by weights that come to {_counted(asked):.3g}, more "
                f"than can be counted exactly ({MOST_COUNTED:.0e}): make them, and what they must come to, smaller"
            )
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


def _counted(asked: Condition | AtLeast | Enough) -> int:
    """What the weights of a condition, those in it and what it asks for come to at most."""
    within = () if isinstance(asked, Condition) else asked.literals
    inner = max((_counted(literal) for literal in within if isinstance(literal, Enough)), default=0)
    return max(inner, sum(map(abs, asked.weights)) + abs(asked.bound))


def _longest_um(problem: Problem) -> int:
    """No move costs more."""
    if problem.matrix is not None:
        return max(map(abs, map(int, (problem.matrix.min(), problem.matrix.max())))) if problem.matrix.size else 0
    points = np.vstack([problem.ends(), problem.pierces()]).astype(np.float64)
    return int(problem.travel_weight * float(np.linalg.norm(np.ptp(points, axis=0)))) + 1
