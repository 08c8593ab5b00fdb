"""What a program says of how the machine is to be set, and of the chart that says so; an operator reads it.

(CHART shop.csv ROW S235, 8 MM SHA256 1a2b3c4d5e6f)
(INTERPOLATED KERF 1.7 MM BETWEEN 6 MM AND 10 MM)
(NOT OF THE CHART KERF 1.8 MM)
(SET 85 A, GAS O2/AIR, PIERCE HEIGHT 3.8 MM, CUT HEIGHT 1.5 MM)
"""

from __future__ import annotations

from collections.abc import Iterator

from kerfwise.postproc.dialects import Dialect
from kerfwise.rules.profile.profile import Profile

from .blocks import comment, number, room_for
from .plan_paths import SHA_DIGITS


def setting_comments(profile: Profile, dialect: Dialect) -> Iterator[str]:
    """The comments; none where the profile has no chart and says nothing of the machine's setting."""
    use = profile.chart
    if use is not None:
        yield comment(dialect, "CHART", f"{use.name} ROW {use.row}", f"SHA256 {use.sha256[:SHA_DIGITS]}")
        for one in use.interpolated:
            between = f"BETWEEN {' AND '.join(one.between).upper()}"
            yield comment(dialect, f"INTERPOLATED {_spoken(one.column)}", one.text.upper(), between)
        for column, _, own in use.beaten:
            yield comment(dialect, f"NOT OF THE CHART {_spoken(column)}", own.upper())
    line = ""
    for text in _settings(profile):
        if line and len(line) + 2 + len(text) > room_for(dialect, "SET"):
            yield comment(dialect, "SET", line)
            line = ""
        line = f"{line}, {text}" if line else text
    if line:
        yield comment(dialect, "SET", line)


def _settings(profile: Profile) -> Iterator[str]:
    material = profile.material
    quantities = (
        ("{} A", material.amps),
        ("{} V", material.volts),
        ("POWER {} PERCENT", material.power),
        ("PIERCE POWER {} PERCENT", material.pierce_power),
        ("MARK POWER {} PERCENT", material.mark_power),
        ("PIERCE HEIGHT {} MM", material.pierce_height_mm),
        ("CUT HEIGHT {} MM", material.cut_height_mm),
    )
    yield from (text.format(number(value, 3)) for text, value in quantities if value is not None)
    if material.gas is not None:
        yield f"GAS {material.gas.upper()}"


def _spoken(column: str) -> str:
    return column.replace("_", " ").upper()
