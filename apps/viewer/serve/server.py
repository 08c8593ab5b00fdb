"""What the server does for its pages: opens nests, has them planned, saves files in its folder and nowhere else."""

from __future__ import annotations

import asyncio
import hashlib
import json
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from sysconfig import get_path
from typing import Any

from anyio import CapacityLimiter, to_thread

import kerfwise
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, is_file, read_limited
from kerfwise.jobs.nest_job.job import beside_name
from kerfwise.models.engines.tuning import MEMORY_GB
from kerfwise.models.engines.tuning import REQUEST_WORK as WORK
from kerfwise.postproc.output_files import expect_outputs, expect_own, output_names, write_files

from .job_edits import JobText
from .kept_sessions import KeptSession, KeptSessions, job_difference, nest_differences
from .nest_folder import Folder, NestList
from .news import Background, News
from .plan_request import PlanRequest, earlier_plan_name, sha256_of
from .planning import Planning
from .session import Alternative, Session
from .worker import Died, Refused, Worker

ANSWERED_S, SLOW_S = 120.0, 900.0
"""No question takes longer, nor one of `SLOW`; the process that works on it is ended then."""
SIMULATED = ("heat", "bent")
"""What a process of its own answers, begun with the first of them: nobody waits for it at the desk."""
SLOW = (*SIMULATED, "compared", "prepared")
MOST_ASKERS = 20
"""So many questions wait at a time: who asks something else waits for none of them."""
MOST_THUMBNAILS = 500
NONE: Mapping[str, str] = {}
"""No answers to questions of a drawing."""


@dataclass(frozen=True, slots=True)
class Serving:
    """How a folder is served."""

    profile: str | None = None
    """What nests are planned by whose job file names none; None for the default."""
    work: float = WORK
    """How much goes into one plan."""
    memory_gb: float = MEMORY_GB
    """What the process that plans may hold, but for CP-SAT and linear programs."""
    trust: bool = False
    """Whether Python rules of profiles are run."""
    also: Sequence[Path] = ()
    """Folders whose files profiles and the like may be read from, beside the served one and that of `profile`."""
    state: Path | None = None
    """Below which folder sessions are kept, the port and what browsers are known by; None for nowhere."""


