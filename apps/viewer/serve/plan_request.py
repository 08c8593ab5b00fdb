"""What is to be planned, and what passes between the server and its processes: plain texts, nothing worked out."""

from __future__ import annotations

import hashlib
import os
import shlex
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from kerfwise.encoder.already_cut import NOTHING_CUT, AlreadyCut
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.read import file_bytes
from kerfwise.jobs.inputs import DrawingSaid, Inputs, Tell, drawn_nest, silent
from kerfwise.jobs.nest_job.job import Job, beside_name, job_of
from kerfwise.jobs.nest_job.request import NestRequest, locked_for, profile_for
from kerfwise.jobs.resume import already_cut
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import plan_in
from kerfwise.rules.profile.profile import Profile

BOM = "\ufeff"


@dataclass(frozen=True, slots=True)
class PlanRequest:
    """What is to be planned.

    Attributes
    ----------
    nest
        Path of the nest's file.
    job_text
        What the job file beside it says, or is to say; None for no job file.
    repair
        Whether the drawing is mended.
    old_plan, upto
        The plan that is cut already up to this number, as JSON; None and 0 where nothing is cut.
    trust
        Whether Python rules that the profile names are run.
    profile_now
        What tells the profile's file of now from what it was before the page wrote it; "" where it has not.
    """

    nest: str
    job_text: str | None = None
    repair: bool = False
    old_plan: str | None = None
    upto: int = 0
    trust: bool = False
    profile_now: str = ""

    @property
    def key(self) -> str:
        """The same for the same thing to be planned, and for no other."""
        stands = [
            self.nest,
            self.job_text,
            self.repair,
            self.old_plan,
            self.upto,
            self.profile_now,
            sha256_of(Path(self.nest)),
        ]
        return _sha256(repr(stands).encode())

    def command(self, options: str = "", on: bool = False) -> str:
        """The command line that makes the same files, once the job file is saved.

        `on` for a plan that goes on from another, which is saved, too.

        Examples
        --------
        >>> PlanRequest("/nests/plate.dxf", repair=True).command()
        'kerfwise solve plate.dxf --repair'
        >>> PlanRequest("/nests/$(ls) 1.dxf").command()
        "kerfwise solve '$(ls) 1.dxf'"
        >>> PlanRequest("/nests/-o.dxf").command()
        'kerfwise solve ./-o.dxf'
        """
        names = Path(self.nest).name, earlier_plan_name(self.nest), start_plan_name(self.nest)
        name, before, start = map(_on_command_line, names)
        again = f" --lock-from {before} --upto {self.upto}" if self.old_plan else ""
        again += f" --start {start}" if on else ""
        return f"kerfwise solve {name}{' --repair' if self.repair else ''}{again}{options}"


def _on_command_line(name: str) -> str:
    """The name of a file, quoted where that is needed; one that begins as an option does is no option."""
    return shlex.quote(f"./{name}" if name.startswith("-") else name)


def earlier_plan_name(nest: str) -> str:
    """The name of the plan that is kept beside a nest because a part of it is cut already.

    Examples
    --------
    >>> earlier_plan_name("/nests/plate.dxf")
    'plate.before.plan.json'
    """
    return f"{Path(nest).stem}.before.plan.json"


def start_plan_name(nest: str) -> str:
    """The name of the plan that is kept beside a nest because its plan goes on from that."""
    return f"{Path(nest).stem}.start.plan.json"


def job_in(wanted: PlanRequest) -> Job | None:
    """The job that is wanted, as if its file stood beside the nest already.

    Raises InputError if it is wrong anywhere, with line and column.
    """
    if wanted.job_text is None:
        return None
    sha256 = _sha256(wanted.job_text.encode())
    return replace(job_of(wanted.job_text.removeprefix(BOM), beside_name(Path(wanted.nest).name)), sha256=sha256)


def enter_nest_folder(wanted: PlanRequest) -> str:
    """Go to the nest's folder: names in messages and plans are then as on the command line there. The nest's name."""
    path = Path(wanted.nest)
    os.chdir(path.parent)
    return path.name


def request_inputs(wanted: PlanRequest, tell: Tell = silent) -> Inputs:
    """Nest and profile, read as `kerfwise solve` reads them in the nest's folder.

    Raises InputError if something cannot be read, or is wrong: with its place.
    """
    name = enter_nest_folder(wanted)
    job = job_in(wanted)
    request = NestRequest(job=False if job is None else job, last=old_plan(wanted), trust=wanted.trust)
    plant = profile_for(request, job, tell)
    read, as_cut = _nest_by(wanted, plant)
    for note in read.notes:
        tell(f"{note.severity}: {note.text}")
    return locked_for(as_cut, name, plant, request, job, tell)


_MOST_READ = 3
_read: list[tuple[tuple[str, str, bool], Profile, Nest, Nest]] = []
"""The last nests that this process has read: another lock changes neither the drawing nor how it is cut."""


def _nest_by(wanted: PlanRequest, plant: Profile) -> tuple[Nest, Nest]:
    """The nest as it is drawn, and as a profile has it cut."""
    key = wanted.nest, sha256_of(Path(wanted.nest)), wanted.repair
    for known, by, *nests in _read:
        if known == key and by == plant:
            return nests[0], nests[1]
    read = drawn_nest(Path(wanted.nest).name, plant, DrawingSaid(repair=wanted.repair))
    _read[:] = [(key, plant, read, plant.as_cut(read)), *_read][:_MOST_READ]
    return read, _read[0][-1]


def old_plan(wanted: PlanRequest) -> Plan | None:
    """The plan that is cut in part."""
    return None if wanted.old_plan is None else plan_in(wanted.old_plan, earlier_plan_name(wanted.nest))


def already_of(wanted: PlanRequest, inputs: Inputs) -> AlreadyCut:
    """What is cut already."""
    old = old_plan(wanted)
    return NOTHING_CUT if old is None else already_cut(inputs, old, wanted.upto)


def sha256_of(nest: Path) -> str:
    """Of a nest's file as it is now; InputError if it cannot be read."""
    return _sha256(file_bytes(nest))


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


# What passes between the server and a process of it: questions with their answers, and what is told meanwhile.

Answers = Mapping[str, Callable[..., Any]]
"""Question → what answers it."""
STOP, SUPERSEDE = "stop", "supersede"
"""What is sent beside a question: to answer with what there is, or not at all."""


class Superseded(Exception):
    """Nobody wants the answer any more: something else is asked instead."""


class Questions:
    """Whoever has asked: told what is reached, and asked whether the answer is still wanted."""

    def __init__(self, way: Connection, stop: Connection) -> None:
        self._way, self._stop, self._stopped, self._superseded = way, stop, False, False
        self._telling = threading.Lock()

    def tell(self, **told: Any) -> None:
        """Tell something before the answer; any thread may."""
        with self._telling:
            self._way.send(("heard", told))

    @property
    def stopped(self) -> bool:
        """Whether the answer is to come to its end now, with what there is."""
        while self._stop.poll():
            self._superseded |= self._stop.recv() == SUPERSEDE
            self._stopped = True
        return self._stopped

    def go_on(self) -> bool:
        """Whether there is time for a better answer; Superseded where nobody wants any."""
        stopped = self.stopped
        if self._superseded:
            raise Superseded
        return not stopped

    def begin(self) -> None:
        """Forget what was to be stopped before."""
        while self._stop.poll():
            self._stop.recv()
        self._stopped = self._superseded = False
