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

from .machines import Machines
from .sources import Source, sources_in
from .watch import watch

Round = Callable[[Sequence[Source], Machines], object]


def keep_on(given: Sequence[Path], out: Path, machines: Machines, one_round: Round, tell: Tell) -> None:
    """A round for all nests that are there, and one each time that something has changed, until Ctrl-C.

    A profile that cannot be read is told, and waited for.

    Raises
    ------
    InputError
        If one cannot be read at the start.
    """
    found: tuple[Source, ...] = sources_in(given, out)

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
        if any(file not in settled and is_file(file) for of in profiles for file in of):
            return  # a profile is being written: once it is settled, this is called again
        try:
            now = machines.now()
        except InputError as error:
            tell(f"{error}; nothing is planned until it can be read")
            return
        one_round([source for source in found if settled.issuperset([source.file, *_jobs(source)])], now)

    profiles = [files_of(plant_of(machine.profile, machine.trust)) for machine in machines.named]
    watch(files, arrived)


def _jobs(source: Source) -> list[Path]:
    beside = job_beside(source.file)
    return [] if beside is None else [beside]
