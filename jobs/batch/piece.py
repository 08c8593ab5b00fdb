"""A piece of the batch: one nest on one machine, and all that its answer depends on."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

from kerfwise.jobs.content_key import key_of
from kerfwise.jobs.nest_job import job_beside

from .machines import Machine
from .row import PLAN


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
class Piece:
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
