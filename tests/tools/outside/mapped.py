"""Programs of other controls in LinuxCNC's words, block for block, so that its interpreter can read their geometry.

The mapping is ours and proves nothing; what the interpreter then makes of units, positions, arcs and feeds does.
"""

from __future__ import annotations

import re

_NUMBER = re.compile(r"^N\d+ ")
_EIA = {"M07": "M3 $0 S1", "M08": "M5 $0", "M09": "M3 $1 S1", "M10": "M5 $1", "M50": "", "M51": "", "M02": "M2"}
_BURNY = {"M04": "M3 $0 S1", "M03": "M5 $0", "G71": "G21", "G90": "G90 G90.1"}


def in_linuxcnc(text: str, control: str) -> str:
    """The program in words that LinuxCNC knows; one for LinuxCNC stays as it is."""
    if control.startswith("linuxcnc"):
        return text
    rows = [_NUMBER.sub("", row) for row in text.split("\n")]
    return "\n".join({"grbl": _of_grbl, "eia": _of_eia, "burny": _of_burny}[control](rows))


def _of_grbl(rows: list[str]) -> list[str]:
    """M3 starts the torch, or with little power what marks; the M4 behind it changes nothing; M5 stops what is on."""
    made, tool = [], 0
    for row in rows:
        if found := re.fullmatch(r"M3 S(\d+)", row):
            tool = 0 if int(found[1]) > 400 else 1
            row = f"M3 ${tool} S1"
        elif re.fullmatch(r"M4 S\d+", row):
            continue
        elif row in ("M5", "M5 S0"):
            row = f"M5 ${tool}"
        made.append(row)
    return made


def _of_eia(rows: list[str]) -> list[str]:
    made = [_EIA.get(row, row) for row in rows]
    return [re.sub(r"^G04 X", "G4 P", row) for row in made]


def _of_burny(rows: list[str]) -> list[str]:
    """X and Y alone are a line with the torch on, and travel with it off; the number at the top is dropped."""
    made, on = [], False
    for row in rows:
        on = row == "M04" or (on and row != "M03")
        row = _BURNY.get(row, row)
        if row.startswith(("X", "Y")):
            row = f"{'G1' if on else 'G0'} {row}"
        elif re.fullmatch(r"P\d{8}|%", row):
            row = ""
        made.append(re.sub(r"^G04 F", "G4 P", row))
    return made
