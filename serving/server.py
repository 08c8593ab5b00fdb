"""What the server does for its pages: opens nests, has them planned, saves files in its folder and nowhere else."""

from __future__ import annotations

import hashlib
import json
import re
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Any

from anyio import to_thread

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, is_file, read_limited
from kerfwise.encoder.readers.read import SUFFIXES
from kerfwise.encoder.text import escape_text
from kerfwise.jobs.nest_job.job import beside_name
from kerfwise.jobs.request import WORK
from kerfwise.models.engines.solution import MEMORY_GB
from kerfwise.postproc.output_files import expect_outputs, expect_own, output_names, write_files

from .job_edits import JobText
from .plan_request import PlanRequest, earlier_plan_name, sha256_of
from .planning import Planning
from .session import Alternative, Background, News, Session, request_after_cuts
from .worker import Died, Refused, Worker

NONE: Mapping[str, str] = {}
"""No answers to questions of a drawing."""


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
        self.news, self._background, self.desk = News(), Background(), Worker("desk")
        self.planning = Planning(self.news, self._background, work, memory_gb, self._prepare)

    async def begin(self) -> None:
        """Start the processes, so that the first plan does not wait for them."""
        self._background.begin(self._warm())

    async def end(self) -> None:
        """End them."""
        for helper in (self.planning.helper, self.desk):
            await to_thread.run_sync(helper.close)
        await self._background.end()

    async def open_nest(self, path: Path, repair: bool = False, answers: Mapping[str, str] = NONE) -> Session:
        """The session of a nest in the folder; the one that is there, if it is open already.

        Answers to its questions are written into its job file once it can be read with them.
        """
        name = path.relative_to(self.folder.path).as_posix()
        key = hashlib.sha256(name.encode()).hexdigest()[:12]
        disk = text_of(path.with_name(beside_name(path.name)))
        if answers:
            disk = await self._answered(path, disk, repair, answers)
        read = (sha256_of(path), repair, disk)
        there = self.sessions.get(key)
        if there is not None and there.read == read:
            return there
        wanted = PlanRequest(str(path), self._first_text(disk, path), repair, trust=self._trust)
        opened = await self.asked("opened", wanted=wanted)
        there = self.sessions.get(key)  # the desk took its time, and another tab did not wait
        if there is None:
            there = self.sessions[key] = Session(key, name, wanted, opened, self.news, on_disk=disk)
        elif there.read != read:
            there.opened_again(wanted, opened, disk)
        return there

    async def drop(self, name: str, drawing: bytes, repair: bool = False, answers: Mapping[str, str] = NONE) -> Session:
        """The session of a drawing that was dropped on the page; it is written into the folder once it can be read."""
        with self._aside(name, drawing) as path:
            disk = text_of(self.folder.path / beside_name(name))
            await self.asked("opened", wanted=self._with_answers(path, disk, repair, answers))
        return await self.open_nest(self.folder.keep(name, drawing), repair, answers)

    async def preview(self, path: Path, repair: bool, answers: Mapping[str, str]) -> str:
        """The address of a picture of how a nest is understood with some answers; nothing is written."""
        disk = text_of(path.with_name(beside_name(path.name)))
        return str(await self.asked("preview", wanted=self._with_answers(path, disk, repair, answers)))

    async def preview_of_drop(self, name: str, drawing: bytes, repair: bool, answers: Mapping[str, str]) -> str:
        """The same of a drawing that was dropped on the page, and is not in the folder yet."""
        with self._aside(name, drawing) as path:
            return await self.preview(path, repair, answers)

    @contextmanager
    def _aside(self, name: str, drawing: bytes) -> Iterator[Path]:
        """A drawing in a folder of its own, for as long as nobody knows whether it can be read."""
        self.folder.expect_free(name, drawing)
        with tempfile.TemporaryDirectory() as aside:
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
        if text_of(job) != disk:
            raise InputError(f"{job.name} has changed on disk meanwhile: open the nest again")
        if text != disk:
            write_files({job: text})
        return text

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

    async def change_nest(self, session: Session, changes: list[str], name: str | None) -> dict[str, Any]:
        """Change the nest itself: under a name, a new nest in the folder that is opened; else what it would be."""
        told: dict[str, Any] = await self.asked("changed", wanted=session.wanted, changes=changes)
        text = told.pop("text")
        if name is None:
            return told
        if not name.lower().endswith(".json"):
            raise InputError(f"{escape_text(name)!r}: an edited nest is JSON: give a name ending in .json")
        opened = await self.open_nest(self.folder.keep(name, text.encode(), Path(session.wanted.nest)))
        return {**opened.as_json(), **told}

    async def want(self, session: Session, wanted: PlanRequest, **also: Any) -> None:
        """Want something else from now on."""
        version = session.version
        opened = await self.asked("opened", wanted=wanted)
        session.expect(version)
        session.changed(wanted=wanted, opened=opened, conflict=None, problem="", questions=[], **also)

    async def cut_up_to(self, session: Session, upto: int) -> None:
        """Count the first cuts of the shown plan as made."""
        await self.want(session, request_after_cuts(session, upto))

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


