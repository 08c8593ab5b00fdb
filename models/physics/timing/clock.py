"""T = L_on / V_on + L_off / V_off + N_pt · t_pt, run by run, whatever the model of motion (Tavaeva and Petunin)."""

from __future__ import annotations

from dataclasses import dataclass

from .constant import Feeds
from .motion import Motion
from .run import Job


@dataclass(frozen=True, slots=True)
class RunTimes:
    """When each run begins (its pierce included) and ends, and what the whole program spends on what; all in s.

    `total_s` includes the idle moves after the last run, and `dwell_s`, for which the torch waits for metal to cool.
    """

    spans: tuple[tuple[float, float], ...]
    cut_s: float
    idle_s: float
    pierce_s: float
    dwell_s: float = 0.0

    @property
    def total_s(self) -> float:
        """The whole program, s."""
        return self.cut_s + self.idle_s + self.pierce_s + self.dwell_s


def times_of(job: Job, motion: Motion, feeds: Feeds) -> RunTimes:
    """The times of a program; `feeds` say how long piercing, and starting to mark, takes.

    Examples
    --------
    >>> from kerfwise.encoder.geometry.curve import Curve
    >>> from kerfwise.models.physics.timing.constant import ConstantFeed
    >>> from kerfwise.models.physics.timing.run import Run
    >>> feeds = Feeds(10, 10, 50, 0.5)
    >>> line = Curve.of([(30, 40), (130, 40)], closed=False)
    >>> times_of(Job((Run(line, travels_mm=(50.0,)),), (100.0,), 9), ConstantFeed(feeds), feeds)
    RunTimes(spans=((1.0, 11.5),), cut_s=10.0, idle_s=3.0, pierce_s=0.5, dwell_s=0.0)
    """
    now = cut_s = idle_s = pierce_s = 0.0
    spans = []
    for run in job.runs:
        travel_s = sum(map(motion.travel_s, run.travels_mm))
        wait_s = feeds.mark_start_s if run.marks else feeds.pierce_s if run.pierced else feeds.edge_s
        wait_s = 0.0 if run.linked else wait_s
        if run.standing_s is not None:
            wait_s = run.standing_s
        on_s = motion.run_s(run.path, run.marks, run.feed_share) if run.moving_s is None else run.moving_s
        begin_s = now + travel_s + run.wait_s
        spans.append((begin_s, begin_s + wait_s + on_s))
        now = spans[-1][1]
        cut_s, idle_s, pierce_s = cut_s + on_s, idle_s + travel_s, pierce_s + wait_s
    idle_s += sum(map(motion.travel_s, job.homing_mm))
    return RunTimes(tuple(spans), cut_s, idle_s, pierce_s, sum(run.wait_s for run in job.runs))
