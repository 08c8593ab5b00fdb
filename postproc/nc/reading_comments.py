"""How the drawing was understood, at the top of a program: units, sheet, and what each layer was taken for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.reading import DONE
from kerfwise.postproc.dialects import Dialect

from .blocks import comment, plain

MOST = 8
"""Layers that a program names; `kerfwise read` names all."""


def reading_comments(nest: Nest, dialect: Dialect) -> Iterator[str]:
    """A comment on units and sheet of a drawing, and one for each layer; none for a nest that says what it is."""
    reading = nest.reading
    if reading is None or not reading.taken:
        return
    assumed = ", ASSUMED" if reading.assumed else ""
    yield comment(
        dialect,
        f"DRAWING READ IN {reading.units.upper()}, SHEET {plain(reading.sheet.replace('×', 'x')).upper()}{assumed}",
    )
    count: Counter[tuple[str, str]] = Counter()
    for row in reading.taken:
        count[row.layer, DONE[row.purpose]] += row.count
    rows = sorted(count.items())
    for (layer, done), lines in rows[:MOST]:
        yield comment(dialect, "LAYER", layer, f"{plain(done).upper()} {lines}")
    if len(rows) > MOST:
        yield comment(dialect, f"AND {len(rows) - MOST} MORE LAYERS")
    for question, choice in sorted(reading.answers.items()):
        yield comment(dialect, "ANSWERED", question, plain(choice).upper())
