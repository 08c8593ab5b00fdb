"""Parameters, expressions, loops and subroutines are worked out as LinuxCNC does."""

from __future__ import annotations

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.check.reader.unfold import needs_unfolding, unfold
from kerfwise.tests.tools import canon

HEAD = "G21 G90 G17 G40 G91.1\nF1000\n"
PROGRAMS = {
    "operators": "#1=[2+3*4**2/8 MOD 5]\n#2=[1 - 2 - 3]\n#3=[2**3**2]\n#4=[-7 MOD 3]\n"
    "G0 X#1 Y#2\nM3 S1\nG1 X#3 Y#4\nX[[1+2]*3] Y[2*[3-1]]\nM5\n",
    "functions": "#1=SIN[30]\n#2=COS[60]\n#3=TAN[45]\n#4=ATAN[3]/[4]\n#5=SQRT[2]\n#6=ROUND[2.5]\n"
    "#7=ROUND[-2.5]\n#8=FIX[-2.4]\n"
    "#9=FUP[2.1]\n#10=LN[EXP[2]]\n#11=ABS[-3]\n#12=ASIN[0.5]\n#13=ACOS[0.5]\n"
    "G0 X#1 Y#2\nM3 S1\nG1 X#3 Y#4\nX#5 Y#6\nX#7 Y#8\nX#9 Y#10\nX#11 Y#12\nX#13\nM5\n",
    "comparisons": "#1=[1 LT 2]\n#2=[1 EQ 1.00001]\n#3=[1 NE 2 AND 3 GE 3]\n#4=[0 OR 0 XOR 1]\n"
    "#5=[2 LE 1]\n#6=[3 GT 2]\n"
    "G0 X#1 Y#2\nM3 S1\nG1 X[#3+4] Y#4\nX[#5+7] Y[#6+8]\nM5\n",
    "values of before": "#1=5\nG0 X#1 Y1 #1=9\nM3 S1\nG1 X#1 Y2\n#1=3 #2=#1\nX#2 Y#1\nM5\n",
    "signs": "#4=0.5\n#1=50\n#5=[#1*2*#4]\nG0 X[#5+-#4*#1] Y-[3]\nM3 S1\nG1 X-#1 Y[-[-2]]\nM5\n",
    "a number by a number": "#7=12\n#12=33\nG0 X##7 Y1\nM3 S1\nG1 X#[6+1] Y5\nM5\n",
    "repeat": "#1=0\no100 repeat [3]\nG0 X[#1*20] Y0\nM3 S1\nG1 X[#1*20+10]\nM5\n#1=[#1+1]\no100 endrepeat\n",
    "while": "#1=0\no1 while [#1 LT 4]\n#1=[#1+1]\no2 if [#1 EQ 2]\no1 continue\no2 endif\n"
    "o3 if [#1 EQ 4]\no1 break\no3 endif\n"
    "G0 X#1 Y0\nM3 S1\nG1 X#1 Y9\nM5\no1 endwhile\n",
    "do": "#1=0\no1 do\nG0 X#1 Y0\nM3 S1\nG1 X#1 Y9\nM5\n#1=[#1+1]\no1 while [#1 LT 3]\n",
    "branches": "#1=0\no9 repeat [4]\no1 if [#1 EQ 0]\nG0 X1 Y1\no1 elseif [#1 EQ 1]\nG0 X2 Y2\n"
    "o1 elseif [#1 EQ 2]\nG0 X3 Y3\n"
    "o1 else\nG0 X4 Y4\no1 endif\nM3 S1\nG1 X50\nM5\n#1=[#1+1]\no9 endrepeat\n",
    "subroutines": "o100 sub\nG0 X#1 Y#2\nM3 S1\nG1 X[#1+#3] Y#2\nM5\n#<_far>=#1\no100 endsub\n"
    "o100 call [5] [6] [7]\no100 call [#<_far>*2] [1] [2]\n",
    "values that come back": "o<twice> sub\no1 if [#1 GT 10]\no<twice> return [#1]\no1 endif\no<twice> endsub [#1*2]\n"
    "o<twice> call [4]\n#9=#<_value>\no<twice> call [14]\nG0 X#9 Y#<_value>\nM3 S1\nG1 X0 Y0\nM5\n",
    "names": "#<side length>=12\n#<_all>=3\no<s> sub\n#<side length>=1\n"
    "G0 X#<side length> Y#<_all>\no<s> endsub\no<s> call\n"
    "M3 S1\nG1 X#<sidelength>\no4 if [EXISTS[#<nothing>]]\nG1 X99\no4 endif\nM5\n",
    "calls in calls": "o1 sub\no2 call [#1+1]\nG0 X#1 Y0\nM3 S1\nG1 Y5\nM5\no1 endsub\no2 sub\n"
    "G0 X#1 Y10\nM3 S1\nG1 Y15\nM5\n"
    "o2 endsub\no1 call [20]\no1 call [40]\n",
}  # fmt: skip


