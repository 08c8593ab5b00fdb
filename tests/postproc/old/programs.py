"""Programs of the shapes that QtPlasmaC's own samples have, written for these tests, and programs that are refused."""

from __future__ import annotations

HEAD = """\
G21 (metric units)
G64 P0.125 (path tolerance)
M52 P1 (adaptive feed)
"""
FEED = "F#<_hal[plasmac.cut-feed-rate]> (feed of the material)\n"
END = "G0 X0 Y0\nM2 (end)\n"


def line(x0: float, y0: float, x1: float, y1: float) -> str:
    """A straight burn."""
    return f"G0 X{x0} Y{y0}\nM3 $0 S1 (torch on)\nG1 X{x1} Y{y1}\nM5 $0 (torch off)\n"


def square(x: float, y: float, side: float, direction: int = 1) -> str:
    """A square, pierced 5 mm to the left of its lower left corner; 1 is counter-clockwise."""
    corners = [(x + side, y), (x + side, y + side), (x, y + side)][::direction]
    rows = [f"G0 X{x - 5} Y{y}", "M3 $0 S1", f"G1 X{x} Y{y}", *(f"G1 X{a} Y{b}" for a, b in corners), f"G1 X{x} Y{y}"]
    return "\n".join([*rows, "M5 $0", ""])


def circle(x: float, y: float, r: float) -> str:
    """A hole as one block, pierced at its middle."""
    return f"G0 X{x} Y{y}\nM3 $0 S1\nG1 X{x + r} Y{y}\nG3 X{x + r} Y{y} I{-r} J0\nM5 $0\n"


ROWS = [(20, 20, 120, 20), (20, 40, 120, 40), (20, 60, 120, 60), (20, 80, 120, 80)]
SCRIBE = "".join(f"G0 X{x} Y20\nM3 $1 S1\nG1 X{x} Y30\nG1 X{x + 6} Y25\nM5 $1\n" for x in (60, 20, 40))
WRENCH = """\
#<holes> = 4 (holes and arcs)
G0 X140 Y30
M3 $0 S1
G3 X140 Y30 I-3 J0
M5 $0
G0 X10 Y38
M3 $0 S1
G1 X10 Y50
G1 X160 Y50
G1 X160 Y10
G1 X10 Y10
G1 X10 Y44
M5 $0
"""
RAMP = """\
 G40
 G90
 M65 P2 (height control)
 M65 P3 (torch)
 M68 E3 Q0 (all speed)
 m159 p601 q2 (ramp)
 m159 p605 q980
 M67 E3 Q100
 T0 M6
 G43 H0
 (o=0,kw=2, ph=4, pd=1, ch=1.5, fr=490, th=1)
 F#<_hal[plasmac.cut-feed-rate]>
 G0 X0 Y0
 M3 $0 S1
 M67 E3 Q50
 G1 X0 Y60
 m159 p609
 M5 $0
 M65 P2
 M68 E3 Q0
 M5 $-1
 M30
"""

GOOD_SQUARES = HEAD + "F2500\n" + square(20, 20, 40) + square(120, 20, 40) + END

