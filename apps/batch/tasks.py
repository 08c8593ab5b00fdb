"""The tasks of a batch: nests that are found, new ones as they arrive, each on each machine."""

from __future__ import annotations

import contextlib
import os
import re
import time
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import is_file, is_folder
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.read import SUFFIXES
from kerfwise.jobs.inputs import DrawingSaid, Inputs, Tell, common_cuts_not_made, drawn_nest, plant_of, tabs_not_left
from kerfwise.jobs.nest_job import Job, job_beside, read_job
from kerfwise.jobs.nest_job.request import NestRequest, job_for, locked_for, profile_for
from kerfwise.rules.profile.load import DEFAULT, files_of
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.values import placing_notes

from .result import PLAN
from .store import key_of

# A piece of the batch: one nest on one machine, and all that its answer depends on.


@dataclass(frozen=True, slots=True)
class Options:
    """The options of `kerfwise solve` that hold for every nest of a batch."""

    work: float = 30.0
    time_s: float | None = None
    gap: float | None = None
    seed: int = 1
    memory_gb: float = 2.0
    relax: bool = False
    repair: bool = False


@dataclass(frozen=True, slots=True)
class NestTask:
    """One nest on one machine; `name` is the nest's in the folder of the batch, `out` that folder.

    `quantity`, `order` and `due` are those of its job file.
    """

    name: str
    source: Path
    machine: Machine
    options: Options
    version: str
    out: Path
    quantity: int = 1
    order: str = ""
    due: str = ""

    @property
    def last_plan(self) -> Path:
        """The plan of an earlier run, in which contours have the numbers that locks call them by."""
        return self.out / self.machine.name / f"{self.name}{PLAN}"

    def key(self) -> str:
        """The sha256 of all that the answer depends on: nest, profile with all that it is made of, options, version."""
        besides = {"version": self.version, "profile": self.machine.sha256, **asdict(self.options)}
        job = job_beside(self.source)
        return key_of([self.source] if job is None else [self.source, job], besides)


# Which nest is planned on which machine: on all of the batch, unless its job file names one.


@dataclass(frozen=True, slots=True)
class Machine:
    """A machine of the batch: its name there, its profile as the user names it, and what that profile is now.

    `plant` is the name that the profile has itself, `sha256` that of all that it is made of.
    """

    name: str
    profile: str
    sha256: str
    trust: bool = False
    plant: str = ""

    def is_called(self, name: str) -> bool:
        """Whether a job file means this one: by its name in the batch, or by that of its profile."""
        return name.casefold() in (self.name.casefold(), self.plant.casefold())


def machine_of(name: str, profile: str, trust: bool) -> Machine:
    """The machine as its profile is now. Raises InputError if the profile cannot be read."""
    plant = plant_of(profile, trust)
    return Machine(name, profile, plant.sha256, trust, plant.name)


def name_of(profile: str) -> str:
    """A name for a machine, after its profile.

    Examples
    --------
    >>> name_of("plants/big laser.yaml"), name_of("laser-wood")
    ('big-laser', 'laser-wood')
    """
    return re.sub(r"[^\w-]+", "-", Path(profile).stem).strip("-") or "machine"


@dataclass(slots=True)
class Machines:
    """The machines of a batch. Where the user has `named` none, each nest has that of its job file, or the default."""

    named: tuple[Machine, ...] = ()
    trust: bool = False
    _others: dict[str, Machine] = field(default_factory=dict)

    def now(self) -> Machines:
        """The same machines, as their profiles are now. Raises InputError if one cannot be read."""
        return Machines(tuple(machine_of(m.name, m.profile, m.trust) for m in self.named), self.trust)

    def of(self, job: Job | None) -> Sequence[Machine]:
        """The machines that a nest with this job file is planned on."""
        if self.named:
            called = [m for m in self.named if job is not None and job.machine is not None and m.is_called(job.machine)]
            return called or self.named
        return [self._other(DEFAULT if job is None or job.profile_path is None else job.profile_path)]

    def _other(self, profile: str) -> Machine:
        """The machine of a profile; one that cannot be read is refused where it is planned for."""
        if profile not in self._others:
            taken = {machine.name.casefold() for machine in self._others.values()}
            name, number = name_of(profile), 1
            while name.casefold() in taken:
                number += 1
                name = f"{name_of(profile)}-{number}"
            try:
                self._others[profile] = machine_of(name, profile, self.trust)
            except InputError:
                self._others[profile] = Machine(name, profile, "", self.trust)
        return self._others[profile]


def job_of(source: Path) -> Job | None:
    """The job file of a nest; None also where it is wrong, which is said when the nest is planned."""
    beside = job_beside(source)
    try:
        return None if beside is None else read_job(beside)
    except InputError:
        return None


class Changed(Exception):
    """Something is not what it was when the piece was handed out."""


def expect_same(piece: NestTask, key: str) -> None:
    """Refuse to go on where the files of a piece are not those that its key was made of."""
    if piece.key() != key:
        raise Changed("its file changed while it was planned, or is another one where it was planned")


