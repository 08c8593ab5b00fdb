"""What the reader refuses: with file, line and column, what was found, and what to do."""

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.check.reader.controls import CONTROLS, LONGEST
from kerfwise.postproc.check.reader.rs274 import read_nc

STRICT = "not supported here"
HEAD = "G21 F600\n"
"""Before each line of the table, so that it is line 2."""

MALFORMED = {
    "G94 G1 X5": "2:1: a line or an arc with no feed",
    "G1 X1O": "2:6: cannot read 'O': expected a word",
    "G1 X": "2:4: cannot read 'X'",
    "X1": "2:1: X without a word that uses it: expected a motion word",
    "G2 X10 Y0": "2:1: an arc without I, J or R",
    "G2": "2:1: an arc without its end, I, J or R",
    "G2 X0 Y0 R4": "2:10: an arc by R that ends where it starts",
    "G2 X10 I5 R5": "2:11: an arc with both R and I or J",
    "G2 R5": "2:4: an arc by R without its end",
    "G90.1 G2 X10 I5": "2:1: an arc with an absolute centre (G90.1) needs both",
    "G4": "2:1: G4 without its time",
    "G40 P1": "2:5: P without a word that uses it",
    "G2 X10 Y0 I5 E3": "2:14: E without a word that uses it",
    "(" + LONGEST * "x" + ")": f"2:{LONGEST + 1}: the line has {LONGEST + 2} bytes: more than",
    "(" + LONGEST // 2 * "\u0449" + ")": f"the line has {LONGEST + 2} bytes",
}
"""What the control refuses too."""
STRICTER = {
    "G1 X1 X2": "2:7: two X words in one block",
    "G1 X5(a)5": "2:9: cannot read '5'",
    "G1 X(a)5": "2:4: cannot read 'X 5'",
    "(a (b))": "2:4: a comment inside a comment",
    "G21 (a": "2:5: the comment is not closed",
    "G21 a)": "2:6: a ')' that closes no comment",
    "G0 X\u0661": "2:5: '\u0661' (U+0661) outside a comment",
    "M3 \uff040 S1": "2:4: '\uff04' (U+FF04) outside a comment",
    "(a) N5 G0 X1": "2:5: 'N5G0X1': expected a line number",
    "G21 ; torch off\vM5 $0": "2:16: the character U+000B",
    "G21 ; torch off\fM5 $0": "2:16: the character U+000C",
    "G21 ; torch off\x1cM5 $0": "2:16: the character U+001C",
    "G21 ; torch off\x85M5 $0": "2:16: the character U+0085",
    "G21 ; torch off\u2028M5 $0": "2:16: the character U+2028",
    "G21 ; torch off\rM5 $0": "2:16: a carriage return (CR) in the middle of a line",
    "G21 (\x00)": "2:6: the character U+0000",
    "G21 (\u202eabc)": "2:6: the character U+202E",
    "N-5.5 G0 X1": "2:1: 'N-5.5G0X1': expected a line number",
    "N1234567890": "2:1: 'N1234567890': expected a line number",
    "G0 X1 N5": "2:7: 'N5': expected a line number",
    "T1": "2:1: T without a word that uses it: expected none",
    "G0 Z5": "2:4: 'Z5' is not supported here: the machine keeps its height",
    "G0 A5": "2:4: 'A5' is not supported here: only the axes X and Y",
    "(abort, now)": "2:1: the comment 'abort, now' is a command to the control (ABORT)",
    "( Debug,#1)": "2:1: the comment 'Debug,#1' is a command",
    ";py,print(1)": "2:1: the comment 'py,print(1)' is a command",
    "(PROBEOPEN x.txt)": "2:1: the comment 'PROBEOPEN x.txt' is a command",
    "(logopen,x.txt)": "2:1: the comment 'logopen,x.txt' is a command",
    "(o=0, kw=9, ph=1, pd=0, ch=1, fr=100)": "2:1: QtPlasmaC obeys '(o='",
    "(X) ;QtPlasmaC filtered G-code file": "2:5: QtPlasmaC obeys ';QtPlasmaC filtered G-code file'",
    "M190 P1": "2:1: M190 is not supported here: it selects another material",
    "M66 P3 L3 Q1": "2:1: M66 is not supported here",
    "M66 P3": "2:1: M66 is not supported here: how long it waits",
    "M67 E3.0000001 Q0": "2:5: M67 E3.0000001 is not supported here",
    "M68 E1 Q0": "2:5: M68 E1 is not supported here",
    "M68 E3": "2:1: M68 without E and Q",
    "M5 $0.4": "2:4: $0.4 is not supported here: expected a whole number",
    "M3 $-1 S1": "2:4: all tools at once are not supported here",
    "M3 $3 S1": "2:4: $3 is not supported here: expected $ from -1 to 2",
    "M3.00001 S1": "2:1: M3.00001 spelt so is not supported here",
    "G1.00005 X1": "2:1: G1.00005 spelt so is not supported here",
    "G41 P1": "2:1: G41 is not supported here: the control would shift the path",
    "G18": "2:1: G18 is not supported here: arcs outside the XY plane",
    "G92 X0": "2:1: G92 is not understood",
    "M62 P3": "2:1: M62 is not supported here: it can stop the torch",
    "M4": "2:1: M4 is not understood",
    "G0 G1 X1": "2:4: G0 and G1 are of one group (motion)",
    "M3 M5": "2:4: M3 and M5 are of one group (torch)",
    "G4 P1 X5": "2:1: a wait (G4) and a move in one block",
    "G64 P0.05 G4": "2:5: P0.05 is meant for G64 or G4",
    "G2 I5 P2": "2:7: an arc of several turns is not supported here",
    "G2 X10 Y0 I4.9 J0": "2:1: the arc's radius is 4.9000 mm at its start and 5.1000 mm at its end",
    "G2 X10 Y0 R4": "2:11: R4 is too small",
    "G2 X1 I0": "2:1: an arc of no radius",
    "G2 X0.0001 I5": "2:1: the arc ends so near its start",
    "G0 X2000001": "2:4: X2000001 is not supported here: expected X from -2000000 to 2000000",
    "G4 P99999999": "2:4: P99999999 is not supported here",
    "G1 X5 F0.001": "2:7: a feed of 0.001 mm/min is not supported here",
    "S5": "2:1: S without a word that uses it: expected M3",
    "/G0 X1": "2:1: '/G0X1' is not supported here: whether an optional block",
    "o100 sub": "2:1: 'O100SUB' is not supported here: subroutines",
    "#1=5": "2:1: '#1=5' is not supported here: parameters",
    "G0 X[1+2]": "2:4: cannot read 'X[1+2]'",
    "G0 X--5": "2:4: cannot read 'X--5'",
    "M2\nG0 X1": "3:1: words behind the program's end",
    "N 10 M5 $0": "2:1: N apart from its number",
    "$0 M5": "2:1: a line that begins with $",
    "M5 $0 (a) M9": "2:7: words behind a comment",
    "M5 $0 ; torch (off": "2:7: a '(' or ')' in a comment behind words",
    "M5 $0 ; torch off)": "2:7: a '(' or ')' in a comment behind words",
    "M5 $0 (z5 is up)": "2:7: 'z5' in a comment behind words",
}
"""What the control takes, or takes otherwise than it reads."""


