"""Programs that are right, of both controls, for mutations to begin with: the writer's own, and by hand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

from kerfwise.postproc.nc.program import write_program
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile

_STATE = "G90 G17 G40 G49 G80 G91.1 G94\nG64 P0.05"
_BY_HAND = f"""%
N10 G21
{_STATE}
(first a square, by hand)
N20 G0 X10 Y10
{{on}}
G4 P0.5
G1 X30 F1200
Y30
X10
Y10.
{{off}}
; an inner circle, and a slot with round ends
G00 X50. Y25
{{on}}
G03 X50 Y25 I-5 J0 F900
{{off}}
G0 X80 Y20
{{on}}
G1 X100 F1200
G3 X100 Y30 R5
G1 X80
G3 Y20 J-5
{{off}}
G0X0Y0
M5
M2
%
"""
_COUNTING = f"""G20
{_STATE.replace("0.05", "0.001")}
G91
G0 X1 Y.5
{{on}}
G1 X1 F40
G2 X.5 Y-.5 I0 J-.5
G1 Y-.25
{{off}}
G90
G0 X2.5 Y2
{{mark_on}}
G1 X3
{{mark_off}}
G21 G90.1
G0 X60 Y60
{{on}}
G2 X80 Y40 I60 J40 F1000
X60 Y20 I60 J40
G1 Y60
{{off}}
G0 X0 Y0
M30
"""
_WORDS: Mapping[str, Mapping[str, str]] = {
    "linuxcnc-qtplasmac": {"on": "M3 $0 S1", "off": "M5 $0", "mark_on": "M3 $1 S1", "mark_off": "M5 $1"},
    "linuxcnc": {"on": "M3 S1", "off": "M5", "mark_on": "M64 P0", "mark_off": "M65 P0"},
}


@cache
def good_programs() -> tuple[tuple[str, str], ...]:
    """The control of each, and its text."""
    made = []
    for control, words in _WORDS.items():
        made += [(control, text.format(**words)) for text in (_BY_HAND, _COUNTING)]
        plant = profile()
        plant = replace(plant, machine=replace(plant.machine, dialect=control))
        sheet = plate()
        cuts = good_cuts(sheet)
        for some in (cuts[:2], cuts[-2:]):
            made.append((control, write_program(plan_of(sheet, some, plant), sheet, plant)))
    return tuple(made)
