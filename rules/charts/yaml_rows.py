"""A material chart as YAML: a list of rows, each a mapping of columns. A bare number has the unit that a profile's has.

- {material: S235, thickness: 6 mm, kerf: 1.5 mm, feed: 2500 mm/min, pierce_delay: 0.5 s, gas: O2/air}
"""

from __future__ import annotations

from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, compose, entries, is_empty, items

from .cells import cell
from .chart import ChartRow, Value
from .columns import COLUMNS


def yaml_rows(text: str, problems: Problems) -> list[ChartRow]:
    """The rows; what is wrong is noted."""
    try:
        root = compose(text, problems.file)
    except InputError as error:
        if error.line is None and "nested" in error.message:
            raise InputError("not a material chart: nested too deeply", file=problems.file, line=1) from None
        raise
    rows = []
    for node in items(root, problems, "a material chart") if root is not None else ():
        values: dict[str, Value] = {}
        lines: dict[str, int] = {}
        for name, key, value in entries(node, problems, "row"):
            if name not in COLUMNS:
                problems.add(key, unknown("column", name, COLUMNS))
            elif not is_empty(value):
                try:
                    values[name] = cell(name, value)
                    lines[name] = value.start_mark.line + 1
                except Unfit as error:
                    problems.add(error.node or value, f"{name}: {error}")
        called = values.get("name")
        names = (called,) if isinstance(called, str) else ()
        rows.append(ChartRow(node.start_mark.line + 1, values, names, lines))
    return rows
