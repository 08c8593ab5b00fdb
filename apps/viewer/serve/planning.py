"""Has nests planned: one after the other, in a process of its own, with what is reached told as it goes."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from anyio import to_thread

from .news import Background, News, Turns
from .plan_request import SUPERSEDE, PlanRequest
from .session import Session
from .worker import Died, Refused, Worker

STOPPED_S = 5.0
"""What nobody waits for any more is asked to stop; if it has not ended after so long, its process is."""
ASKED_EACH_S = 0.2
SUPERSEDED_S = 1.0
"""A planning that another one of the same nest takes the place of has so long to end."""
Gone = Callable[[], Awaitable[object]]
"""Comes back once who has asked is gone."""


class Planning:
    """The planner, and whose turn it is.

    Parameters
    ----------
    news
        Where it is told.
    background
        Where it works.
    work
        How much goes into one plan, where nothing else is said.
    memory_gb
        What the process that plans may hold, but for CP-SAT and linear programs.
    planned
        Called with a session and the number of a plan that is shown now.
    readable
        The folders that it may read.
    """

    def __init__(
        self,
        news: News,
        background: Background,
        work: float,
        memory_gb: float,
        planned: Callable[[Session, int], None],
        readable: Sequence[Path] = (),
    ) -> None:
        self.helper, self.turns = Worker("planner", readable), Turns(news)
        self._background, self._work, self._planned = background, work, planned
        self._memory_gb = memory_gb
        self._now: PlanningRun | None = None
        self._runs: dict[str, PlanningRun] = {}

    def solve(self, session: Session, work: float | None = None, relax: bool = False) -> None:
        """Begin to plan what is wanted; a planning of the nest that runs ends, and its plans stay.

        Where the same is being planned already, that goes on.
        """
        begun = PlanningRun(session, session.runs + 1, session.wanted, work or self._work, relax)
        before = self._runs.get(session.id)
        if before is not None and not before.ending and before.asked == begun.asked:
            return
        self._runs[session.id] = begun
        if before is not None and before is self._now:
            self._background.begin(self._superseded(before))
        none: dict[str, Any] = {"conflict": None, "problem": "", "questions": []}
        session.changed(by_hand=False, solving=begun.told(), runs=begun.number, following=begun.number, **none)
        self._background.begin(self._solve(begun))

    def cancel(self, session: Session, at_once: bool = False) -> None:
        """End the planning with the best plan so far; `at_once` with what is shown."""
        run = self._runs.get(session.id)
        if run is None:
            return
        if run is not self._now:  # it waits for its turn
            self._end(run)
            return
        run.ending = "at once" if at_once else "soon"
        self._tell(run)
        if at_once:
            self.helper.kill()
        else:
            self.helper.stop()

    def _end(self, run: PlanningRun, **also: Any) -> None:
        """The run is over, unless another of the nest took its place."""
        if self._runs.get(run.session.id) is run:
            del self._runs[run.session.id]
            run.session.changed(by_hand=False, solving=None, **also)

    def _tell(self, run: PlanningRun) -> None:
        """Tell how far a run is, unless another of the nest took its place."""
        if self._runs.get(run.session.id) is run:
            run.session.solving = run.told()
            run.session.tell("progress")

    async def _superseded(self, run: PlanningRun) -> None:
        """Have the planner leave a run that nobody waits for: the next one is begun at once."""
        for _ in range(round(SUPERSEDED_S / ASKED_EACH_S)):
            if self._now is not run:
                return
            self.helper.stop(SUPERSEDE)  # again and again: it may not have begun yet
            await asyncio.sleep(ASKED_EACH_S)
        if self._now is run:
            self.helper.kill()

    async def asked(self, nest: str, question: str, gone: Gone, **given: Any) -> Any:
        """What the planner answers once it is the turn of a nest.

        Once who has asked is gone, the question waits no more for its turn, and the planner is stopped.

        Raises
        ------
        Refused, Died
            As `Helper.ask` does; Refused too where who has asked is gone.
        """
        begun = asyncio.Event()

        async def answered() -> Any:
            async with self.turns.turn(nest):
                begun.set()
                return await to_thread.run_sync(partial(self.helper.ask, question, memory_gb=self._memory_gb, **given))

        answer, leaving = asyncio.ensure_future(answered()), asyncio.ensure_future(gone())
        try:
            await asyncio.wait((answer, leaving), return_when=asyncio.FIRST_COMPLETED)
            if answer.done():
                return answer.result()
            if begun.is_set():
                await self._stopped(answer)
            raise Refused({"kind": "gone", "message": "who has asked is gone", "details": []})
        finally:
            leaving.cancel()
            answer.cancel()

    async def _stopped(self, answer: asyncio.Future[Any]) -> None:
        """Have the planner come to its end, whatever it answers."""
        ends_s = asyncio.get_running_loop().time() + STOPPED_S
        while not answer.done():
            if asyncio.get_running_loop().time() < ends_s:
                self.helper.stop()  # again and again: it may not have begun yet
            else:
                self.helper.kill()
            await asyncio.wait((answer,), timeout=ASKED_EACH_S)
        answer.exception()

    async def _solve(self, run: PlanningRun) -> None:
        loop, session = asyncio.get_running_loop(), run.session

        def heard(event: dict[str, Any]) -> None:
            loop.call_soon_threadsafe(self._reached, run, event)

        async with self.turns.turn(session.name):
            if self._runs.get(session.id) is not run:  # cancelled while it waited, and perhaps begun anew
                return
            self._now, run.waits, run.began_s = run, False, time.monotonic()
            self._tell(run)
            start = session.current
            limits: dict[str, Any] = {"work": run.work, "memory_gb": self._memory_gb}
            limits["start"] = None if start is None or start.wanted.upto != run.wanted.upto else start.plan
            try:
                ask = partial(self.helper.ask, "solve", heard, wanted=run.wanted, relax=run.relax, **limits)
                answer = await to_thread.run_sync(ask)
            except Refused as error:
                self._end(run, problem=error.told["message"], questions=error.told.get("questions", []))
            except Died as error:
                at_once = run.ending == "at once"
                how = "ended" if run.shown else "ended without a plan"
                self._end(run, problem=how if at_once else str(error))
            else:
                if "conflict" in answer:
                    self._end(run, conflict=answer["conflict"])
                elif "superseded" not in answer and not (answer["stopped"] and session.is_known(answer, run.number)):
                    session.add(answer | {"stage": "final"}, run.wanted, run.relax, run.number)
                    self._end(run)
            finally:
                self._end(run)
                self._now = None
        current = session.current
        if current is not None:  # so that the first move is answered at once
            self._planned(session, current.number)

    def _reached(self, run: PlanningRun, event: dict[str, Any]) -> None:
        """A run has told something: a plan, or how far it is."""
        session = run.session
        if (plan := event.pop("plan", None)) is not None:
            shown = session.add(plan, run.wanted, run.relax, run.number)
            run.shown, run.gained_mm = shown.number, run.gained_mm + (shown.gained_mm or 0.0)
            self._planned(session, shown.number)
        if (checked := event.pop("checked", None)) is not None:
            session.check(run.shown, checked)
        for name, value in event.items():
            setattr(run, name, value)
        self._tell(run)
        if run is self._now and run.ending:
            if run.ending == "soon":  # it may have been asked before it had begun
                self.helper.stop()
            else:
                self.helper.kill()


@dataclass(eq=False)
class PlanningRun:
    """One planning of a nest: what is wanted, and how far it is.

    `phase` is what is being done, in a planner's words; `gap` the share by which the plan may be too dear, None where
    that is not known; `shown` the number of the last plan that it has shown, `gained_mm` the travel that was saved
    since the first; `ending` how it was asked to end.
    """

    session: Session
    number: int
    wanted: PlanRequest
    work: float
    relax: bool
    waits: bool = True
    phase: str = "waits"
    gap: float | None = None
    shown: int = 0
    gained_mm: float = 0.0
    ending: str = ""
    began_s: float = field(default_factory=time.monotonic)

    @property
    def asked(self) -> tuple[PlanRequest, float, bool]:
        """What tells one planning from another."""
        return self.wanted, self.work, self.relax

    def told(self) -> dict[str, Any]:
        """The same as a page shows it; `elapsed_s` is the time since it began."""
        return {
            "waits": self.waits,
            "ending": self.ending,
            "phase": self.phase,
            "elapsed_s": round(time.monotonic() - self.began_s, 2),
            "gap": self.gap,
            "plan": self.shown or None,
            "run": self.number,
            "gained_mm": self.gained_mm,
        }
