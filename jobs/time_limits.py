"""The seconds of a whole command and of its planning: what is left, and what is kept for all that comes after."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.tuning import CHECKED, ENDED_S, PLANNED, SAID_S, TOLD_S
from kerfwise.models.engines.tuning import LIMITS_LEAST_SHARE as LEAST_SHARE
from kerfwise.models.jit import compiled_s, counted_s, made_s, running_s

from .inputs import Tell

# What comes before the planning has been measured when it begins. What comes after takes about so many times as long
# as it took to find candidates on the same nest: both look at every outline of the drawing. A picture that is drawn
# beside the check counts only where it takes longer than that.

DRAWN = {".svg": (1.5, 0.0), ".png": (2.5, 0.5), ".pdf": (3.5, 0.6), ".html": (2.5, 7.0)}
"""The same for a picture, by its suffix: so many times as long, and so many seconds."""


class JobLimit:
    """The limits of a job, of which one in seconds counts its planning alone: what takes long beside that is told.

    A job asks for its limits at each of its steps, in the order of the methods. It notes in `candidates_s` how long
    finding candidates took, s.
    """

    def __init__(self) -> None:
        self.candidates_s = 0.0
        self._left_s: float | None = None

    def begin(self, limits: SolveOptions, tell: Tell) -> None:
        """The job begins, under these limits; `tell` is told what the limit does not count."""
        self._limits, self._tell = limits, tell
        self._compiled_s = self.compiled_s()
        self._step_s = running_s()

    def seconds(self) -> float | None:
        """What the job may take from here on, s; None where nothing is said."""
        return self._limits.time_s

    def facts_made(self) -> SolveOptions:
        """The limits for stating the rules: the facts are there."""
        self._not_counted("the facts of the nest", running_s() - self._step_s)
        self._step_s, self._left_s = running_s(), self._limits.time_s
        return self._limits

    def stated(self) -> SolveOptions:
        """The limits for the planning: the rules are stated, within the limit; a plan gets its share all the same."""
        if limit_s := self._limits.time_s:
            self._left_s = max(limit_s - (running_s() - self._step_s), LEAST_SHARE * limit_s)
        self._step_s = running_s()
        return replace(self._limits, time_s=self._left_s)

    def watched(self, progress: Progress) -> Progress:
        """Asks `progress`, and says stop where the seconds are over, whatever the engines count."""
        return progress

    def without_plan(self) -> SolveOptions:
        """The limits for finding what contradicts what, in place of a plan."""
        return self._limits

    def ended(self, judging_s: float) -> None:
        """Say what the limit did not count: the plan is judged, which took so many seconds."""
        self._tell_compiled()
        over_s = running_s() - self._step_s - judging_s - (self._left_s or 0.0)
        self._not_counted("ending the planning", over_s)
        self._not_counted("writing and checking the program", judging_s)

    def compiled_s(self) -> float:
        """Seconds so far of what is done once and not counted."""
        return made_s()

    def _not_counted(self, what: str, took_s: float) -> None:
        if self._limits.time_s and took_s > SAID_S:
            self._tell(f"{what} took {took_s:.0f} s, which the limit does not count")

    def _tell_compiled(self) -> None:
        took_s = self.compiled_s() - self._compiled_s
        if (self._limits.time_s or self._limits.no_improvement_s) and took_s > SAID_S:
            self._tell(f"kernels were compiled, which is done once: {took_s:.0f} s, not counted by the limit")


class CommandLimit(JobLimit):
    """A limit in seconds for a command, from its beginning to its last file: it counts all but compiling.

    `began_s`: when the command began, by `clock`; None for now. `drawn`: the suffixes of the pictures that it draws of
    the plan. `beside`: whether they are drawn beside the check, not after it. `clock`: seconds, for tests.

    Examples
    --------
    2 s have passed, 0.5 s of them for candidates: of 30 s, 1.75 s are kept for plan and check, and 0.7 s for the end.

    >>> limit = CommandLimit(30.0, 0.0, clock=lambda: 2.0)
    >>> limit.candidates_s = 0.5
    >>> round(limit.planning_s(), 3)
    25.55
    """

    def __init__(
        self,
        limit_s: float,
        began_s: float | None = None,
        drawn: Iterable[str] = (),
        clock: Callable[[], float] = counted_s,
        *,
        beside: bool = False,
    ) -> None:
        super().__init__()
        self.limit_s, self._clock = limit_s, clock
        self._began_s = clock() if began_s is None else began_s
        self._drawn = [DRAWN[suffix.lower()] for suffix in drawn]
        self._beside = beside
        self._planned_s = [0.0, 0.0]
        self._share_s, self._ended = limit_s, False

    @property
    def spent_s(self) -> float:
        """Seconds since the command began."""
        return self._clock() - self._began_s

    @property
    def planned_s(self) -> float:
        """Seconds that the planning took, once it is over."""
        return self._planned_s[1] - self._planned_s[0]

    def kept_s(self) -> float:
        """Seconds that are kept for what comes after the planning."""
        checked_s = CHECKED * self.candidates_s
        drawn_s = sum(times * self.candidates_s + more_s for times, more_s in self._drawn)
        if self._beside:
            return max(checked_s, PLANNED * self.candidates_s + drawn_s) + ENDED_S
        return checked_s + drawn_s + ENDED_S

    def planning_s(self) -> float:
        """Seconds for the planning, if it begins now."""
        return max(self.limit_s - self.spent_s - self.kept_s(), LEAST_SHARE * self.limit_s)

    def seconds(self) -> float:
        return self.planning_s()

    def facts_made(self) -> SolveOptions:
        self._share_s, spent_s = self.planning_s(), self.spent_s
        self._planned_s = [spent_s, spent_s]
        return replace(self._limits, time_s=self._share_s)

    def stated(self) -> SolveOptions:
        limits = self.facts_made()
        beside_s = self._planned_s[0] + self.kept_s()
        if beside_s + self._share_s > self.limit_s + TOLD_S:
            self._tell(
                f"reading, facts, rules and the check alone take about {beside_s:.1f} s of a limit of "
                f"{self.limit_s:g} s: the planning has {self._share_s:.1f} s all the same, and the command takes "
                "longer than its limit"
            )
        return limits

    def watched(self, progress: Progress) -> Progress:
        def going(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
            heard = progress(engine, cost_um, bound_um)
            return heard and self.spent_s < self._planned_s[0] + self._share_s

        return going

    def without_plan(self) -> SolveOptions:
        left_s = max(self.limit_s - self.spent_s - ENDED_S, LEAST_SHARE * self.limit_s)  # the answer is told and drawn
        return replace(self._limits, time_s=left_s)

    def ended(self, judging_s: float) -> None:
        self._planned_s[1], self._ended = self.spent_s - judging_s, True
        self._tell_compiled()

    def compiled_s(self) -> float:
        return compiled_s()

    def over(self) -> str:
        """What to say where the command, which ends now, has taken longer than its limit; "" where it has not."""
        spent_s, (before_s, planned_s) = self.spent_s, self._planned_s
        if spent_s <= self.limit_s + TOLD_S:
            return ""
        text = (
            f"the command took {spent_s:.1f} s, {spent_s - self.limit_s:.1f} s longer than its limit: "
            f"{before_s:.1f} s before the planning, "
        )
        if not self._ended:
            return text + f"{spent_s - before_s:.1f} s to find that there is no plan, and why"
        planned = f"{self.planned_s:.1f} s for it (left: {self._share_s:.1f} s), "
        return text + planned + f"{spent_s - planned_s:.1f} s for program, check and files"
