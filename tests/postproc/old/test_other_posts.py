"""Programs in the manner of other posts, written for these tests: read, turned round, and run by LinuxCNC."""

from __future__ import annotations

import re

import numpy as np
import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.check.reader.read_program import OldProgram, read_old
from kerfwise.postproc.old.loops import rounds_of
from kerfwise.postproc.old.program_pieces import expect_same, reordered, split_program
from kerfwise.tests.tools import canon

PROGRAMS: dict[str, tuple[str, str]] = {
    "Mach3": (
        "linuxcnc",
        """\
N0010 (Filename: part.tap)
N0020 (Post processor: Mach3 plasma.post)
N0030 G21 (Units: Metric)
N0040 G53 G90 G91.1 G40
N0050 F1
N0060 S500
N0070 (Part: part)
N0080 (Process: Plasma, 45A)
N0090 M06 T1 F2200 (Plasma)
N0100 G00 Z10.0
N0110 X105.0 Y5.0
N0120 G28.1 Z12.00
N0130 G92 Z0.0
N0140 G00 Z3.8
N0150 G92 Z0.0
N0160 G00 Z3.8
N0170 M03
N0180 G04 P0.5
N0190 G01 Z1.5 F1000.0
N0200 X110.0 Y10.0 F2200.0
N0210 Y50
N0220 X150
N0230 Y10
N0240 X110
N0250 M05
N0260 G04 P1
N0270 G00 Z20.0
N0280 X25.0 Y25.0
N0290 G28.1 Z12.00
N0300 G92 Z0.0
N0310 G00 Z3.8
N0320 M03
N0330 G04 P0.5
N0340 G01 Z1.5 F1000.0
N0350 X20 Y20 F2200.0
N0360 X60
N0370 Y60
N0380 X20
N0390 Y20
N0400 M05
N0410 G04 P1
N0420 G00 Z20.0
N0430 M05 M30
""",
    ),
    "LightBurn": (
        "grbl",
        """\
; LightBurn 1.4.00
; GRBL device profile, absolute coords
; Bounds: X10 Y10 to X60 Y60
G00 G17 G40 G21 G54
G90
M4
; Cut @ 600 mm/min, 80% power
M8
G0 X40Y40
; Layer C00
G1 X60S800F600
G1 Y60
G1 X40
G1 Y40
G0 X10Y10
G1 X30S800
G1 Y30
G1 X10
G1 Y10
M9
G1 S0
M5
G90
; return to starting pos
G0 X0Y0
M2
""",
    ),
    "Inkscape": (
        "grbl",
        """\
G90
G21
M5
G0 X80 Y10
M3 S1000
G1 F500
G1 X100 Y10
G1 X100 Y30
G1 X80 Y30
G1 X80 Y10
M5
G0 X10 Y10
M3 S1000
G1 X30 Y10 F500
G1 X30 Y30
G1 X10 Y10
M5
G0 X0 Y0
M2
""",
    ),
    "Fusion": (
        "linuxcnc",
        """\
%
(AXIS,stop)
(1001)
G90 G94 G17 G91.1
G21
G53 G0 Z0.
(2D PROFILE1)
G54
G0 X105. Y5.
G0 Z2.
M3 S5000
G4 P1.
G1 X110. Y10. F2000.
G1 Y40.
G1 X140.
G1 Y10.
G1 X110.
M5
G0 X5. Y5.
M3 S5000
G4 P1.
G1 X10. Y10. F2000.
G1 Y40.
G1 X40.
G1 Y10.
G1 X10.
M5
G53 G0 Z0.
M30
%
""",
    ),
    "Vectric": (
        "linuxcnc",
        """\
( Vectric plasma )
T1M6
G17 G20
G0Z0.2500
G0X0.0000Y0.0000S100
G0X4.0000Y1.0000Z0.2500
M3
G4 P0.5
G1X4.0Y2.0F60.0
X5.0
Y1.0
X4.0
M5
G0Z0.2500
G0X1.0000Y1.0000
M3
G4 P0.5
G1X1.0Y2.0
X2.0
Y1.0
X1.0
M5
G0Z0.2500
G0X0Y0
M30
""",
    ),
    "subprograms of Fanuc": (
        "eia",
        """\
%
O1234 (PART)
G21 G90 G40
G54
G00 X100. Y0.
M98 P2000
G90 G00 X0. Y0.
M98 P2000
G90 G00 X200. Y0.
M98 P2000
M30
O2000
G91
G00 X5. Y5.
M07
G01 X5. Y5. F1500
Y30.
X30.
Y-30.
X-30.
M08
M99
%
""",
    ),
    "Hypertherm's manual": (  # 809550: no feeds, the chart's process, a marker, G41 just before M07, leads past corners
        "eia",
        """\
G20
G91
G99 X1 Y0 I0 J0
G59 V502 F34
G59 V503 F1.00
G59 V504 F130
G59 V507 F33
G59 V525 F27
G59 V600 F125
G00 X8 Y1
M36 T3
M50
M09
G03 X0 Y0 I0.5 J0
M10
M51
G00 X-0.75 Y-1.299
M36 T1
G41
M07 HS
G01 X0.176777 Y0.176777
G02 X0 Y0 I1.06066 J1.06066
G01 X-0.1 Y0
M08 RT
G40
G00 X-4.5 Y1.5
G41
M07
M50 H-0.02
G01 X-2.2 Y0
G01 X0 Y2
G01 X2 Y0
G01 X0 Y-2.2
M08 T0.2 RT
G40
M51 T0.5
M02
""",
    ),
    "Hypertherm's XPR": (  # the torch itself marks, by M07 with a gas; M08 ends that, too
        "eia",
        """\
G20
G91
(Load Material: Mild Steel)
M36 T1
M37 T1
G00X6Y2.2
G59 V509 F11956
(130Amp O2/Air)
G43X0.161
M07 HS N2
M51
F250.
G02I2.2J0.
M50 H-0.02
G01Y0.25
M08
G00X-5Y-2.2
G41
M07 AVO116 O2S
F20.
G03X1.4142Y1.4142I0.7071J0.7071
G02I1.5556J1.5556
M50
G03X-0.7071I-0.3536J-0.3536
M08
G40
M51
M19
M02
""",
    ),
    "open jaws and a scribe": (
        "linuxcnc-qtplasmac",
        """\
G21 G90 G17 G40 G91.1 G94
G64 P0.05
F2000
G0 X100 Y10
M3 S1
G1 X100 Y50
G1 X140 Y50
G1 X140 Y10
M5
G0 X20 Y10
M3 $1 S1
G1 X40 Y10
M5 $1
G0 X10 Y60
M3 $0 S1
G1 X10 Y100
G1 X50 Y100
G1 X50 Y60
M5
G0 X0 Y0
M2
""",
    ),
}


