"""What is asked of an engine, and what it answers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

from kerfwise.models.physics.timing.constant import Feeds

from .names import Member

Status = Literal["optimal", "feasible"]
MEMORY_GB = 2.0
"""What a solve may hold where nobody says more or less."""
BYTES_PER_GB = 1e9
BESIDE_GB, LEAST_SHARE = 0.4, 0.2
"""What libraries, nest and problem take beside the tables of engines; and the share that is left for those anyway."""


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
    work: float = 30.0
    time_s: float | None = None
    home_mm: tuple[float, float] = (0.0, 0.0)
    feeds: Feeds | None = None
    gap: float | None = None
    no_improvement_s: float | None = None
    member: Member | None = None
    memory_gb: float = MEMORY_GB


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


class Progress(Protocol):
    """Called now and then by an engine; returns False to ask it to stop with what it has."""

    def __call__(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool: ...


Stop = Callable[[], bool]
