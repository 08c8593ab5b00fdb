"""A limit in seconds for a whole command: what it leaves for the planning, and what is kept for all that comes after.

What comes before the planning has been measured when it begins. What comes after takes about so many times as long as
it took to find candidates on the same nest: both look at every outline of the drawing. A picture that is drawn beside
the check counts only where it takes longer than that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

from kerfwise.models.engines.solution import Progress, SolveOptions
from kerfwise.models.kernels import counted_s

LEAST_SHARE = 0.2
"""Share of a limit in seconds that the planning has, whatever comes before and after it takes."""
CHECKED, ENDED_S = 3.5, 0.7
"""How many times as long as finding candidates the plan with its reasons, the program and the check take, once more
where zones move; and seconds to load what is first asked for then, to write the files, and to leave."""
DRAWN = {".svg": (1.5, 0.0), ".png": (2.5, 0.5), ".pdf": (3.5, 0.6), ".html": (2.5, 7.0)}
"""The same for a picture, by its suffix: so many times as long, and so many seconds."""
PLANNED = 1.0
"""How many times as long as finding candidates the plan with its reasons takes, a part of `CHECKED` that a picture
beside the check waits for."""
TOLD_S = 1.0
"""A command that takes so many seconds longer than its limit says so."""


@dataclass(slots=True)
class Took:
    """What has been measured of a nest before its planning, s."""

    candidates_s: float = 0.0


class WholeLimit:
    """A limit for a command, from its beginning to its last file.

    Parameters
    ----------
    limit_s
        The limit, s.
    began_s
        When the command began, by `clock`; None for now.
    drawn
        The suffixes of the pictures that it draws of the plan.
    beside
        Whether they are drawn beside the check, not after it.
    clock
        Seconds, for tests.

    Examples
    --------
    2 s have passed, 0.5 s of them for candidates: of 30 s, 1.75 s are kept for plan and check, and 0.7 s for the end.

    >>> limit = WholeLimit(30.0, 0.0, clock=lambda: 2.0)
    >>> round(limit.planning_s(Took(0.5)), 3)
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

    def kept_s(self, took: Took) -> float:
        """Seconds that are kept for what comes after the planning."""
        checked_s = CHECKED * took.candidates_s
        drawn_s = sum(times * took.candidates_s + more_s for times, more_s in self._drawn)
        if self._beside:
            return max(checked_s, PLANNED * took.candidates_s + drawn_s) + ENDED_S
        return checked_s + drawn_s + ENDED_S

    def planning_s(self, took: Took) -> float:
        """Seconds for the planning, if it begins now."""
        return max(self.limit_s - self.spent_s - self.kept_s(took), self._least_s)

    def left_s(self) -> float:
        """Seconds for the answer where there is no plan: nothing comes after it."""
        return max(self.limit_s - self.spent_s, self._least_s)

    @property
    def _least_s(self) -> float:
        return LEAST_SHARE * self.limit_s

    def begin(self, limits: SolveOptions, took: Took) -> SolveOptions:
        """The limits of a planning that begins now."""
        self._share_s, spent_s = self.planning_s(took), self.spent_s
        self._planned_s = [spent_s, spent_s]
        return replace(limits, time_s=self._share_s)

    def too_short(self, took: Took) -> str:
        """What to say where all but the planning takes so long that the limit will not hold; "" where it may."""
        beside_s = self._planned_s[0] + self.kept_s(took)
        if beside_s + self._share_s <= self.limit_s + TOLD_S:
            return ""
        return (
            f"reading, facts, rules and the check alone take about {beside_s:.1f} s of a limit of {self.limit_s:g} s: "
            f"the planning has {self._share_s:.1f} s all the same, and the command takes longer than its limit"
        )

    def watched(self, progress: Progress) -> Progress:
        """Asks `progress`, and says stop once the planning has had its seconds, loading of kernels included."""

        def going(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
            heard = progress(engine, cost_um, bound_um)
            return heard and self.spent_s < self._planned_s[0] + self._share_s

        return going

    def end(self, judging_s: float) -> None:
        """Note that the planning is over; program and check have taken some seconds since."""
        self._planned_s[1], self._ended = self.spent_s - judging_s, True

    def over(self) -> str:
        """What to say where the command, which ends now, has taken longer than its limit; "" where it has not."""
        spent_s, (before_s, planned_s) = self.spent_s, self._planned_s
        if spent_s <= self.limit_s + TOLD_S:
            return ""
        told = (
            f"the command took {spent_s:.1f} s, {spent_s - self.limit_s:.1f} s longer than its limit: "
            f"{before_s:.1f} s before the planning, "
        )
        if not self._ended:
            return told + f"{spent_s - before_s:.1f} s to find that there is no plan, and why"
        planned = f"{self.planned_s:.1f} s for it (left: {self._share_s:.1f} s), "
        return told + planned + f"{spent_s - planned_s:.1f} s for program, check and files"
