"""Values as MiniZinc data text."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

Fields = list[tuple[str, str]]
"""Names and values, as text."""


def assignments(fields: Fields) -> str:
    """Data text, a line each."""
    return "".join(f"{name} = {value};\n" for name, value in fields)


def flag(value: bool) -> str:
    """A bool."""
    return "true" if value else "false"


def flags(values: Iterable[bool]) -> str:
    """An array of bools."""
    return f"[{', '.join(map(flag, values))}]"


def numbers(values: Iterable[int]) -> str:
    """An array of whole numbers."""
    return f"[{', '.join(str(int(v)) for v in values)}]"


def number_set(values: Iterable[int]) -> str:
    """A set of whole numbers."""
    return "{" + ", ".join(map(str, sorted(values))) + "}"


def table_from_0(values: NDArray[np.int64]) -> str:
    """A square table whose rows and columns count from 0."""
    last = len(values) - 1
    rows = ",\n  ".join(", ".join(map(str, row)) for row in values.tolist())
    return f"array2d(0..{last}, 0..{last}, [\n  {rows}])"
