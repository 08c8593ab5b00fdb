"""Which nest is planned on which machine: on all of the batch, unless its job file names one."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.given import plant_of
from kerfwise.jobs.nest_job import Job, job_beside, read_job
from kerfwise.rules.profile.load import DEFAULT


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
    """The machine as its profile is now.

    Raises
    ------
    InputError
        If the profile cannot be read.
    """
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
        """The same machines, as their profiles are now.

        Raises
        ------
        InputError
            If one cannot be read.
        """
        return Machines(tuple(machine_of(m.name, m.profile, m.trust) for m in self.named), self.trust)

    def of(self, job: Job | None) -> Sequence[Machine]:
        """The machines that a nest with this job file is planned on."""
        if self.named:
            asked = [m for m in self.named if job is not None and job.machine is not None and m.is_called(job.machine)]
            return asked or self.named
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