def task_inputs(piece: NestTask, tell: Tell) -> Inputs:
    """The nest and its profile, with what its job file says; told is what `solve` says on standard error."""
    job, last = job_for(piece.source, None), piece.last_plan
    if job is not None and job.machine is not None and piece.machine.is_called(job.machine):
        job = replace(job, machine=None)  # it is on the machine that it names
    named = None if job is None else job.profile_path
    if job is not None and named is not None and Path(named).resolve() == Path(piece.machine.profile).resolve():
        job = replace(job, profile=None)  # and so with the profile
    request = NestRequest(_plant(piece.machine), last=last if is_file(last) else None)
    plant = profile_for(request, job, tell)
    drawn = drawn_nest(piece.source, plant, DrawingSaid(repair=piece.options.repair))
    inputs = locked_for(plant.as_cut(drawn), piece.source, plant, request, job, tell)
    for text in _notes(drawn, inputs):
        tell(text)
    return inputs


@lru_cache(maxsize=16)
def _plant(machine: Machine) -> Profile:
    """The profile of a machine, read once a process."""
    plant = plant_of(machine.profile, machine.trust)
    if plant.sha256 != machine.sha256:
        raise Changed(
            f"the profile {escape_text(machine.profile)} changed while the batch ran, or is another one there"
        )
    return plant


def _notes(drawn: Nest, inputs: Inputs) -> Iterator[str]:
    """What a planner should know of the nest, as `solve` says it on standard error."""
    if drawn.reading is not None and drawn.reading.taken:
        yield f"note: {drawn.reading.short()}"
    yield from (f"{note.severity}: {note.text}" for note in inputs.profile.without_losses(drawn).notes)
    if cut_all_the_same := tabs_not_left(drawn, inputs.profile):
        yield f"warning: {cut_all_the_same}"
    yield from (f"warning: {text}" for text in placing_notes(inputs.nest, inputs.profile))
    yield from (f"note: {text}" for text in (*inputs.profile.chart_notes(), *inputs.profile.time_and_price_notes()))
    if warning := common_cuts_not_made(inputs):
        yield f"note: {warning}"


# New files as they arrive: a folder is looked at again and again, and a file read once nobody writes it any more.
#
# Looking again works on every file system. Systems tell of changes on a share of another machine seldom or never, and
# that is where nests come from.

LOOK_S = 1.0
"""How long between one look and the next."""
SETTLED_S = 2.0
"""So long a file must have kept its size and time before it is read."""

Stand = tuple[int, int]
"""Size in bytes and time of the last change, ns."""


def file_stamp(file: Path) -> Stand | None:
    """How a file stands now; None where there is none."""
    with contextlib.suppress(OSError, ValueError):
        found = file.stat()
        return found.st_size, found.st_mtime_ns
    return None


@dataclass(slots=True)
class Settling:
    """Which files nobody writes any more, by what was seen of them before.

    Examples
    --------
    >>> settling = Settling()
    >>> stands = {Path("a.dxf"): (10, 1)}
    >>> [[file.name for file in settling.settled(stands, now_s)] for now_s in (0.0, 1.0, 2.5)]
    [[], [], ['a.dxf']]
    """

    _seen: dict[Path, tuple[Stand, float]] = field(default_factory=dict)

    def settled(self, stands: dict[Path, Stand], now_s: float) -> dict[Path, Stand]:
        """Of the files that there are, those that have stood as they do for `SETTLED_S`, each with how it stands."""
        before, self._seen = self._seen, {}
        for file, stand in stands.items():
            known = before.get(file)
            self._seen[file] = known if known is not None and known[0] == stand else (stand, now_s)
        return {file: stand for file, (stand, since_s) in self._seen.items() if now_s - since_s >= SETTLED_S}