class Server:
    """The sessions of one folder of nests, and the processes that work for them."""

    def __init__(self, folder: Folder, how: Serving = Serving()) -> None:
        self.folder, self.profile, self._trust = folder, how.profile, how.trust
        self.kept, self.nests = KeptSessions(how.state, folder.path, how.trust), NestList(folder)
        self.sessions: dict[str, Session] = {}
        self._opening: dict[str, asyncio.Lock] = {}
        self._thumbnails: dict[tuple[Path, int], str] = {}
        self._dropped = Path(tempfile.mkdtemp(prefix="kerfwise-")).resolve()  # drawings that nobody has read yet
        installed = [Path(kerfwise.__file__).parent, *map(Path, {get_path("purelib"), get_path("platlib")})]
        readable = [folder.path, *(one.resolve() for one in how.also), self._dropped, *installed]
        if how.profile is not None and Path(how.profile).is_absolute():
            readable.append(Path(how.profile).resolve().parent)
        self.news, self._background = News(), Background()
        self.desk, self.simulator = Worker("desk", readable), Worker("desk", readable)
        self.planning = Planning(self.news, self._background, how.work, how.memory_gb, self._prepare, readable)

    async def begin(self) -> None:
        """Start the processes, so that the first plan does not wait for them."""
        self._askers = CapacityLimiter(MOST_ASKERS)
        self._background.begin(self._warm())

    async def end(self) -> None:
        """End them."""
        for helper in (self.planning.helper, self.desk, self.simulator):
            await to_thread.run_sync(helper.close)
        await self._background.end()
        shutil.rmtree(self._dropped, ignore_errors=True)

    async def open_nest(self, path: Path, repair: bool = False, answers: Mapping[str, str] = NONE) -> Session:
        """The session of a nest in the folder; the one that is there, if it is open already.

        Answers to its questions are written into its job file once it can be read with them.
        """
        name = path.relative_to(self.folder.path).as_posix()
        key = key_of(name)
        async with self._opening.setdefault(key, asyncio.Lock()):  # two tabs open it once
            return await self._opened(key, name, path, repair, answers)

    async def _opened(self, key: str, name: str, path: Path, repair: bool, answers: Mapping[str, str]) -> Session:
        disk = self.text_beside(path)
        if answers:
            disk = await self._answered(path, disk, repair, answers)
        there = self.sessions.get(key)
        if there is not None:
            repair = repair or there.wanted.repair
            if there.read == (sha256_of(path), repair, disk):
                return there
        before = there or self.kept.load(key, path)
        if before is None:
            return await self._opened_first(
                key, name, PlanRequest(str(path), self._first_text(disk, path), repair), disk
            )
        return await self._opened_again(key, name, before, repair or before.wanted.repair, disk)

    async def reopen(self, key: str) -> Session | None:
        """The session of a nest that was open in an earlier server, or that may have changed on disk; None for none."""
        there = self.sessions.get(key)
        name = self.kept.nest_of(key) if there is None else there.name
        try:
            return there if name is None else await self.open_nest(self.folder.nest(name))
        except (InputError, Refused):
            if there is None:
                raise
            return there  # what is on disk now cannot be read: what was open stays

    async def _opened_first(self, key: str, name: str, wanted: PlanRequest, disk: str | None) -> Session:
        wanted = replace(wanted, trust=self._trust)
        opened = await self.asked("opened", wanted=wanted)
        there = self.sessions[key] = Session(key, name, wanted, opened, self.news, on_disk=disk, keeper=self.kept)
        there.seen = _seen(opened)
        self.kept.keep(there)
        return there

    async def _opened_again(
        self, key: str, name: str, before: Session | KeptSession, repair: bool, disk: str | None
    ) -> Session:
        """A nest that somebody has worked on: its plans and edits stay, and what was changed outside is told."""
        was, path = before.wanted, Path(before.wanted.nest)
        wanted = replace(was, repair=repair, trust=self._trust)
        mine, changed = wanted.job_text, before.changed_job
        unsaved = mine != self._first_text(before.on_disk, path)
        if disk not in (before.on_disk, mine):
            now = self._first_text(disk, path)
            changed = {"disk": now, "kept": mine, "using": "kept" if unsaved else "disk", "unsaved": unsaved, "why": ""}
            wanted = wanted if unsaved else replace(wanted, job_text=now)
        try:
            opened = await self.asked("opened", wanted=wanted)
        except Refused as error:
            now = self._first_text(disk, path)
            if (wanted.job_text, wanted.upto) == (now, 0):
                raise
            wanted = replace(wanted, job_text=now, old_plan=None, upto=0)
            opened = await self.asked("opened", wanted=wanted)
            why = str(error.told["message"])
            changed = {"disk": now, "kept": mine, "using": "disk", "unsaved": unsaved, "why": why}
        there = self.sessions.get(key)
        if there is not None and there.wanted is not was:  # somebody has edited it while the desk was reading
            return await self._opened_again(key, name, there, repair, disk)
        if there is None:
            there = self.sessions[key] = Session(key, name, wanted, opened, self.news, keeper=self.kept)
            there.seen = _seen(opened)
            if isinstance(before, KeptSession):
                before.into(there)
        shown = there.current
        problem = before.problem if isinstance(before, KeptSession) else ""
        none: dict[str, Any] = {"conflict": None, "problem": problem, "questions": []}
        none["shown"] = there.shown if shown is not None and shown.sha256 == opened["sha256"] else 0
        there.changed(wanted=wanted, opened=opened, on_disk=disk, changed_job=changed, **none)
        return there

    async def settle(self, session: Session, job: str | None) -> None:
        """What was changed outside has been seen; of the two job files, the one on `disk` or the one `kept` counts."""
        changed = session.changed_job
        if job is None:
            session.changed(seen=_seen(session.opened))
        elif changed is None:
            raise InputError("the job file was not changed outside")
        else:
            await self.want(session, replace(session.wanted, job_text=changed[job]), changed_job=None)

    def as_json(self, session: Session) -> dict[str, Any]:
        """The state of a session as a page shows it."""
        found = (nest_differences(session.seen, session.opened), job_difference(session.changed_job))
        keeping = self.kept.told(session.id)
        return {**session.as_json(), "differences": [one for one in found if one], "keeping": keeping}

    async def drop(self, name: str, drawing: bytes, repair: bool = False, answers: Mapping[str, str] = NONE) -> Session:
        """The session of a drawing that was dropped on the page; it is written into the folder once it can be read."""
        with self._aside(name, drawing) as path:
            disk = self.text_beside(self.folder.path / name)
            await self.asked("opened", wanted=self._with_answers(path, disk, repair, answers))
        return await self.open_nest(self.folder.keep(name, drawing), repair, answers)

    async def preview(self, path: Path, repair: bool, answers: Mapping[str, str]) -> str:
        """The address of a picture of how a nest is understood with some answers; nothing is written."""
        disk = self.text_beside(path)
        return str(await self.asked("preview", wanted=self._with_answers(path, disk, repair, answers)))

    async def thumbnail(self, path: Path) -> str:
        """The address of a small picture of a nest, kept for as long as its file stays; "" for one that is not read."""
        key = path, path.stat().st_mtime_ns
        if key not in self._thumbnails:
            wanted = PlanRequest(str(path), self.text_beside(path), trust=self._trust)
            if len(self._thumbnails) >= MOST_THUMBNAILS:
                self._thumbnails.clear()
            try:
                self._thumbnails[key] = str(await self.asked("thumbnail", wanted=wanted))
            except (Refused, Died, InputError):
                self._thumbnails[key] = ""
        return self._thumbnails[key]

    async def preview_of_drop(self, name: str, drawing: bytes, repair: bool, answers: Mapping[str, str]) -> str:
        """The same of a drawing that was dropped on the page, and is not in the folder yet."""
        with self._aside(name, drawing) as path:
            disk = self.text_beside(self.folder.path / name)
            return str(await self.asked("preview", wanted=self._with_answers(path, disk, repair, answers)))

    @contextmanager
    def _aside(self, name: str, drawing: bytes) -> Iterator[Path]:
        """A drawing in a folder of its own, for as long as nobody knows whether it can be read."""
        self.folder.expect_free(name, drawing)
        with tempfile.TemporaryDirectory(dir=self._dropped) as aside:
            path = Path(aside).resolve() / name
            path.write_bytes(drawing)
            yield path

    def _with_answers(self, path: Path, disk: str | None, repair: bool, answers: Mapping[str, str]) -> PlanRequest:
        first = self._first_text(disk, path)
        text = JobText(first or "").with_answers(answers).text if answers else first
        return PlanRequest(str(path), text, repair, trust=self._trust)

    async def _answered(self, path: Path, disk: str | None, repair: bool, answers: Mapping[str, str]) -> str | None:
        """The job file with the answers that a question of the nest asked for, as it is now on disk."""
        opened = await self.asked("opened", wanted=self._with_answers(path, disk, repair, answers))
        used = {question: choice for question, choice in answers.items() if question in opened["answers"]}
        if not used:
            return disk
        job = path.with_name(beside_name(path.name))
        self.folder.expect_inside([job])
        text = JobText(disk or "").with_answers(used).text
        if self.text_beside(path) != disk:
            raise InputError(f"{job.name} has changed on disk meanwhile: open the nest again")
        if text != disk:
            write_files({job: text})
        return text

    def text_beside(self, nest: Path) -> str | None:
        """What the job file of a nest says; None where there is none."""
        return job_text_beside(nest, self.folder)

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
        answer = await self.asked("edited", wanted=session.wanted, changes=changes)
        session.expect(version)  # the desk took its time, and another tab did not wait
        text = answer["job_text"] or (None if session.on_disk is None else "")  # no file, no text
        await self.want(session, replace(session.wanted, job_text=text))
        undone: list[str] = answer["undone"]
        return undone

    async def change_nest(self, session: Session, changes: list[str], name: str | None) -> dict[str, Any]:
        """Change the nest itself: under a name, a new nest in the folder that is opened; else what it would be."""
        answer: dict[str, Any] = await self.asked("changed", wanted=session.wanted, changes=changes)
        text = answer.pop("text")
        if name is None:
            return answer
        if not name.lower().endswith(".json"):
            raise InputError(f"{escape_text(name)!r}: an edited nest is JSON: give a name ending in .json")
        opened = await self.open_nest(self.folder.keep(name, text.encode(), Path(session.wanted.nest)))
        return {**self.as_json(opened), **answer}

    async def want(self, session: Session, wanted: PlanRequest, **also: Any) -> None:
        """Want something else from now on."""
        version = session.version
        opened = await self.asked("opened", wanted=wanted)
        session.expect(version)
        session.changed(wanted=wanted, opened=opened, conflict=None, problem="", questions=[], **also)

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
        within_s = SLOW_S if question in SLOW else ANSWERED_S
        helper = self.simulator if question in SIMULATED else self.desk
        ask = partial(helper.ask, question, within_s=within_s, **given)
        try:
            return await to_thread.run_sync(ask, limiter=self._askers)
        except Died:
            return await to_thread.run_sync(ask, limiter=self._askers)

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