def _side(plan: Alternative) -> tuple[str, PlanRequest, str]:
    return f"plan {plan.number}", plan.wanted, plan.plan


# The folder that the server was started in: nests are read and files written there, and nowhere else.

MOST_NESTS = 2000
_NAME = re.compile(r"[^\x00-\x1f/\\:*?\"<>|]{1,150}")
_NOT_NESTS = (".plan.json", ".schema.json", ".settings.json")


@dataclass(frozen=True, slots=True)
class Folder:
    """A folder, by its real path."""

    path: Path

    def nests(self) -> Iterator[str]:
        """Names of the nests in it and in the folders below, `/` between; hidden ones are left out.

        A name that is no UTF-8 holds halves of characters that stand alone: no nest is opened by it (`is_readable`).
        """
        found = 0
        for path in sorted(self.path.rglob("*")):
            name = path.relative_to(self.path)
            if any(part.startswith(".") for part in name.parts) or not self._is_nest(path):
                continue
            found += 1
            if found > MOST_NESTS:
                return
            yield name.as_posix()

    def nest(self, name: str) -> Path:
        """The path of a nest by its name in this folder.

        Raises
        ------
        InputError
            If there is none, or it is not in this folder: a link that leads out of it counts as not there.
        """
        wanted = PurePosixPath(name)
        if wanted.is_absolute() or ".." in wanted.parts or "\\" in name or "\x00" in name or not wanted.parts:
            raise InputError(f"no nest of this folder has the name {escape_text(name)!r}")
        if not is_readable(name):
            raise InputError(f"{escape_text(name)!r} is no name in UTF-8: give the file, or its folder, another name")
        path = self.path.joinpath(*wanted.parts)
        try:
            inside = path.resolve().is_relative_to(self.path)
        except (OSError, ValueError, RuntimeError):
            inside = False
        if not inside or path.suffix.lower() not in SUFFIXES or not path.is_file():
            raise InputError(f"no nest of this folder has the name {escape_text(name)!r}")
        return path

    def keep(self, name: str, drawing: bytes, beside: Path | None = None) -> Path:
        """Write a drawing that was dropped on the page, or a nest beside another, unless it is there already; its path.

        Raises
        ------
        InputError
            As `expect_free` does.
        """
        folder = self.path if beside is None else beside.parent
        self.expect_free(name, drawing, folder)
        self.expect_inside([folder])
        path = folder / name
        if not path.exists():
            write_files({path: drawing})
        return path

    def expect_free(self, name: str, drawing: bytes, folder: Path | None = None) -> None:
        """Make sure that a drawing can be written under a name, in this folder or one in it.

        Raises
        ------
        InputError
            If the name is no plain name of a nest, or another drawing has it.
        """
        if not _NAME.fullmatch(name) or name.startswith(".") or Path(name).suffix.lower() not in SUFFIXES:
            raise InputError(f"{escape_text(name)!r}: expected the name of a drawing, ending in {', '.join(SUFFIXES)}")
        if name.lower().endswith(_NOT_NESTS):
            raise InputError(f"{escape_text(name)!r} is the name of a plan, or of settings, not of a drawing")
        path = (folder or self.path) / name
        if path.is_symlink() or path.exists():
            if path.is_file() and not path.is_symlink() and path.read_bytes() == drawing:
                return
            raise InputError(
                f"another file {escape_text(name)!r} is in the folder already: give the drawing another name"
            )

    def expect_inside(self, paths: Iterable[Path]) -> None:
        """Make sure that files are written in this folder, wherever links lead to.

        Raises
        ------
        InputError
            Naming the file that would be written elsewhere.
        """
        for path in paths:
            try:
                inside = path.resolve().is_relative_to(self.path)
            except (OSError, RuntimeError):
                inside = False
            if not inside:
                raise InputError("is a link that leads out of the folder: nothing is written there", file=path.name)

    def _is_nest(self, path: Path) -> bool:
        try:
            return (
                path.suffix.lower() in SUFFIXES
                and not path.name.lower().endswith(_NOT_NESTS)
                and path.is_file()
                and path.resolve().is_relative_to(self.path)
                and (path.suffix.lower() == ".dxf" or _begins_as_nest(path))
            )
        except (OSError, RuntimeError):
            return False


