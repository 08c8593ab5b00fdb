"""Runs one engine on one file in a process of its own, so that its memory can be told from that of others."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass

from kerfwise.encoder.errors import InputError
from kerfwise.models.engines.names import Engine
from kerfwise.models.engines.solution import MEMORY_GB


@dataclass(frozen=True, slots=True)
class BenchJob:
    """What is to be run: a routing instance or a nest, and the limits (see `SolveOptions`)."""

    path: str
    engine: Engine = "portfolio"
    seed: int = 1
    work: float = 30.0
    time_s: float | None = None
    profile: str = ""
    trust: bool = False
    memory_gb: float = MEMORY_GB


@dataclass(frozen=True, slots=True)
class BenchResult:
    """What came of it.

    `cost` is in the file's own unit (mm of objective for nests), judged by code that shares nothing with the engines;
    `bound` is None where nothing is proven. `tour` holds the file's vertex numbers, contour ids for nests. `feasible`
    says that the judge found nothing wrong, `fault` what it found. `seconds` are wall-clock, from the file read to the
    answer, kernels loaded, `processor_s` those of all threads of the process in that time; `memory_mb` is the most the
    process held, the interpreter and its libraries included.
    """

    instance: str
    engine: Engine
    cost: float | None
    bound: float | None
    proven: bool
    feasible: bool
    seconds: float
    memory_mb: float
    tour: tuple[int | str, ...]
    fault: str = ""
    processor_s: float = 0.0


def measure(job: BenchJob) -> BenchResult:
    """Run a job and wait for it.

    Raises
    ------
    InputError
        If the file cannot be read, or the process dies, for example because memory runs out.
    """
    given = json.dumps({name: getattr(job, name) for name in job.__slots__})
    command = [sys.executable, "-X", "utf8", "-m", f"{__package__}.child"]
    with subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        errors="replace",
        start_new_session=True,
        creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),  # the same on Windows
    ) as child:
        try:
            answer, said = child.communicate(given)
        except KeyboardInterrupt:
            child.kill()
            raise
    if child.returncode == 2:
        message, *details = said.strip().splitlines() or ["the file cannot be read"]
        raise InputError(message, details=tuple(line.removeprefix("  - ") for line in details))
    if child.returncode != 0:
        last = said.strip().splitlines()[-1:] or [f"exit code {child.returncode}"]
        raise InputError(f"the engine {job.engine} ended with an error: {last[0]}", file=job.path)
    fields = json.loads(answer)
    return BenchResult(**{**fields, "tour": tuple(fields["tour"])})