def key_of(nest: str) -> str:
    """The id of a nest's session, by its name in the folder."""
    return hashlib.sha256(nest.encode("utf-8", "surrogatepass")).hexdigest()[:12]


def _seen(opened: Mapping[str, Any]) -> dict[str, Any]:
    return {key: opened[key] for key in ("sha256", "shapes")}


def _json(data: Any) -> bytes:
    return json.dumps(data, ensure_ascii=False).encode("utf-8", "surrogatepass")


def _side(plan: Alternative) -> tuple[str, PlanRequest, str]:
    return f"plan {plan.number}", plan.wanted, plan.plan


# Saves what a session shows: all files or none, and nothing over what somebody else has changed.


def save(session: Session, folder: Folder, profile_sha256: str, picture: str) -> dict[str, Any]:
    """Write the shown plan's files and its job file, all of them or none; what was written, and the command line.

    `profile_sha256` is that of the profile as it is on disk now, `picture` that of the plan.

    Raises InputError if there is no plan, the check refuses it, the nest, the job file or the profile has changed on
    disk, a job file was saved that the plan was made without, a file is of another nest, or a link leads out of the
    folder.
    """
    current = session.current
    if current is None:
        raise InputError("there is no plan to save yet")
    if not current.checked:
        raise InputError("the program of this plan is not checked yet: wait for it, or plan again")
    if not current.ok:
        raise InputError(f"the check refuses this plan ({', '.join(current.broken)}): nothing is written")
    wanted, nest = current.wanted, Path(current.wanted.nest)
    if session.changed_job is not None and session.changed_job["unsaved"]:
        raise InputError("the job file was changed outside: say first which one counts, the one on disk or yours")
    if wanted.profile_now != session.wanted.profile_now:
        raise InputError("the profile has changed since this plan was made: plan again")
    job = nest.with_name(beside_name(nest.name))
    if sha256_of(nest) != current.sha256:
        raise InputError("the nest has changed on disk since this plan was made: open it again")
    if job_text_beside(nest, folder) != session.on_disk:
        raise InputError(f"{job.name} has changed on disk since it was read: open the nest again")
    if wanted.job_text is None and session.on_disk is not None:
        raise InputError(f"{job.name} was saved since this plan was made, which goes without: plan again")
    if json.loads(current.plan)["profile"].get("sha256") != profile_sha256:
        raise InputError("the profile has changed on disk since this plan was made: plan again")
    files: dict[Path, str | bytes] = {nest.with_name(name): kept.text() for name, kept in current.files.items()}
    program, _, drawn = (nest.with_name(name) for name in output_names(nest))
    files[drawn] = picture
    if wanted.old_plan is not None:
        files[nest.with_name(earlier_plan_name(wanted.nest))] = wanted.old_plan
    for plan in [path for path in files if path.name.endswith(".plan.json")]:
        expect_own(nest, program, plan, drawn)
    expect_outputs(files, (nest, job))
    folder.expect_inside((*files, job))
    if wanted.job_text is not None and wanted.job_text != session.on_disk:
        files[job] = wanted.job_text
    write_files(files)
    result = {
        "number": current.number,
        "files": [path.name for path in files],
        "command": current.command,
        "same_bytes": current.stage == "final" and not current.stopped,
    }
    session.changed(saved=result, on_disk=wanted.job_text if wanted.job_text is not None else session.on_disk)
    return result


def job_text_beside(nest: Path, folder: Folder) -> str | None:
    """What the job file of a nest says, to the byte; None where there is none.

    Raises InputError if it is no UTF-8 text, or a link that leads out of the folder.
    """
    job = nest.with_name(beside_name(nest.name))
    folder.expect_inside([job])
    try:
        return read_limited(job, MOST_BYTES_OF_YAML).decode("utf-8") if is_file(job) else None
    except UnicodeDecodeError:
        raise InputError("not a job file: it is no UTF-8 text", file=job.name) from None
