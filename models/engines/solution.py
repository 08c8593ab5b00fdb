"""What is asked of an engine, and what it answers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

from kerfwise.models.physics.timing.constant import Feeds

from .names import Member

Status = Literal["optimal", "feasible"]


@dataclass(frozen=True, slots=True)
class SolveOptions:
    """Limits of a solve.

    `work` is deterministic: about as many seconds as this machine class needs, but counted in iterations and
    CP-SAT's deterministic time, so that the same input gives the same plan. `time_s`, if given, is wall-clock time
    and cuts the work short. `gap` is a share of the objective: a plan proven to be that close to the best is good
    enough. `no_improvement_s` is how long, s, a plan may stay the best known before it is taken. `member` names the
    one member of the portfolio that is to run, None lets it choose. `feeds` are needed where rules count seconds.
    """

    seed: int = 1
    work: float = 30.0
    time_s: float | None = None
    home_mm: tuple[float, float] = (0.0, 0.0)
    feeds: Feeds | None = None
    gap: float | None = None
    no_improvement_s: float | None = None
    member: Member | None = None


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