def watch(
    files: Callable[[], Iterable[Path]],
    arrived: Callable[[frozenset[Path]], object],
    *,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> None:
    """Call `arrived` with all files that are settled, each time that one of them is new, changed or gone.

    One that is being written again counts as it was until it is settled. It ends with what `arrived` or `sleep`
    raises, such as KeyboardInterrupt.
    """
    settling = Settling()
    done: dict[Path, Stand] = {}
    while True:
        stands = {file: stand for file in files() if (stand := file_stamp(file)) is not None}
        settled = settling.settled(stands, clock())
        known = {file: stand for file, stand in done.items() if file in stands} | settled
        if known != done:
            arrived(frozenset(settled))
            done = known
        sleep(LOOK_S)


# The nests of a batch: the files that are found, and a name for each in the folder of the batch.

_OWN = re.compile(rb'"format":\s*"kerfwise-(?!nest/)|<g id="sheet">')
"""What stands at the top of a file that kerfwise wrote and that is no nest: a plan, a picture."""
_HEAD_BYTES = 4000


@dataclass(frozen=True, slots=True)
class Source:
    """The file of a nest, and the name that it would have in the folder of the batch: its place, without the ending."""

    file: Path
    name: str


def sources_in(paths: Iterable[Path], out: Path) -> tuple[Source, ...]:
    """Every nest among files and folders, once: in the order in which they are given, in folders by their names.

    In a folder a nest is a file that ends as one. Hidden files, plans and pictures that kerfwise wrote are passed over,
    and `out` where it lies in the folder. A folder that is given is read, also where it is `out` or lies in it. Raises
    InputError if there is no such file or folder, or a file is of another kind.
    """
    found: dict[Path, Source] = {}
    for place in paths:
        if is_folder(place):
            of_place: Iterable[Source] = _under(place, out)
        elif not is_file(place):
            raise InputError("there is no such file or folder", file=place)
        elif place.suffix.lower() not in SUFFIXES:
            raise InputError(f"no nest ends so: expected a folder, or a file in {', '.join(SUFFIXES)}", file=place)
        else:
            of_place = [Source(place.resolve(), place.stem)]
        for source in of_place:
            found.setdefault(source.file, source)
    return tuple(found.values())


def _under(folder: Path, out: Path) -> Iterator[Source]:
    beside, found = out.resolve(), []
    for place, folders, files in os.walk(folder):
        here = Path(place)
        folders[:] = sorted(name for name in folders if name[0] != "." and (here / name).resolve() != beside)
        found += [here / name for name in files if name[0] != "." and Path(name).suffix.lower() in SUFFIXES]
    for file in sorted(found):
        if not _is_own(file):
            yield Source(file.resolve(), file.relative_to(folder).with_suffix("").as_posix())


def _is_own(file: Path) -> bool:
    try:
        with file.open("rb") as opened:
            return _OWN.search(opened.read(_HEAD_BYTES)) is not None
    except OSError:  # gone, or not to be read: the batch says so
        return False


def name_sources(sources: Iterable[Source], before: Mapping[str, Path]) -> dict[str, Source]:
    """The sources by the names that they get, no two of which are one file name anywhere.

    A name that another file has already is given with -2, -3, … behind it. `before` are the names that an earlier run
    gave: a file keeps its name, and takes none whose file is still there.

    Examples
    --------
    >>> a, b = Source(Path("monday/a.dxf"), "a"), Source(Path("tuesday/a.dxf"), "a")
    >>> [(name, source.file.parent.name) for name, source in name_sources([a, b], {}).items()]
    [('a', 'monday'), ('a-2', 'tuesday')]
    """
    sources = tuple(sources)
    had = {file: name for name, file in before.items()}
    kept = {source.file: had[source.file] for source in sources if source.file in had}
    taken = {_alike(name) for name, file in before.items() if file in kept or is_file(file)}
    names: dict[str, Source] = {}
    for source in sources:
        name, number = kept.get(source.file, source.name), 1
        while source.file not in kept and _alike(name) in taken:
            number += 1
            name = f"{source.name}-{number}"
        taken.add(_alike(name))
        names[name] = source
    return names


def _alike(name: str) -> str:
    """One text for all names that some system takes for one."""
    return unicodedata.normalize("NFC", name).casefold()


# A batch that never ends: a round whenever nests, their profiles or their job files have changed.

Round = Callable[[Sequence[Source], Machines], object]


def keep_on(paths: Sequence[Path], out: Path, machines: Machines, one_round: Round, tell: Tell) -> None:
    """A round for all nests that are there, and one each time that something has changed, until Ctrl-C.

    A profile that cannot be read is told, and waited for. Where no machine is named, the profiles that job files name
    are looked at; of one of these that cannot be read the batch itself says so. Raises InputError if one cannot be read
    at the start.
    """
    found: tuple[Source, ...] = sources_in(paths, out)
    profiles = [files_of(plant_of(machine.profile, machine.trust)) for machine in machines.named]
    profiles = profiles or _of_jobs(found, machines.trust)

    def files() -> Iterable[Path]:
        nonlocal found
        with contextlib.suppress(InputError):  # a share that is away for a while
            found = sources_in(paths, out)
        for source in found:
            yield source.file
            yield from _jobs(source)
        for of in profiles:
            yield from of

    def arrived(settled: frozenset[Path]) -> None:
        nonlocal profiles
        if not machines.named:
            before, profiles = profiles, _of_jobs(found, machines.trust)
            if _there(before) != _there(profiles):
                return  # once the others are looked at and settled, this is called again
        if any(file not in settled and is_file(file) for of in profiles for file in of):
            return  # a profile is being written: once it is settled, this is called again
        try:
            now = machines.now()
        except InputError as error:
            tell(f"{error}; nothing is planned until it can be read")
            return
        one_round([source for source in found if settled.issuperset([source.file, *_jobs(source)])], now)

    watch(files, arrived)


def _of_jobs(found: Iterable[Source], trust: bool) -> list[tuple[Path, ...]]:
    """The files of each profile that a nest is planned by where no machine is named."""
    machines = Machines(trust=trust)
    named = {machine.profile for source in found for machine in machines.of(job_of(source.file))}
    profiles = []
    for name in sorted(named):
        try:
            profiles.append(files_of(plant_of(name, trust)))
        except InputError:
            profiles.append((Path(name),))
    return profiles


def _there(profiles: Iterable[tuple[Path, ...]]) -> set[Path]:
    return {file for of in profiles for file in of if is_file(file)}


def _jobs(source: Source) -> list[Path]:
    beside = job_beside(source.file)
    return [] if beside is None else [beside]