READ: dict[str, str] = {
    "line": HEAD + FEED + line(*ROWS[0]) + END,
    "rows": HEAD + FEED + "".join(line(*row) for row in ROWS) + END,
    "rows there and back": HEAD + FEED + line(*ROWS[0]) + "G0 Y40\nM3 $0 S1\nG1 X20\nM5 $0\n" + END,
    "in inches": HEAD.replace("G21", "G20").replace("0.125", "0.002")
    + FEED
    + line(1, 1, 5, 1)
    + line(1, 2, 5, 2)
    + END,
    "scribe": HEAD + FEED + "M6 T1\nG43\n" + SCRIBE + "M6 T0\nG43\n" + END,
    "materials": HEAD
    + "".join(f"M190 P{k} (material)\nM66 P3 L3 Q1\n{FEED}{line(*row)}" for k, row in enumerate(ROWS, 1))
    + "G0 X0 Y0\nM190 P-1\nM2\n",
    "described materials": HEAD
    + "".join(f"(o=0, na=Steel {k}, ph=3, fr={3000 + k}, kw=1.{k})\n{FEED}{line(*row)}" for k, row in enumerate(ROWS))
    + END,
    "wrench": HEAD + FEED + WRENCH + END,
    "ramp": HEAD + RAMP,
    "squares": HEAD + "F2500\n" + "".join(square(x, y, 40) for x, y in ((20, 20), (220, 20), (120, 20))) + END,
    "squares with holes": HEAD
    + "F2500\n"
    + "".join(circle(x + 20, 40, 8) + square(x, 20, 40, -1) for x in (20, 220, 120))
    + END,
    "slow holes": HEAD
    + "F2500\n"
    + "".join(f"M67 E3 Q60\n{circle(x + 20, 40, 8)}M67 E3 Q0\n{square(x, 20, 40, -1)}" for x in (20, 220, 120))
    + END,
    "travel by lines": """\
G21 G90 G17 G40 G91.1
G64 P0.05
F2000
G1 X5 Y60
M3 S1
X10 Y60
X10 Y110
X110
Y10
X10
Y60
M5
X60 Y60
M3 S1
X70
G3 X70 Y60 I-10 J0
M5
G1 X0 Y0
M2
""",
    "travel by lines at a feed of their own": HEAD
    + "".join(f"G1 X{x} Y20 F9000\nM3 $0 S1\nX{x + 40} F2500\nY60\nG2 X{x} Y20 I-40\nM5 $0\n" for x in (200, 20, 110))
    + "G1 X0 Y0 F9000\nM2\n",
    "a way home that leans on a word": HEAD + "F2500\n" + line(*ROWS[1]) + line(*ROWS[0]) + "X0 Y0\nM2\n",
    "parameters": "#1 = 50 (side)\n#<gap>=[#1 * 2]\n"
    + HEAD
    + "F2500\no<one> sub\nG0 X[#1 - 5] Y20\nM3 $0 S1\nG1 X#1\nX[#1+#2]\nY[20+#2]\nX#1\nY20\nM5 $0\no<one> endsub\n"
    + "o1 if [#1 EQ 50]\no<one> call [220] [40]\no1 else\no<one> call [0] [0]\no1 endif\n#3=0\n"
    + "o2 while [#3 LT 2]\no<one> call [20 + #3 * #<gap>] [40]\n#3 = [#3 + 1]\no2 endwhile\n"
    + END,
    "repeats": "(circles)\n#1=20\n"
    + HEAD
    + "F2500\no100 repeat [3]\nG0 X#1 Y50\nM3 $0 S1\nG1 X[#1+10]\nG2 I-10\n"
    + "M5 $0\n#1=[#1+60]\no100 endrepeat\n"
    + END,
    "from place to place": HEAD
    + "F2500\n"
    + "".join(f"G90 G0 X{x} Y20\nG91\nM3 $0 S1\nG1 X40\nY40\nX-40\nY-40\nM5 $0\n" for x in (200, 20, 110))
    + "G90\n"
    + END,
    "only from place to place": HEAD
    + "F2500\nG90 G0 X0 Y0\nG91\n"
    + "".join(f"G0 X{x} Y0\nM3 $0 S1\nG1 X40\nY40\nX-40\nY-40\nM5 $0\n" for x in (200, -180, 90))
    + "G0 X-110 Y0\nM2\n",
    "heights, probing and waits": HEAD.replace("M52 P1 (adaptive feed)\n", "G92 X0 Y0\nS11\nM6 T1\nG43 H1\n")
    + "".join(
        f"G0 Z10\nG0 X{x} Y20\nG38.2 Z-100 F500\nG92 Z0\nG0 Z3.8\nM3\nG4 P1.5\nG1 Z1.5 F400\n"
        f"G1 X{x + 40} F2500\nY60\nX{x} Y20\nM5\nG4 P0.6 (let it cool)\nG0 Z10\n"
        for x in (200, 20, 110)
    )
    + "G53 G0 Z0\n"
    + END,
    "the same height in each travel": HEAD.replace("G21", "O1234\nG21")
    + "F2500\nG0 Z6\n"
    + "".join(f"G0 X{x} Y20 Z6\nM3\nG1 X{x + 40}\nY60\nX{x} Y20\nM5\n" for x in (200, 20, 110))
    + END,
    "a height before the travel": GOOD_SQUARES.replace("G0 X115", "G4 P2\nG0 Z20\nG0 X115"),
    "kerf by the control": HEAD
    + "F2500\n"
    + "".join(
        f"G0 X{x} Y20\nG41.1 D2\nM3 $0 S1\nG1 X{x + 10}\nY60\nX{x + 50}\nY20\nX{x + 10}\nM5 $0\nG40\n"
        for x in (200, 20, 110)
    )
    + END,
    "unknown words at the top": HEAD.replace("M52 P1 (adaptive feed)\n", "M210 P4\n")
    + "F2500\n"
    + square(220, 20, 40)
    + square(20, 20, 40)
    + END,
    "line ends of Windows": (HEAD + "F2500\n" + square(220, 20, 40) + square(20, 20, 40) + END).replace("\n", "\r\n"),
    "no way home": HEAD + "F2500\n" + line(*ROWS[1]) + line(*ROWS[0]) + "M2\n",
    "numbered": "\n".join(
        f"N{10 * k} {row}"
        for k, row in enumerate((HEAD + "F2500\n" + line(*ROWS[1]) + line(*ROWS[0]) + END).splitlines(), 1)
    )
    + "\n",
}
"""Read, and put in order."""

