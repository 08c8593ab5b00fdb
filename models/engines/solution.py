"""What is asked of an engine, what it answers, what it needs to set up, and when it stops."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal, TypedDict

import numpy as np

from kerfwise.models.engines.tuning import (
    ARCS_LISTED_PER_S,
    ARCS_PER_S,
    BESIDE_GB,
    BYTES_A_ROW,
    FLOWS_ROWS_PER_S,
    FREE,
    LEAST_SHARE,
    LOOKED_PER_S,
    MADE_PER_S,
    MAX_ARCS,
    MEMORY_GB,
    PAIRS_PER_S,
)
from kerfwise.models.engines.tuning import REQUEST_WORK as WORK
from kerfwise.models.engines.tuning import SOLUTION_ROWS_PER_S as ROWS_PER_S
from kerfwise.models.physics.motion import Feeds
from kerfwise.models.problem.problem import Problem

from . import Engine, Member

Status = Literal["optimal", "feasible"]
BYTES_PER_GB = 1e9


def table_bytes(memory_gb: float, held_bytes: float = 0.0) -> float:
    """How many bytes the tables of engines that run at the same time may take, of so much memory in all.

    `held_bytes` are taken by what is held beside them, above what every problem takes.

    Examples
    --------
    >>> table_bytes(2.0), table_bytes(0.4), table_bytes(2.0, 6e8)
    (1600000000.0, 80000000.0, 1000000000.0)
    """
    held_gb = BESIDE_GB + held_bytes / BYTES_PER_GB
    return round(max(memory_gb - held_gb, LEAST_SHARE * memory_gb) * BYTES_PER_GB, 0)


TABLE_BYTES = table_bytes(MEMORY_GB)
"""How many bytes where nobody says more or less."""


@dataclass(frozen=True, slots=True)
class SolveOptions:
    """Limits of a solve.

    `work` is deterministic: about as many seconds as this machine class needs, but counted in iterations and
    CP-SAT's deterministic time, so that the same input gives the same plan. `time_s`, if given, is wall-clock time
    and cuts the work short. `gap` is a share of the objective: a plan proven to be that close to the best is good
    enough. `no_improvement_s` is how long, s, a plan may stay the best known before it is taken. `member` names the
    one member of the portfolio that is to run, None lets it choose. `feeds` are needed where rules count seconds.
    `memory_gb` is what the process may hold: it limits the tables of the members that keep sets, less what is held
    beside them; not CP-SAT, and not linear programs.
    """

    seed: int = 1
    work: float = WORK
    time_s: float | None = None
    home_mm: tuple[float, float] = (0.0, 0.0)
    feeds: Feeds | None = None
    gap: float | None = None
    no_improvement_s: float | None = None
    member: Member | None = None
    memory_gb: float = MEMORY_GB


class Limits(TypedDict, total=False):
    """Limits of a solve as they are asked for, by name; `SolveOptions` says what they mean. `engine` gives `member`."""

    work: float
    time_s: float | None
    seed: int
    gap: float | None
    no_improvement_s: float | None
    memory_gb: float
    engine: Engine


@dataclass(frozen=True, slots=True)
class Incumbent:
    """A lawful route (sites in cutting order) and its cost, µm."""

    route: tuple[int, ...]
    cost: int


@dataclass(frozen=True, slots=True)
class Solution:
    """The best route found, as candidate numbers in cutting order.

    `objective` and `bound` are in mm; `bound` is None unless proven for the whole model. `seconds` is wall-clock time
    under a time limit, else the deterministic work spent, so that the same input gives the same plan to the byte.
    `notes` say which members of the portfolio ran, which did not, and why.
    `left_out` are soft rules that objective and bound say nothing of, because the nest is too large, and why.
    `problem` is what was solved, with all that geometry has found, where it is at hand.
    """

    route: tuple[int, ...]
    objective: float
    bound: float | None
    status: Status
    found_by: str
    proved_by: str
    seconds: float
    notes: tuple[str, ...] = ()
    left_out: tuple[tuple[str, str], ...] = ()
    problem: Problem | None = field(default=None, compare=False, repr=False)


# What it takes an engine to make its tables, or its model, of a problem: before that it finds and proves nothing.
#
# Deterministic seconds, worked out from sizes alone: measured on nests of 60 to 308 contours and on routing instances
# of 17 to 699.


def crossed_bytes(problem: Problem) -> int:
    """What crossings take, with the tables that any engine makes of them: large nests without zones have millions."""
    return problem.crossings.nbytes + BYTES_A_ROW * len(problem.crossings)


def count_site_arcs(problem: Problem) -> int:
    """How many arcs between sites there are at most, home's included."""
    sites = np.append(np.diff(problem.first), 1)
    return int(sites @ problem.followers().weighed(sites))


def cpsat_s(problem: Problem) -> float:
    """Of CP-SAT's model."""
    arcs, pairs = count_site_arcs(problem), int(problem.followers().weighed(np.ones(problem.n + 1, np.int64)).sum())
    if arcs > MAX_ARCS:
        return math.inf
    return arcs / ARCS_LISTED_PER_S + len(problem.crossings) / ROWS_PER_S + arcs / ARCS_PER_S + pairs / PAIRS_PER_S


def simplex_round_s(contours: int, sites: int, cuts: int) -> float:
    """What a round of the simplex method takes in a program of so many sites, with so many cuts."""
    return (contours + sites + 2 + cuts) * min(1.0, FREE + cuts / (2 * contours)) / FLOWS_ROWS_PER_S


def look_s(moves: int) -> float:
    """What a look at so many moves takes."""
    return moves / LOOKED_PER_S


def made_s(moves: int) -> float:
    """What it takes to work out what so many moves cost."""
    return moves / MADE_PER_S


def flows_s(contours: int, sites: int) -> float:
    """About how many deterministic seconds the first bound takes, that of a program without cuts.

    Such a program takes about three rounds of the simplex method for every site, twice, and two looks at all moves.
    """
    rows = contours + sites
    return made_s(sites**2) + 2 * look_s(sites**2) + 6 * sites * rows * FREE / FLOWS_ROWS_PER_S
