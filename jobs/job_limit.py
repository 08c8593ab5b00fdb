"""The seconds of one job: those of its planning alone, or of the command that it is part of."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

from kerfwise.models.engines.solution import Progress, SolveOptions
from kerfwise.models.kernels import compiled_s, made_s, running_s

from .given import Tell
from .whole_limit import LEAST_SHARE, Took, WholeLimit

SAID_S = 5.0
"""What takes longer beside a limit in seconds is told."""


class JobLimit(Protocol):
    """What a job asks of its limit, in this order; made when the job begins."""

    def facts_made(self, took: Took) -> SolveOptions:
        """The limits for stating the rules: the facts are there, and what finding them took."""

    def stated(self, took: Took) -> SolveOptions:
        """The limits for the planning: the rules are stated."""

    def watched(self, progress: Progress) -> Progress:
        """Asks `progress`, and says stop where the seconds are over, whatever the engines count."""

    def without_plan(self) -> SolveOptions:
        """The limits for finding what contradicts what, in place of a plan."""

    def ended(self, judging_s: float) -> None:
        """Say what the limit did not count: the plan is judged, which took so many seconds."""


class PlanningLimit:
    """The limits of a planning alone; what takes long beside one in seconds is told."""

    def __init__(self, limits: SolveOptions, tell: Tell) -> None:
        self._limits, self._tell = limits, tell
        self._began_s, self._before_s = running_s(), made_s()
        self._left_s = limits.time_s

    def facts_made(self, took: Took) -> SolveOptions:
        self._not_counted("the facts of the nest", running_s() - self._began_s)
        self._began_s = running_s()
        return self._limits

    def stated(self, took: Took) -> SolveOptions:
        limit_s = self._limits.time_s
        if limit_s:  # stating the rules is inside the limit; a plan gets its share all the same
            self._left_s = max(limit_s - (running_s() - self._began_s), LEAST_SHARE * limit_s)
        self._began_s = running_s()
        return replace(self._limits, time_s=self._left_s)

    def watched(self, progress: Progress) -> Progress:
        return progress

    def without_plan(self) -> SolveOptions:
        return self._limits

    def ended(self, judging_s: float) -> None:
        _tell_compiled(made_s() - self._before_s, self._limits, self._tell)
        over_s = running_s() - self._began_s - judging_s - (self._left_s or 0.0)
        self._not_counted("ending the planning", over_s)
        self._not_counted("writing and checking the program", judging_s)

    def _not_counted(self, what: str, took_s: float) -> None:
        if self._limits.time_s and took_s > SAID_S:
            self._tell(f"{what} took {took_s:.0f} s, which the limit does not count")


class CommandLimit:
    """The limits of a job within a command that has a limit of its own, which counts all but compiling."""

    def __init__(self, whole: WholeLimit, limits: SolveOptions, tell: Tell) -> None:
        self._whole, self._limits, self._tell = whole, limits, tell
        self._before_s = compiled_s()

    def facts_made(self, took: Took) -> SolveOptions:
        return self._whole.begin(self._limits, took)

    def stated(self, took: Took) -> SolveOptions:
        limits = self._whole.begin(self._limits, took)
        if told := self._whole.too_short(took):
            self._tell(told)
        return limits

    def watched(self, progress: Progress) -> Progress:
        return self._whole.watched(progress)

    def without_plan(self) -> SolveOptions:
        return replace(self._limits, time_s=self._whole.left_s())

    def ended(self, judging_s: float) -> None:
        self._whole.end(judging_s)
        _tell_compiled(compiled_s() - self._before_s, replace(self._limits, time_s=self._whole.limit_s), self._tell)


def _tell_compiled(took_s: float, limits: SolveOptions, tell: Tell) -> None:
    if (limits.time_s or limits.no_improvement_s) and took_s > SAID_S:
        tell(f"kernels were compiled, which is done once: {took_s:.0f} s, not counted by the limit")
