"""Programs of other controls in LinuxCNC's words, block for block, so that its interpreter can read their geometry.

The mapping is ours and proves nothing; what the interpreter then makes of units, positions, arcs and feeds does.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

_NUMBER = re.compile(r"^N\d+ ")
_EIA = {"M07": "M3 $0 S1", "M08": "M5 $0", "M09": "M3 $1 S1", "M10": "M5 $1", "M50": "", "M51": "", "M02": "M2"}
_BURNY = {"M04": "M3 $0 S1", "M03": "M5 $0", "G71": "G21", "G90": "G90 G90.1"}


_OF_DIALECT: dict[str, dict[str, str]] = {
    "mach": {"M3": "M3 S1"},
    "marlin": {"M84": "M2"},
    "fanuc": {"M3": "M3 $0 S1", "M5": "M5 $0", "%": ""},
    "sinumerik": {"M3": "M3 $0 S1", "M5": "M5 $0", "G71": "G21"},
}
_WAITS = {"marlin": "G4 S", "fanuc": "G04 X", "sinumerik": "G4 F"}


def in_linuxcnc(text: str, control: str, dialect: str = "") -> str:
    """The program in words that LinuxCNC knows; one for LinuxCNC stays as it is."""
    if dialect == "hpgl":
        return "\n".join(_of_hpgl(text.split("\n")))
    if dialect in _OF_DIALECT:
        rows = [_NUMBER.sub("", row) for row in text.split("\n")]
        rows = _by_power(rows, 102) if dialect == "marlin" else rows
        mapped = [_OF_DIALECT[dialect].get(row, row) for row in _called(rows)]
        return "\n".join(_said_out(row.replace(_WAITS.get(dialect, "G4 P"), "G4 P") for row in mapped))
    if control.startswith("linuxcnc"):
        return text
    rows = [_NUMBER.sub("", row) for row in text.split("\n")]
    return "\n".join(
        {"grbl": _of_grbl, "eia": _of_eia, "burny": _of_burny, "essi": _of_essi, "essi-radius": _of_essi}[control](rows)
    )


def _of_hpgl(rows: list[str]) -> Iterator[str]:
    """PU and PD with a place are travel and a line, 40 units a mm; alone they lift and lower what draws."""
    yield "G21 G90 G17 G40 G94"
    words = {"SP0;": "M2"}
    for row in rows:
        if row in ("SP1;", "SP2;"):  # the second pen marks
            words |= {"PD;": f"M3 ${int(row[2]) - 1} S1", "PU;": f"M5 ${int(row[2]) - 1}"}
        if found := re.fullmatch(r"P([UD])(-?\d+),(-?\d+);", row):
            x, y = (int(number) / 40 for number in found.group(2, 3))
            yield f"{'G0' if found[1] == 'U' else 'G1'} X{x:.3f} Y{y:.3f}"
        elif found := re.fullmatch(r"VS([\d.]+);", row):
            yield f"F{float(found[1]) * 600:g}"
        elif found := re.fullmatch(r"!DW(\d+);", row):
            yield f"G4 P{int(found[1]) / 1000:g}"
        else:
            yield words.get(row, "")


def _called(rows: list[str]) -> list[str]:
    """Rows with what `M98 P…` calls in its place; what is called stands behind M30, from its O number up to M99."""
    if not any(row.startswith("M98 P") for row in rows):
        return rows
    main = rows[: rows.index("M30") + 1]
    made: list[str] = []
    for row in main:
        if row.startswith("M98 P"):
            begins = rows.index(f"O{row[5:]}") + 1
            made += rows[begins : rows.index("M99", begins)]
        else:
            made.append(row)
    return made


def _said_out(rows: Iterable[str]) -> Iterator[str]:
    """Rows with the motion word that they lean on, without program numbers, and with comments in brackets."""
    motion = ""
    for row in rows:
        if found := re.match(r"G0?[0-3](?= )", row):
            motion = found[0]
        if row.startswith("; "):
            row = f"({row[2:].translate(_NO_BRACKETS)})"
        elif row.startswith(("X", "Y")):
            row = f"{motion} {row}"
        yield "" if re.fullmatch(r"O\d+", row) else row


_NO_BRACKETS = str.maketrans("()", "[]")


def _of_grbl(rows: list[str]) -> list[str]:
    """The M4 behind M3 changes nothing."""
    return _by_power(rows, 400)


def _by_power(rows: list[str], marks_up_to: int) -> list[str]:
    """M3 starts the torch, or with little power what marks; M5 stops what is on."""
    made, tool = [], 0
    for row in rows:
        if found := re.fullmatch(r"M3 S(\d+)", row):
            tool = 0 if int(found[1]) > marks_up_to else 1
            row = f"M3 ${tool} S1"
        elif re.fullmatch(r"M4 S\d+", row):
            continue
        elif row == "S0":  # a tab begins, and ends with another S
            row = f"M5 ${tool}"
        elif re.fullmatch(r"S\d+", row):
            row = f"M3 ${tool} S1"
        elif row in ("M5", "M5 S0"):
            row = f"M5 ${tool}"
        made.append(row)
    return made


def _of_eia(rows: list[str]) -> list[str]:
    made = [_EIA.get(row, row) for row in rows]
    made = [re.sub(r"^M3([78]) T(\d+)$", _output, row) for row in made]
    return [re.sub(r"^G04 X", "G4 P", row) for row in made]


def _output(found: re.Match[str]) -> str:
    """The output that selects or deselects a torch beside the first."""
    return f"M6{4 if found[1] == '7' else 5} P{int(found[2]) - 1}"


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


def _of_essi(rows: list[str]) -> list[str]:
    """Signed whole numbers of 0.1 mm are added up to X and Y, from the zero; 6 makes a move a line. No arcs."""
    made, rapid, at = ["G21", "G90 G17 G40 G94", "G64 P0.05"], True, (0, 0)
    words = {"53": "M3 $0 S1", "54": "M5 $0", "9": "M3 $1 S1", "10": "M5 $1", "0": "M2"}
    for row in rows:
        rapid = row == "5" or (rapid and row != "6")
        if found := re.fullmatch(r"([+-]\d+)([+-]\d+)", row):
            at = at[0] + int(found[1]), at[1] + int(found[2])
            row = f"{'G0' if rapid else 'G1'} X{at[0] / 10:.1f} Y{at[1] / 10:.1f}"
        elif row.startswith("39+"):
            row = f"F{row[3:]}"
        elif row.startswith("41+"):
            row = f"G4 P{int(row[3:]) / 1000:g}"
        else:
            row = words.get(row, "")
        made.append(row)
    return made