@pytest.mark.parametrize(("line", "message"), [*MALFORMED.items(), *STRICTER.items()])
def test_refusals_name_the_place(line: str, message: str) -> None:
    with pytest.raises(InputError) as error:
        read_nc(f"{HEAD}{line}\nM2\n", file="plate.ngc")
    said = str(error.value)
    assert said.startswith("plate.ngc:")
    assert message in said
    assert "\n" not in said
    assert (STRICT in said) or line in MALFORMED


@pytest.mark.parametrize("program", ["", "G21\nG0 X1\n", "%\nG21\n"])
def test_a_program_without_an_end(program: str) -> None:
    with pytest.raises(InputError, match="the program has no end"):
        read_nc(program)


@pytest.mark.parametrize(
    ("program", "place"), [("G21\n%\nM2\n", "2:1"), ("(a)\n%\nM2\n", "2:1"), ("% (a)\nM2\n", "1:1")]
)
def test_a_percent_sign_that_opens_nothing(program: str, place: str) -> None:
    with pytest.raises(InputError, match=f"^{place}: cannot read '%'"):
        read_nc(program)


def test_a_feed_of_nothing() -> None:
    with pytest.raises(InputError, match=r"^1:1: a line or an arc with no feed"):
        read_nc("G1\nM2\n")


