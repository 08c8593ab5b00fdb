"""What the server does for its pages: opens nests, has them planned, asks the desk."""

from __future__ import annotations

import hashlib
import json
import tempfile
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from anyio import to_thread

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.nest_job.beside import beside_name
from kerfwise.jobs.solve_options import WORK
from kerfwise.models.engines.solution import MEMORY_GB

from .alternative import Alternative
from .background import Background
from .folder import Folder
from .helper import Died, Helper, Refused
from .job_text import JobText
from .news import News
from .planning import Planning
from .saving import text_of
from .session import Session, cut_up_to
from .wanted import Wanted, sha256_of


class Server:
    """The sessions of one folder, and the two processes that work for them.

    Parameters
    ----------
    folder
        The nests' folder.
    profile
        What nests are planned by whose job file names none; None for the default.
    work
        How much goes into one plan.
    trust
        Whether Python rules of profiles are run.
    memory_gb
        What the process that plans may hold, but for CP-SAT and linear programs.
    """

    def __init__(
        self,
        folder: Folder,
        profile: str | None = None,
        work: float = WORK,
        trust: bool = False,
        memory_gb: float = MEMORY_GB,
    ) -> None:
        self.folder, self.profile, self._trust = folder, profile, trust
        self.sessions: dict[str, Session] = {}
        self.news, self._background, self.desk = News(), Background(), Helper("desk")
        self.planning = Planning(self.news, self._background, work, memory_gb, self._prepare)

    async def begin(self) -> None:
        """Start the processes, so that the first plan does not wait for them."""
        self._background.begin(self._warm())

    async def end(self) -> None:
        """End them."""
        for helper in (self.planning.helper, self.desk):
            await to_thread.run_sync(helper.close)
        await self._background.end()

    async def open_nest(self, path: Path, repair: bool = False) -> Session:
        """The session of a nest in the folder; the one that is there, if it is open already."""
        name = path.relative_to(self.folder.path).as_posix()
        key = hashlib.sha256(name.encode()).hexdigest()[:12]
        disk = text_of(path.with_name(beside_name(path.name)))
        read = (sha256_of(path), repair, disk)
        there = self.sessions.get(key)
        if there is not None and there.read == read:
            return there
        wanted = Wanted(str(path), self._first_text(disk, path), repair, trust=self._trust)
        opened = await self.asked("opened", wanted=wanted)
        there = self.sessions.get(key)  # the desk took its time, and another tab did not wait
        if there is None:
            there = self.sessions[key] = Session(key, name, wanted, opened, self.news, on_disk=disk)
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
        text = told["job_text"] or (None if session.on_disk is None else "")  # no file, no text
        await self.want(session, replace(session.wanted, job_text=text))
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

    async def page(self, session: Session, number: int | None = None) -> bytes:
        """What the page shows of the shown plan, or of another one, as JSON; of the nest alone where there is none."""
        plan = session.looked_at(number)
        return plan.page.bytes() if plan is not None else _json(await self.asked("page", wanted=session.wanted))

    async def compared(self, session: Session, number: int, other: int) -> bytes:
        """What the page shows of two plans side by side, as JSON."""
        sides = [_side(session.alternative(one)) for one in (number, other)]
        return _json(await self.asked("compared", sides=sides))

    async def about(self, session: Session, question: str, number: int | None = None, **given: Any) -> Any:
        """What the desk answers about the shown plan, or another one."""
        plan = session.looked_at(number)
        if plan is None:
            raise InputError("there is no plan yet")
        return await self.asked(question, wanted=plan.wanted, plan=plan.plan, **given)

    async def asked(self, question: str, **given: Any) -> Any:
        """What the desk answers; it changes nothing, so that another one is asked where it has died."""
        ask = partial(self.desk.ask, question, **given)
        try:
            return await to_thread.run_sync(ask)
        except Died:
            return await to_thread.run_sync(ask)

    def _prepare(self, session: Session, number: int) -> None:
        """Have the desk work out what moves of a plan need, so that the first one is answered at once."""
        self._background.begin(self._prepared(session, number))

    async def _prepared(self, session: Session, number: int) -> None:
        try:
            plan = session.alternative(number)
            await self.asked("prepared", wanted=plan.wanted, plan=plan.plan)
        except (Refused, Died, InputError):
            return  # whoever asks next is told

    async def _warm(self) -> None:
        for helper in (self.desk, self.planning.helper):
            try:
                await to_thread.run_sync(partial(helper.ask, "ready"))
            except (Refused, Died):
                return


def _json(data: Any) -> bytes:
    return json.dumps(data, ensure_ascii=False).encode("utf-8", "surrogatepass")


def _side(plan: Alternative) -> tuple[str, Wanted, str]:
    return f"plan {plan.number}", plan.wanted, plan.plan