GOOD = GOOD_SQUARES
REFUSED: dict[str, tuple[str, int, str]] = {
    "an unknown name": ("#<tube-cut>=1\n" + GOOD, 1, "not known here"),
    "a loop": (HEAD + "F2500\no100 call [3]\n" + square(20, 20, 40) + END, 5, "no subroutine of this program"),
    "a loop without end": (HEAD + "o1 while [1]\no1 endwhile\n" + GOOD, 5, "has not ended after"),
    "a division by nothing": ("#1=[1/0]\n" + GOOD, 1, "divides by zero"),
    "a place that the machine keeps": (GOOD.replace("G0 X115", "G0 X#5420"), 13, "kept by the machine"),
    "a travel between heights": (
        GOOD.replace("G0 X115 Y20\n", "G0 X115 Y20\nG0 Z5\nG0 X115 Y25\n"),
        14,
        "between two travels",
    ),
    "a travel that changes the height": (GOOD.replace("G0 X115", "G0 Z6\nG0 Z9 X115"), 14, "changes the height"),
    "a zero that moves": (GOOD.replace("G0 X115", "G92 X0 Y0\nG0 X115"), 13, "moves the zero"),
    "no units": (GOOD.replace("G21 (metric units)\n", ""), 4, "units"),
    "no end": (GOOD.replace("M2 (end)\n", ""), 21, "has no end"),
    "a rapid with the torch on": (
        HEAD + "F2500\nG0 X1 Y1\nM3 $0 S1\nG1 X9\nG0 X20\nG1 X30\nM5 $0\n" + END,
        8,
        "torch on",
    ),
    "the torch left on": (GOOD.replace("M5 $0\nG0 X0", "G0 X0"), 21, "torch on"),
    "nothing puts it out": (HEAD + "F2500\nG0 X1 Y1\nM3 $0 S1\nG1 X9\nM2\n", 8, "ends with the torch on"),
    "a halt": (GOOD.replace("G0 X115", "M0\nG0 X115"), 13, "halts here"),
    "no feed": (HEAD + square(20, 20, 40) + END, 6, "no feed"),
    "an arc that is none": (HEAD + "F2500\nG0 X0 Y0\nM3 $0 S1\nG2 X20 Y0 I3 J0\nM5 $0\n" + END, 7, "radius"),
    "an axis more": (GOOD.replace("G0 X115", "G0 A20\nG0 X115"), 13, "another axis"),
    "a material without its feed": (HEAD + "(o=0, kw=1)\n" + FEED + square(20, 20, 40) + END, 4, "without its feed"),
    "a material of the file": (HEAD + "(o=1, fr=3000)\n" + FEED + square(20, 20, 40) + END, 4, "material file"),
    "the torch out on the way": (HEAD + "F2500\nM64 P3\n" + square(20, 20, 40) + END, 5, "puts the torch out"),
    "a wait for no material": (HEAD + "M66 P3 L3 Q1\n" + FEED + square(20, 20, 40) + END, 4, "none was chosen"),
    "a speed of 5 %": (HEAD + "F2500\nM67 E3 Q5\n" + square(20, 20, 40) + END, 5, "10 to 100 %"),
    "nothing is cut": (HEAD + "F2500\nG0 X5 Y5\n" + END, 0, "the torch is never on"),
    "after a stop": ("(RESUME AFTER CUT 2)\n" + GOOD, 1, "goes on after a stop"),
    "words nobody said before": (
        HEAD.replace("M52 P1 (adaptive feed)\n", "")
        + "F2500\n"
        + square(220, 20, 40)
        + "M52 P1\n"
        + square(20, 20, 40)
        + END,
        5,
        "comes later in the program",
    ),
    "a second program": (GOOD + GOOD, 23, "behind the program's end"),
}
"""A program, the line that the message names (0 for none), and some of its words."""