def test_a_stop_of_all_tools_or_one() -> None:
    with pytest.raises(InputError, match=r"^2:1: M5 without \$ while tool \$1 is on is not supported here"):
        read_nc("G0 X1\nM5\nM2\n".replace("G0 X1", "G0 X1 M3 $1 S1"))
    assert read_nc("M5\nM2\n").burns == ()


def test_qtplasmac_raises_the_torch_first() -> None:
    with pytest.raises(InputError, match=r"^3: the first move of a program that counts from place to place \(G91\)"):
        read_nc("G91\nG94\nG0 X1\nM2\n")
    assert read_nc("G90\nG0 X1\nG91\nG0 X1\nM2\n").end == (2.0, 0.0)


def test_each_control_has_its_own_words() -> None:
    plain = CONTROLS["linuxcnc"]
    for line, message in {
        "M5 $0": "1:4: $0: tools by number are not supported here",
        "M64 P1": "1:5: M64 of another output than P0",
        "M64": "1:1: M64 of another output than P0",
        "M52 P0": "1:1: M52 is not understood",
    }.items():
        with pytest.raises(InputError) as error:
            read_nc(f"{line}\nM2\n", control=plain)
        assert message in str(error.value)
        assert STRICT in str(error.value)
    # and what only QtPlasmaC's filter misreads is read
    assert read_nc("N 10 M5 (a) M9 ; (z5\nM2\n", control=plain).blocks == 2


def test_what_is_said_in_comments_may_be_any_language() -> None:
    program = read_nc("(Плита №3: Ø12) \n(msg, hello)\nM5 $0 ; (стоп)\nM2\n; end\n")
    assert program.comments == ("Плита №3: Ø12", "msg, hello", "(стоп)")


def test_the_longest_line() -> None:
    assert read_nc("(" + (LONGEST - 2) * "x" + ")\nM2\n").comments == ((LONGEST - 2) * "x",)
    with pytest.raises(InputError, match=f"^1:{LONGEST + 1}: the line has"):
        read_nc("(" + (LONGEST - 2) * "x" + ")\r\nM2\n")


def test_a_path_that_runs_along_itself_over_and_over_is_refused() -> None:
    """What it burns would take memory that goes with the square of this number."""
    cut = "G1 X5\nG1 X0\n"
    program = f"{HEAD}M3 $0 S1\n{{}}M5 $0\nM2\n"
    assert len(read_nc(program.format(cut * 70)).burns) == 1
    with pytest.raises(InputError, match=r"^2: the path that is cut from here on crosses .* more than 10000 times"):
        read_nc(program.format(cut * 75))


@pytest.mark.parametrize(("row", "says"), [("G1 X2 P3", "P without a word"), ("G0 X1 I1", "I without a word")])
def test_words_that_conflict_are_refused_however_often_others_were_not(row: str, says: str) -> None:
    moves = "\n".join(["G21 G90", "G0 X5 Y5", "M3 $0 S1", "G1 X15 F600", *["G1 X16 Y1", "G2 X16 Y1 I1 J0"] * 3])
    with pytest.raises(InputError, match=says) as caught:
        read_nc(f"{moves}\n{row}\nM5 $0\nM2\n")
    assert caught.value.line == moves.count("\n") + 2
