"""Where the job file of a nest is looked for: beside it, under its name."""

from __future__ import annotations

from pathlib import Path

from kerfwise.encoder.contents import is_file

ENDING = ".job.yaml"


def job_beside(nest: str | Path) -> Path | None:
    """The job file beside a nest's file, `plate.job.yaml` for `plate.dxf`; None where there is none.

    Examples
    --------
    >>> job_beside("examples/nests/e1x_6.dxf") is None
    True
    """
    path = Path(nest)
    beside = path.with_name(f"{path.stem}{ENDING}") if path.stem else None
    return beside if beside is not None and is_file(beside) else None