@pytest.mark.linuxcnc
@pytest.mark.parametrize("name", PROGRAMS)
def test_linuxcnc_makes_the_same_of_both(name: str) -> None:
    text = f"{HEAD}{PROGRAMS[name]}M2\n"
    assert needs_unfolding(text)
    plain = "\n".join([*(row.text for row in unfold(text)), ""])
    assert not needs_unfolding(plain)
    theirs, ours = canon.run(text), canon.run(plain)
    assert (theirs.error, ours.error) == (None, None)
    assert [b.points for b in ours.burns] == [
        [(pytest.approx(x, abs=1e-4), pytest.approx(y, abs=1e-4)) for x, y in b.points] for b in theirs.burns
    ]
    assert theirs.burns


@pytest.mark.linuxcnc
def test_subprograms_of_fanuc() -> None:
    text = (
        f"{HEAD}M98 P100 L2\nG0 X0 Y50\nM98 P200\nM2\nO100\nM3 S1\nG91\nG1 X10\nG90\n"
        "M5\nG0 X30 Y30\nM99\nO200\nM98 P100\nM99\n"
    )
    plain = "\n".join([*(row.text for row in unfold(text)), ""])
    theirs, ours = canon.run(text), canon.run(plain)
    assert (theirs.error, ours.error) == (None, None)
    assert [b.points for b in ours.burns] == [b.points for b in theirs.burns]
    assert len(ours.burns) == 3


def test_what_needs_no_working_out_stays() -> None:
    for plain in (
        "G0 X1\nM2\n",
        "(#1=5 [x])\nG0 X1\nM2\n",
        "#<holes>=4\nF#<_hal[plasmac.cut-feed-rate]>\nM2\n",
        "O0001\nM2\n",
    ):
        assert not needs_unfolding(plain), plain


def test_words_of_qtplasmac_stay() -> None:
    text = "#1=5\n#<holes>=[#1-1]\nF#<_hal[plasmac.cut-feed-rate]> (feed)\nM2\n"
    assert [row.text for row in unfold(text, plasmac=True)] == [
        "#<holes>=4", "F#<_hal[plasmac.cut-feed-rate]> (feed)", "M2",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("#1=[1/0]\n", 1, "divides by zero"),
        ("#1=SQRT[-1]\n", 1, "a root or an angle"),
        ("G0 X#<none>\n", 1, "nothing has set it"),
        ("G0 X#5220\n", 1, "kept by the machine"),
        ("G0 X[1+\n", 1, "cannot read"),
        ("#1 5\n", 1, "expected ="),
        ("o1 repeat [2]\nG0 X1\n#1=1\n", 1, ""),
        ("o1 while [1]\no1 endwhile\n", 1, "has not ended"),
        ("o1 if [1]\no1 els\no1 endif\n", 2, "els is not known"),
        ("o<file> call [1]\n", 1, "no subroutine of this program"),
        ("M98 P7\n", 1, "no subprogram of this program"),
        ("o1 sub\no1 call\no1 endsub\no1 call\n", 2, "call each other"),
        ("o1 endwhile\n", 1, "no while before it"),
    ],
)
def test_what_cannot_be_worked_out_is_told_with_its_line(text: str, line: int, message: str) -> None:
    if not message:
        assert unfold(text)  # a loop that never closes runs once, as its end is never met
        return
    with pytest.raises(InputError, match=message) as caught:
        unfold(text)
    assert caught.value.line == line
