"""Has nests planned: one after the other, in a process of its own, with what is reached told as it goes."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from functools import partial
from typing import Any

from anyio import to_thread

from kerfwise.encoder.errors import InputError

from .plan_request import PlanRequest
from .session import Background, News, Session, Turns
from .worker import Died, Refused, Worker

STOPPED_S = 5.0
"""What nobody waits for any more is asked to stop; if it has not ended after so long, its process is."""
ASKED_EACH_S = 0.2
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
    """

    def __init__(
        self,
        news: News,
        background: Background,
        work: float,
        memory_gb: float,
        planned: Callable[[Session, int], None],
    ) -> None:
        self.helper, self.turns = Worker("planner"), Turns(news)
        self._background, self._work, self._planned = background, work, planned
        self._memory_gb = memory_gb
        self._now: Session | None = None

    def solve(self, session: Session, work: float | None = None, relax: bool = False) -> None:
        """Begin to plan what is wanted."""
        if session.solving is not None:
            raise InputError("this nest is being planned: cancel that first, or wait")
        reached = {"engine": "", "objective_mm": None, "bound_mm": None, "seconds": 0.0}
        begun = {"waits": True, "ending": "", **reached}
        session.changed(solving=begun, conflict=None, problem="")
        self._background.begin(self._solve(session, begun, session.wanted, work or self._work, relax))

    def cancel(self, session: Session, at_once: bool = False) -> None:
        """End the planning with the best plan so far; `at_once` with none."""
        if session.solving is None:
            return
        if session is not self._now:  # it waits for its turn
            session.changed(solving=None)
            return
        session.solving = {**session.solving, "ending": "at once" if at_once else "soon"}
        session.tell("progress")
        if at_once:
            self.helper.kill()
        else:
            self.helper.stop()

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

    async def _solve(
        self, session: Session, begun: dict[str, Any], wanted: PlanRequest, work: float, relax: bool
    ) -> None:
        loop = asyncio.get_running_loop()

        def heard(told: dict[str, Any]) -> None:
            loop.call_soon_threadsafe(reached, told)

        def reached(told: dict[str, Any]) -> None:
            if session.solving is not None:
                session.solving = {**session.solving, **told}
                session.tell("progress")
                if session.solving["ending"] == "soon":  # it may have been asked before it had begun
                    self.helper.stop()
                elif session.solving["ending"]:
                    self.helper.kill()

        async with self.turns.turn(session.name):
            if session.solving is not begun:  # cancelled while it waited, and perhaps begun anew
                return
            self._now, session.solving = session, {**begun, "waits": False}
            session.tell("progress")
            try:
                limits = {"work": work, "memory_gb": self._memory_gb}
                ask = partial(self.helper.ask, "solve", heard, wanted=wanted, relax=relax, **limits)
                told = await to_thread.run_sync(ask)
            except Refused as error:
                asks = error.told.get("questions", [])
                session.changed(solving=None, problem=error.told["message"], questions=asks)
            except Died as error:
                asked = session.solving["ending"] == "at once"
                session.changed(solving=None, problem="ended without a plan" if asked else str(error))
            else:
                if "conflict" in told:
                    session.changed(solving=None, conflict=told["conflict"])
                else:
                    session.add(told, wanted, relax)
            finally:
                self._now = None
        current = session.current
        if current is not None:  # so that the first move is answered at once
            self._planned(session, current.number)
