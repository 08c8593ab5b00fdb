"""Values as MiniZinc data text: what plans are made with and what the check measures are written alike.

Contours and candidates count from 1 there, a relation is an array of bools such as `contains[i, j]`, and every length
is an integer in hundredths of a millimetre, so that solvers without floats can read it.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Fields = list[tuple[str, str]]
"""Names and values, as text."""
PER_MM = 100


def include(path: Path) -> str:
    """The line that includes a file."""
    return f"include {json.dumps(path.as_posix(), ensure_ascii=False)};"


def assignments(fields: Fields) -> str:
    """Data text, a line each."""
    return "".join(f"{name} = {value};\n" for name, value in fields)


def flag(value: object) -> str:
    """A bool."""
    return "true" if value else "false"


def flags(values: Iterable[object]) -> str:
    """An array of bools."""
    return f"[{', '.join(map(flag, values))}]"


def numbers(values: Iterable[int]) -> str:
    """An array of whole numbers."""
    return f"[{', '.join(str(int(v)) for v in values)}]"


def numbers_from_1(values: Iterable[int]) -> str:
    """An array of numbers of contours or candidates, which count from 0 here."""
    return numbers(v + 1 for v in values)


def number_set(values: Iterable[int]) -> str:
    """A set of whole numbers."""
    return "{" + ", ".join(map(str, sorted(values))) + "}"


def texts(values: Iterable[str]) -> str:
    """An array of texts."""
    return f"[{', '.join(json.dumps(v, ensure_ascii=False) for v in values)}]"


def lengths(values_mm: Iterable[float]) -> str:
    """An array of lengths; 0 for one that is not known."""
    return numbers(round(v * PER_MM) if math.isfinite(v) else 0 for v in values_mm)


def relation(pairs: Iterable[Sequence[int]], n: int) -> str:
    """Pairs of n contours as a square array of bools."""
    holds = np.zeros((n, n), dtype=bool)
    for i, j in pairs:
        holds[i, j] = True
    return _rows((map(flag, row) for row in holds.tolist()), n)


def length_table(rows_mm: Iterable[Iterable[float]], width: int) -> str:
    """Rows of `width` lengths each."""
    return _rows(((str(round(v * PER_MM)) for v in row) for row in rows_mm), width)


def _rows(rows: Iterable[Iterable[str]], width: int) -> str:
    """A 2-D array; one without rows keeps its number of columns."""
    lines = [", ".join(row) for row in rows]
    return "[| " + "\n   | ".join(lines) + " |]" if lines else f"array2d(1..0, 1..{width}, [])"


def table_from_0(values: NDArray[np.int64]) -> str:
    """A square table whose rows and columns count from 0."""
    last = len(values) - 1
    rows = ",\n  ".join(", ".join(map(str, row)) for row in values.tolist())
    return f"array2d(0..{last}, 0..{last}, [\n  {rows}])"


Facing = Iterable[tuple[int, int, float]]
"""Who faces whom, both counted from 0, and for how long, mm."""


def stretch_fields(
    name: str, total_mm: Iterable[float], edge_mm: Iterable[float], solid_mm: Iterable[float], facing: Facing
) -> Fields:
    """A stretch of every candidate's path, `head` or `tail`: its length, what of it faces edge, solid and contours."""
    rows = list(facing)
    return [
        (f"{name}_length", lengths(total_mm)),
        (f"{name}_edge", lengths(edge_mm)),
        (f"{name}_solid", lengths(solid_mm)),
        (f"n_{name}", str(len(rows))),
        (f"{name}_cand", numbers_from_1(i for i, _, _ in rows)),
        (f"{name}_contour", numbers_from_1(j for _, j, _ in rows)),
        (f"{name}_facing", lengths(mm for _, _, mm in rows)),
    ]
