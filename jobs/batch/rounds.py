"""A batch that never ends: a round whenever nests, their profiles or their job files have changed."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from kerfwise.encoder.contents import is_file
from kerfwise.encoder.errors import InputError
from kerfwise.jobs.given import Tell, plant_of
from kerfwise.jobs.nest_job import job_beside
from kerfwise.rules.profile.made_of import files_of

from .machines import Machines, job_of
from .sources import Source, sources_in
from .watch import watch

Round = Callable[[Sequence[Source], Machines], object]


def keep_on(given: Sequence[Path], out: Path, machines: Machines, one_round: Round, tell: Tell) -> None:
    """A round for all nests that are there, and one each time that something has changed, until Ctrl-C.

    A profile that cannot be read is told, and waited for. Where no machine is named, the profiles that job files name
    are looked at; of one of these that cannot be read the batch itself says so.

    Raises
    ------
    InputError
        If one cannot be read at the start.
    """
    found: tuple[Source, ...] = sources_in(given, out)
    profiles = [files_of(plant_of(machine.profile, machine.trust)) for machine in machines.named]
    profiles = profiles or _of_jobs(found, machines.trust)

    def files() -> Iterable[Path]:
        nonlocal found
        with contextlib.suppress(InputError):  # a share that is away for a while
            found = sources_in(given, out)
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