def read(name: str, text: str) -> OldProgram:
    return read_old(text, CONTROLS[PROGRAMS[name][0]], feed_mm_min=2500)


def in_linuxcnc(name: str, text: str) -> str:
    """The program without what moves nothing in the plane, its torch words as LinuxCNC has them."""
    control = PROGRAMS[name][0]
    rows = []
    for row in text.split("\n"):
        row = re.sub(r"^N\d+ ", "", row)
        if re.match(r"G28|G92|G53 G0 Z|M06|T1M6|M8$|M9$", row):
            continue
        row = re.sub(r"^G53 ", "", row)
        if name == "LightBurn":  # the beam burns in G1 alone
            row = re.sub(r"^M4|S[0-9]+", "", row)
            row = f"M5\n{row}\nM3 S1" if re.match(r"G0 ?X", row) else row
        if "Hypertherm" in name:
            if re.match(r"G59|G99|G4[0-3]|M36|M37|M19|M5[01]", row):
                continue
            row = "G20 F100" if row == "G20" else row
            row = "M3 $1 S1" if re.match("M09|M07.* N2", row) else "M5 $1" if row == "M10" else row
            row = re.sub(r"^M08.*", "M5 $-1", re.sub(r"^M07.*", "M3 $0 S1", row))
        elif control == "eia":
            row = {"M07": "M3 S1", "M08": "M5"}.get(row, row)
        rows.append(row)
    return "\n".join(rows)


@pytest.mark.linuxcnc
@pytest.mark.parametrize("name", PROGRAMS)
def test_every_burn_stays_as_it_is(name: str) -> None:
    text = PROGRAMS[name][1]
    old = read(name, text)
    apart = split_program(old)
    order = list(range(len(apart.pieces)))[::-1]
    new = reordered(apart, order)
    expect_same(apart, order, read(name, new))
    was, now = (canon.run(in_linuxcnc(name, one)) for one in (text, new))
    assert (was.error, now.error) == (None, None)
    before, after = ([burn for burn in of.burns if burn.length_mm > 0] for of in (was, now))
    assert len(before) == len(after) == len(old.program.burns)
    for k, burn in zip(order, after, strict=True):
        assert burn.tool == before[k].tool
        assert np.abs(np.array(burn.points) - np.array(before[k].points)).max() <= 0.01


def test_what_hypertherms_samples_mark_and_close() -> None:
    burns = read("Hypertherm's manual", PROGRAMS["Hypertherm's manual"][1]).program.burns
    assert [burn.tool for burn in burns] == [1, 0, 0]
    (found,) = rounds_of(burns[2].path)
    assert [round(way.length_mm / 25.4, 4) for way in (found.lead_in, found.ring, found.lead_out)] == [0.2, 8.0, 0.2]
    assert [burn.tool for burn in read("Hypertherm's XPR", PROGRAMS["Hypertherm's XPR"][1]).program.burns] == [1, 0]
    with pytest.raises(InputError, match="knows no tools by number"):
        read("Hypertherm's XPR", PROGRAMS["Hypertherm's XPR"][1].replace("M07 HS N2", "M07 $1"))
    with pytest.raises(InputError, match="a line or an arc with no feed"):
        read_old(PROGRAMS["Hypertherm's manual"][1], CONTROLS["eia"])


def test_a_scribe_marks_and_open_jaws_are_burns() -> None:
    burns = read("open jaws and a scribe", PROGRAMS["open jaws and a scribe"][1]).program.burns
    assert [burn.tool for burn in burns] == [0, 1, 0]
