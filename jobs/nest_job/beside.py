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
    beside = path.with_name(beside_name(path)) if path.stem else None
    return beside if beside is not None and is_file(beside) else None


def beside_name(nest: str | Path) -> str:
    """What the job file of a nest is called."""
    return f"{Path(nest).stem}{ENDING}"


def misnamed(nest: str | Path) -> Path | None:
    """A file beside a nest that is nearly called as its job file would be; None where there is none."""
    path = Path(nest)
    nearly = (f"{path.name}{ENDING}", f"{path.stem}.job.yml", f"{path.stem}.job.json", f"{path.stem}.job")
    return next((file for name in nearly if path.stem and is_file(file := path.with_name(name))), None)
