"""A material chart from its file: CSV, YAML, or QtPlasmaC's own material file."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Literal

from kerfwise.encoder.contents import MOST_BYTES_OF_YAML, contents
from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.yaml_positions import Problems

from .chart import Chart, ChartRow
from .csv_rows import csv_rows
from .qtplasmac_rows import qtplasmac_rows
from .yaml_rows import yaml_rows

ChartUnits = Literal["mm", "inch"]


def read_chart(path: str | Path, units: ChartUnits = "mm") -> Chart:
    """Read a chart; `units` are those of QtPlasmaC's files, which do not say theirs.

    Raises
    ------
    InputError
        If it cannot be read, or has a wrong column, unit or value anywhere: with file and line, all mistakes at once.
    """
    file = str(path)
    try:
        data = contents(path, MOST_BYTES_OF_YAML)
    except OSError as error:
        raise InputError(f"cannot read the material chart: {error.strerror}", file=file) from None
    except ValueError as error:  # a NUL, or half a character
        raise InputError(f"cannot read the material chart: no file can have this name ({error})", file=file) from None
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise InputError("not a material chart: it is not UTF-8 text; save it as UTF-8", file=file, line=line) from None
    problems = Problems(file)
    rows = _rows(text, Path(path), problems, units)
    problems.raise_any()
    if not rows:
        raise InputError("the material chart has no rows", file=file, line=1)
    return Chart(file, hashlib.sha256(data).hexdigest(), tuple(rows))


def _rows(text: str, path: Path, problems: Problems, units: ChartUnits) -> list[ChartRow]:
    match path.suffix.lower():
        case ".csv":
            return csv_rows(text, problems)
        case ".yaml" | ".yml":
            return yaml_rows(text, problems)
        case ".cfg":
            return qtplasmac_rows(text, problems, units)
    raise InputError(
        "a material chart is a .csv, a .yaml, or a .cfg of QtPlasmaC (…_material.cfg): rename it, or give another",
        file=path,
    )
