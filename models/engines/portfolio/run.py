"""What a run carries from member to member, and what is left of its limits."""

from __future__ import annotations

from dataclasses import replace
from math import inf

from kerfwise.models.engines import setting_out, shares
from kerfwise.models.engines.known import Known
from kerfwise.models.engines.names import Member
from kerfwise.models.engines.solution import Progress, SolveOptions, table_bytes
from kerfwise.models.engines.watch import Watch
from kerfwise.models.kernels import running_s
from kerfwise.models.problem.problem import Problem

NOT_BEGUN = "{}: not begun, its tables alone take longer than what is left for it"


class Run:
    """One problem, the limits, and what is known so far; members take it and write to `known`."""

    def __init__(self, problem: Problem, options: SolveOptions, watch: Watch) -> None:
        self.problem, self.options, self.watch = problem, options, watch
        self.of_sets = replace(problem, general=())  # all but what a set and the last site cannot tell
        self.most_bytes = table_bytes(options.memory_gb, setting_out.crossed_bytes(problem))
        self.known = Known()
        self._began_s = watch.seconds

    def left(self) -> float:
        """Seconds of work that are left, or by the clock where that is limited."""
        if self.options.time_s is None:
            return max(0.0, self.options.work - self.known.work)
        return max(0.0, self.options.time_s - (self.watch.seconds - self._began_s))

    def wanting(self) -> bool:
        """Whether there is no plan at all, or time for a better one."""
        return not self.known.proven and (self.known.incumbent is None or not self.watch.stopped)

    def over(self) -> bool:
        """Whether no further member is to begin."""
        return self.known.proven or self.watch.stopped or self._late()

    def _late(self) -> bool:
        """Whether there is a plan, and no time for another member to set out in; none looks at the clock at work."""
        return self.options.time_s is not None and self.known.incumbent is not None and self.left() < shares.SET_OUT_S

    def takes(self, member: Member, why: str) -> bool:
        """Whether a member may run; it is noted why."""
        forced = self.options.member
        if forced is not None and forced != member:
            return False
        self.known.notes.append(f"{member}: {why if forced is None else 'asked for'}")
        return True

    def leave_out(self, member: Member, why: str) -> None:
        """Note why a member cannot run."""
        self.known.notes.append(f"{member}: left out, {why}")
        self.known.unable = why if self.options.member == member else ""

    def sets_out(self, took_s: float, share: float) -> bool:
        """Whether an engine has time for more than its tables; where there is no plan yet, or it was asked for, so."""
        return self.options.member is not None or self.known.incumbent is None or took_s <= share

    def limit_s(self, share: float) -> float | None:
        """A share by the clock, where that is limited."""
        return None if self.options.time_s is None else share

    def ends_s(self, share: float) -> float:
        """When so many seconds will be over, by `running_s`; never where no seconds are counted."""
        return inf if self.options.time_s is None else running_s() + share

    def within(self, share: float, asked: Progress | None = None) -> Progress:
        """To be asked whether to go on, no longer than so many seconds where seconds are counted."""
        limited, until_s = self.options.time_s is not None, self.watch.seconds + share
        asked = asked or self.watch

        def going(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
            return asked(engine, cost_um, bound_um) and not (limited and self.watch.seconds >= until_s)

        return going
