"""What the server does for its pages: opens nests, has them planned, asks the desk, and saves."""

from __future__ import annotations

import asyncio
import hashlib
import json
import tempfile
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from anyio import to_thread

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.nest_job.beside import beside_name
from kerfwise.jobs.solve_options import WORK

from .folder import Folder
from .helper import Died, Helper, Refused
from .job_text import JobText
from .session import Session, contours_of, cut_up_to, text_of
from .wanted import Wanted, sha256_of

MOST_SESSIONS = 40


@dataclass(eq=False)
class Server:
    """The sessions of one folder, and the two processes that work for them.

    `profile` is what nests are planned by whose job file names none; None for the default. `work` is how much goes into
    one plan, and `trust` says whether Python rules of profiles are run.
    """

    folder: Folder
    profile: str | None = None
    work: float = WORK
    trust: bool = False
    sessions: dict[str, Session] = field(default_factory=dict)
    desk: Helper = field(default_factory=lambda: Helper("desk"))
    planner: Helper = field(default_factory=lambda: Helper("planner"))
    _planning: asyncio.Lock = field(default_factory=asyncio.Lock)
    _jobs: set[asyncio.Task[None]] = field(default_factory=set)

    async def begin(self) -> None:
        """Start the processes, so that the first plan does not wait for them."""
        self._in_background(self._warm())

    async def end(self) -> None:
        """End them."""
        for helper in (self.planner, self.desk):
            await to_thread.run_sync(helper.close)
        for job in list(self._jobs):
            job.cancel()
        await asyncio.gather(*self._jobs, return_exceptions=True)

    async def open_nest(self, path: Path, repair: bool = False) -> Session:
        """The session of a nest in the folder; the one that is there, if it is open already."""
        name = path.relative_to(self.folder.path).as_posix()
        key = hashlib.sha256(name.encode()).hexdigest()[:12]
        disk = text_of(path.with_name(beside_name(path.name)))
        read = (sha256_of(path), repair, disk)
        there = self.sessions.get(key)
        if there is not None and there.read == read:
            return there
        wanted = Wanted(str(path), self._first_text(disk, path), repair, trust=self.trust)
        opened = await self.asked("opened", wanted=wanted)
        there = self.sessions.get(key)  # the desk took its time, and another tab did not wait
        if there is None:
            if len(self.sessions) >= MOST_SESSIONS:
                raise InputError(f"{MOST_SESSIONS} nests are open: end the server and start it again")
            there = self.sessions[key] = Session(key, name, wanted, opened, on_disk=disk)
        elif there.read != read:
            there.opened_again(wanted, opened, disk)
        return there

    async def drop(self, name: str, drawing: bytes, repair: bool = False) -> Session:
        """The session of a drawing that was dropped on the page; it is written into the folder once it can be read."""
        self.folder.expect_free(name, drawing)
        with tempfile.TemporaryDirectory() as aside:
            path = Path(aside).resolve() / name
            path.write_bytes(drawing)
            await self.asked("opened", wanted=Wanted(str(path), self._first_text(None, path), repair))
        return await self.open_nest(self.folder.keep(name, drawing), repair)

    def _first_text(self, disk: str | None, nest: Path) -> str | None:
        """The job file of a nest that is opened: with the profile that the server was given, where it names none."""
        if self.profile is None or (disk is not None and JobText(disk).job().profile is not None):
            return disk
        path = Path(self.profile)
        near = path.is_absolute() and path.is_relative_to(nest.parent)
        return JobText(disk or "").with_profile(path.relative_to(nest.parent).as_posix() if near else self.profile).text

    async def edit(self, session: Session, changes: list[dict[str, Any]]) -> list[str]:
        """Change the job file that is wanted; the locks that gave way."""
        version = session.version
        told = await self.asked("edited", wanted=session.wanted, changes=changes)
        session.expect(version)  # the desk took its time, and another tab did not wait
        await self.want(session, replace(session.wanted, job_text=told["job_text"]))
        undone: list[str] = told["undone"]
        return undone

    async def want(self, session: Session, wanted: Wanted, **also: Any) -> None:
        """Want something else from now on."""
        version = session.version
        opened = await self.asked("opened", wanted=wanted)
        session.expect(version)
        session.changed(wanted=wanted, opened=opened, conflict=None, problem="", **also)

    async def cut_up_to(self, session: Session, upto: int) -> None:
        """Count the first cuts of the shown plan as made."""
        await self.want(session, cut_up_to(session, upto))

    def solve(self, session: Session, work: float | None = None, relax: bool = False) -> None:
        """Begin to plan what is wanted."""
        if session.solving is not None:
            raise InputError("this nest is being planned: cancel that first, or wait")
        reached = {"engine": "", "objective_mm": None, "bound_mm": None, "seconds": 0.0}
        begun = {"waits": self._planning.locked(), "ending": "", **reached}
        session.changed(solving=begun, conflict=None, problem="")
        self._in_background(self._solve(session, begun, session.wanted, work or self.work, relax))

    def cancel(self, session: Session, at_once: bool = False) -> None:
        """End the planning with the best plan so far; `at_once` with none."""
        if session.solving is None:
            return
        if session.solving["waits"]:
            session.changed(solving=None)
            return
        session.solving = {**session.solving, "ending": "at once" if at_once else "soon"}
        session.tell("progress")
        if at_once:
            self.planner.kill()
        else:
            self.planner.stop()

    async def tried(self, session: Session, changes: list[dict[str, Any]], relax: bool = False) -> dict[str, Any]:
        """What a way out of a conflict would bring."""
        told: dict[str, Any] = await self.asked_planner("tried", wanted=session.wanted, changes=changes, relax=relax)
        return told

    async def asked_planner(self, question: str, **given: Any) -> Any:
        """What the planner answers once it has planned what it was planning."""
        async with self._planning:
            return await to_thread.run_sync(partial(self.planner.ask, question, **given))

    async def page(self, session: Session, number: int | None = None) -> str:
        """What the page shows of the shown plan, or of another one, as JSON; of the nest alone where there is none."""
        plan = session.current if number is None else session.alternative(number)
        if plan is not None:
            return plan.page
        return json.dumps(await self.asked("page", wanted=session.wanted), ensure_ascii=False)

    async def about(self, session: Session, question: str, number: int | None = None, **given: Any) -> Any:
        """What the desk answers about the shown plan, or another one."""
        plan = session.current if number is None else session.alternative(number)
        if plan is None:
            raise InputError("there is no plan yet")
        if "contours" in given:
            given["contours"] = contours_of(session.opened, given["contours"])
        return await self.asked(question, wanted=plan.wanted, plan=plan.plan, **given)

    async def _solve(self, session: Session, begun: dict[str, Any], wanted: Wanted, work: float, relax: bool) -> None:
        loop = asyncio.get_running_loop()

        def heard(told: dict[str, Any]) -> None:
            loop.call_soon_threadsafe(reached, told)

        def reached(told: dict[str, Any]) -> None:
            if session.solving is not None:
                session.solving = {**session.solving, **told}
                session.tell("progress")
                if session.solving["ending"] == "soon":  # it may have been asked before it had begun
                    self.planner.stop()

        async with self._planning:
            if session.solving is not begun:  # cancelled while it waited, and perhaps begun anew
                return
            session.solving = {**begun, "waits": False}
            try:
                ask = partial(self.planner.ask, "solve", heard, wanted=wanted, work=work, relax=relax)
                told = await to_thread.run_sync(ask)
            except Refused as error:
                session.changed(solving=None, problem=error.told["message"])
            except Died as error:
                asked = session.solving["ending"] == "at once"
                session.changed(solving=None, problem="ended without a plan" if asked else str(error))
            else:
                if "conflict" in told:
                    session.changed(solving=None, conflict=told["conflict"])
                else:
                    session.add(told, wanted, work, relax)
        current = session.current
        if current is not None:  # so that the first move is answered at once
            self._in_background(self._prepare(session, current.number))

    async def _prepare(self, session: Session, number: int) -> None:
        try:
            plan = session.alternative(number)
            await self.asked("prepared", wanted=plan.wanted, plan=plan.plan)
        except (Refused, Died, InputError):
            return  # whoever asks next is told

    async def _warm(self) -> None:
        for helper in (self.desk, self.planner):
            try:
                await to_thread.run_sync(partial(helper.ask, "ready"))
            except (Refused, Died):
                return

    async def asked(self, question: str, **given: Any) -> Any:
        """What the desk answers; it changes nothing, so that another one is asked where it has died."""
        ask = partial(self.desk.ask, question, **given)
        try:
            return await to_thread.run_sync(ask)
        except Died:
            return await to_thread.run_sync(ask)

    def _in_background(self, work: Any) -> None:
        job: asyncio.Task[None] = asyncio.get_running_loop().create_task(work)
        self._jobs.add(job)
        job.add_done_callback(self._jobs.discard)
