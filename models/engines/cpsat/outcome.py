"""What CP-SAT answers."""

from __future__ import annotations

from dataclasses import dataclass

from kerfwise.models.engines.solution import Incumbent


@dataclass(frozen=True, slots=True)
class CpsatOutcome:
    """The best route known, and what is proven.

    `bound` is a lower bound for the whole problem, µm (None where nothing was proven); `interrupted` says that Ctrl-C
    ended the search; `work` is what the solver took of its limit.
    """

    incumbent: Incumbent | None
    bound: int | None = None
    proven_optimal: bool = False
    infeasible: bool = False
    interrupted: bool = False
    work: float = 0.0
