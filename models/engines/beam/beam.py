"""A beam over ideals that widens until nothing is dropped (Libralesso et al. 2020; Kuroiwa and Beck's CABS)."""

from __future__ import annotations

from dataclasses import dataclass, field

from kerfwise.models.engines.budget import Budget
from kerfwise.models.engines.solution import Incumbent, Progress
from kerfwise.models.problem.bits import words
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem

from .widening import OPERATIONS_PER_S, Empty, Widening

FIRST_WIDTH = 16
MOST_BYTES = 1_500_000_000


@dataclass(frozen=True, slots=True)
class BeamResult:
    """The best route known, and what is proven.

    `bound` is a lower bound for the whole problem, µm, None where nothing is known. With `proven` the incumbent is
    the best there is, or no lawful route exists where it is None. `work` is what was spent, in deterministic seconds,
    `width` how wide the last whole run was.
    """

    incumbent: Incumbent | None
    bound: int | None = None
    proven: bool = False
    interrupted: bool = False
    work: float = field(default=0.0, compare=False)
    width: int = 0


def beam(
    problem: Problem,
    incumbent: Incumbent | None = None,
    work: float = 30.0,
    time_s: float | None = None,
    progress: Progress | None = None,
    first_width: int = FIRST_WIDTH,
    last_width: int | None = None,
    most_bytes: float = MOST_BYTES,
) -> BeamResult:
    """Run beams, each twice as wide as the last, until the best route is proven or a limit is reached.

    Parameters
    ----------
    problem
        One that `applies` is true of.
    incumbent
        A lawful route: states that cannot lead to a cheaper one are left out.
    work
        Deterministic limit, in seconds or so of the machine that `widening.OPERATIONS_PER_S` was measured on.
    time_s
        Wall-clock limit, s; whichever of the two is reached first counts.
    progress
        Asked once a layer whether to go on.
    first_width, last_width
        States a layer to begin with, and at the most; without the latter, as many as fit in the bytes.
    most_bytes
        What the tables may take.
    """
    budget = Budget(work, time_s, OPERATIONS_PER_S)
    if problem.n == 0:
        return BeamResult(Incumbent((), route_cost(problem, ())), route_cost(problem, ()), True)
    widening = Widening(problem, incumbent, budget, progress)
    interrupted = False
    try:
        widening.run(first_width, most_states(problem, most_bytes) if last_width is None else last_width)
    except Empty:
        pass
    except KeyboardInterrupt:
        interrupted = True
    return BeamResult(widening.incumbent, widening.bound, widening.proven, interrupted, budget.spent, widening.width)


def most_states(problem: Problem, most_bytes: float = MOST_BYTES) -> int:
    """How wide a beam fits in so many bytes, or in `MOST_BYTES`: children in two rooms, and two layers of sets."""
    a_state = 2 * 2 * 28 + 3 * 28 + 2 * (16 * words(problem.n) + 60) + 16
    return int(min(most_bytes, MOST_BYTES) // a_state)