def is_readable(name: str) -> bool:
    """Whether a name is text; on Linux the name of a file may be any bytes.

    Examples
    --------
    >>> is_readable("Träger.dxf"), is_readable(b"Tr\\xe4ger.dxf".decode("utf-8", "surrogateescape"))
    (True, False)
    """
    return not any("\ud800" <= sign <= "\udfff" for sign in name)


def _begins_as_nest(path: Path) -> bool:
    """Whether an SVG or JSON file may be a nest: pictures that kerfwise drew are none, nor is any other JSON."""
    with path.open("rb") as file:
        head = file.read(4000)
    return b"kerfwise-nest/" in head if path.suffix.lower() == ".json" else b'id="sheet"' not in head


# Saves what a session shows: all files or none, and nothing over what somebody else has changed.


def save(session: Session, folder: Folder, profile_sha256: str) -> dict[str, Any]:
    """Write the shown plan's files and its job file, all of them or none; what was written, and the command line.

    `profile_sha256` is that of the profile as it is on disk now.

    Raises
    ------
    InputError
        If there is no plan, the check refuses it, the nest, the job file or the profile has changed on disk, a job
        file was saved that the plan was made without, a file is of another nest, or a link leads out of the folder.
    """
    current = session.current
    if current is None:
        raise InputError("there is no plan to save yet")
    if not current.ok:
        raise InputError(f"the check refuses this plan ({', '.join(current.broken)}): nothing is written")
    wanted, nest = current.wanted, Path(current.wanted.nest)
    if wanted.profile_now != session.wanted.profile_now:
        raise InputError("the profile has changed since this plan was made: plan again")
    job = nest.with_name(beside_name(nest.name))
    if sha256_of(nest) != current.sha256:
        raise InputError("the nest has changed on disk since this plan was made: open it again")
    if text_of(job) != session.on_disk:
        raise InputError(f"{job.name} has changed on disk since it was read: open the nest again")
    if wanted.job_text is None and session.on_disk is not None:
        raise InputError(f"{job.name} was saved since this plan was made, which goes without: plan again")
    if json.loads(current.plan)["profile"].get("sha256") != profile_sha256:
        raise InputError("the profile has changed on disk since this plan was made: plan again")
    files: dict[Path, str | bytes] = {nest.with_name(name): kept.text() for name, kept in current.files.items()}
    program, plan, picture = (nest.with_name(name) for name in output_names(nest))
    expect_own(nest, program, plan, picture)
    if wanted.old_plan is not None:
        before = nest.with_name(earlier_plan_name(wanted.nest))
        expect_own(nest, program, before, picture)
        files[before] = wanted.old_plan
    expect_outputs(files, (nest, job))
    folder.expect_inside((*files, job))
    if wanted.job_text is not None and wanted.job_text != session.on_disk:
        files[job] = wanted.job_text
    write_files(files)
    told = {
        "number": current.number,
        "files": [path.name for path in files],
        "command": current.command,
        "same_bytes": not current.stopped,
    }
    session.changed(saved=told, on_disk=wanted.job_text if wanted.job_text is not None else session.on_disk)
    return told


def text_of(job: Path) -> str | None:
    """What a job file says, to the byte; None where there is none."""
    try:
        return read_limited(job, MOST_BYTES_OF_YAML).decode("utf-8") if is_file(job) else None
    except UnicodeDecodeError:
        raise InputError("not a job file: it is no UTF-8 text", file=job.name) from None
