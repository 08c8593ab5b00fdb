"""A batch that never ends: a round whenever nests, their profiles or their job files have changed."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from kerfwise.encoder.contents import is_file
from kerfwise.encoder.errors import InputError
from kerfwise.jobs.given import Tell, plant_of
from kerfwise.rules.profile.made_of import files_of

from .piece import Machine
from .sources import Source, sources_in
from .watch import watch

Round = Callable[[Sequence[Source], Sequence[Machine]], object]


def machine_of(name: str, profile: str, trust: bool) -> Machine:
    """The machine as its profile is now.

    Raises
    ------
    InputError
        If the profile cannot be read.
    """
    return Machine(name, profile, plant_of(profile, trust).sha256, trust)


def keep_on(given: Sequence[Path], out: Path, machines: Sequence[Machine], one_round: Round, tell: Tell) -> None:
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
        yield from (source.file for source in found)
        for machine in machines:
            yield from profiles[machine.name]

    def arrived(settled: frozenset[Path]) -> None:
        if any(file not in settled and is_file(file) for of in profiles.values() for file in of):
            return  # a profile is being written: once it is settled, this is called again
        try:
            now = [machine_of(machine.name, machine.profile, machine.trust) for machine in machines]
        except InputError as error:
            tell(f"{error}; nothing is planned until it can be read")
            return
        one_round([source for source in found if source.file in settled], now)

    profiles = {machine.name: files_of(plant_of(machine.profile, machine.trust)) for machine in machines}
    watch(files, arrived)
