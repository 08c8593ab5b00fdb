"""Burns in another order: each is the same, with what holds for it; what leans on others is refused."""

import random
from itertools import permutations

import numpy as np
import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.check.reader.read_program import OldProgram, Trusted, read_old
from kerfwise.postproc.old.program_pieces import expect_same, reordered, split_program
from kerfwise.postproc.verdict.check_plan import judge
from kerfwise.tests.postproc.old.programs import FEED, HEAD, READ, REFUSED, line
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.outside.mapped import in_linuxcnc


def read(text: str) -> OldProgram:
    return read_old(text, feed_mm_min=2500)


@pytest.mark.parametrize("name", READ)
def test_burns_stay_as_they_are_in_any_order(name: str) -> None:
    apart = split_program(read(READ[name]))
    order = list(range(len(apart.pieces)))
    for seed in range(3):
        random.Random(seed).shuffle(order)
        written = read(reordered(apart, order))
        expect_same(apart, order, written)
        for k, burn in zip(order, written.program.burns, strict=True):
            assert np.abs(burn.path.vertices[:, :2] - apart.burns[k].path.vertices[:, :2]).max() <= 0.001
            assert burn.feeds_mm_s == pytest.approx(apart.burns[k].feeds_mm_s)


def test_the_same_order_changes_nothing_that_is_done() -> None:
    for text in READ.values():
        apart = split_program(read(text))
        again = read(reordered(apart, range(len(apart.pieces))))
        assert again.program.idle_mm == pytest.approx(read(text).program.idle_mm)


def test_each_burn_has_its_material_and_asks_for_that_feed() -> None:
    text = READ["materials"]
    apart = split_program(read(text))
    rows = reordered(apart, [3, 0, 2, 1]).splitlines()
    said = [row.split("(")[0].strip() for row in rows if row.startswith(("M190", "F#", "G0", "M66"))]
    assert said[3:7] == ["M190 P4", "M66 P3 L3 Q1", "F#<_hal[plasmac.cut-feed-rate]>", "G0 X20 Y80"]
    assert said[7:11] == ["M190 P1", "M66 P3 L3 Q1", "F#<_hal[plasmac.cut-feed-rate]>", "G0 X20 Y20"]


def test_a_slow_hole_is_slow_wherever_it_comes() -> None:
    apart = split_program(read(READ["slow holes"]))
    written = read(reordered(apart, [0, 2, 4, 1, 3, 5]))
    feeds = [burn.feeds_mm_s[0] * 60 for burn in written.program.burns]
    assert feeds == pytest.approx([1500, 1500, 1500, 2500, 2500, 2500])


def test_line_numbers_are_in_order_again() -> None:
    apart = split_program(read(READ["numbered"]))
    rows = [row for row in reordered(apart, [1, 0]).splitlines() if row.startswith("N")]
    assert [int(row.split()[0][1:]) for row in rows] == [10 * k for k in range(1, len(rows) + 1)]


def test_a_burn_that_leans_on_the_feed_of_another_gets_it() -> None:
    text = HEAD + "F2500\n" + line(0, 0, 9, 0) + "F1200\n" + line(0, 9, 9, 9) + line(0, 20, 9, 20) + "M2\n"
    apart = split_program(read(text))
    feeds = [b.feeds_mm_s[0] * 60 for b in read(reordered(apart, [2, 0, 1])).program.burns]
    assert feeds == pytest.approx([1200, 2500, 1200])


def test_a_program_that_is_not_the_same_is_seen() -> None:
    apart = split_program(read(READ["rows"]))
    text = reordered(apart, [1, 0, 2, 3])
    for damaged in (
        text.replace("X120", "X120.002", 1),
        text.replace("M3 $0 S1 (torch on)", "M3 $0 S1\nG4 P0.5", 1),
        text.replace(FEED, "F2400\n"),
        text.replace("M52 P1", "M52 P0"),
    ):
        with pytest.raises(InputError, match="would not be the same"):
            expect_same(apart, [1, 0, 2, 3], read(damaged))
    expect_same(apart, [1, 0, 2, 3], read(text))


def turned_round(text: str) -> str:
    """The program with its burns the other way round."""
    apart = split_program(read(text))
    return reordered(apart, range(len(apart.pieces))[::-1])


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused_names_its_line(name: str) -> None:
    text, at, said = REFUSED[name]
    with pytest.raises(InputError, match=said) as caught:
        turned_round(text)
    assert caught.value.line == (at or None)


def test_all_unknown_words_are_told_at_once() -> None:
    text = READ["squares"].replace("M5 $0", "M231\nM777 P2\nM5 $0").replace("G1 X60", "G1 X60 V3", 1)
    with pytest.raises(InputError) as caught:
        read(text)
    words = [row.partition(")")[0] for row in caught.value.details]
    assert words == ["line 8: V… (once", "line 12: M231 (3 times", "line 13: M777 (3 times"]
    assert all("also: [" in row or "only the axes" in row for row in caught.value.details)


def test_one_unknown_word_is_told_in_one_sentence() -> None:
    with pytest.raises(InputError, match=r"1 word is not known .*\(M231; 3 in all\)") as caught:
        read(READ["squares"].replace("M5 $0", "M231\nM5 $0"))
    assert caught.value.details == ()


def test_burns_that_cannot_be_read_back_are_blamed_on_their_program() -> None:
    plan, text = plan_of(plate(), good_cuts(plate()), profile()), READ["squares"].replace("M2 (end)", "M777")
    with pytest.raises(InputError, match=r"^plate.json: its burns in another order cannot be read back"):
        judge(plate(), plan, text, profile(), Trusted(2500))


def test_a_feed_that_nobody_gives_is_asked_for() -> None:
    with pytest.raises(InputError, match="--feed") as caught:
        read_old(READ["rows"])
    assert caught.value.line == 4


@pytest.mark.linuxcnc
@pytest.mark.parametrize("name", ["squares with holes", "no way home", "numbered", "squares"])
def test_linuxcnc_finds_the_same_burns(name: str) -> None:
    text = READ[name]
    apart = split_program(read(text))
    order = list(range(len(apart.pieces)))[::-1]
    before, after = canon.run(text, 0.001), canon.run(reordered(apart, order), 0.001)
    assert (after.error, len(after.burns)) == (None, len(before.burns))
    for k, burn in zip(order, after.burns, strict=True):
        was = before.burns[k]
        assert np.abs(np.array(burn.points) - np.array(was.points)).max() <= 0.001
        assert (burn.tool, burn.feeds_mm_min) == (was.tool, was.feeds_mm_min)


ESSI = """\
%
71
81
48
5
+100+100
3
the first
4
6
53
39+2500
++500
+500+0
47
+250+250+0+250+
68
54
5
3
between
4
-400+200
6
53
39+1200
+300+
+-300
54
5
+700-200
6
9
39+6000
+50+50
10
5
-800-350
0
"""


def essi(text: str) -> OldProgram:
    return read_old(text, CONTROLS["essi"])


@pytest.mark.parametrize("order", list(permutations(range(3))))
def test_burns_that_count_from_place_to_place_stay_as_they_are(order: tuple[int, ...]) -> None:
    old = essi(ESSI)
    apart = split_program(old)
    text = reordered(apart, order)
    written = essi(text)
    expect_same(apart, order, written)
    for k, burn in zip(order, written.program.burns, strict=True):
        assert np.abs(burn.path.vertices - old.program.burns[k].path.vertices).max() <= 1e-9
        assert (burn.tool, burn.feeds_mm_s) == (old.program.burns[k].tool, old.program.burns[k].feeds_mm_s)
    assert written.program.end == pytest.approx(old.program.end, abs=1e-9)
    assert text.splitlines().count("the first") == text.splitlines().count("between") == 1
    assert written.program.slow_travel == written.program.faults == ()


def test_a_program_of_essi_in_its_own_order_has_the_same_lines() -> None:
    assert sorted(reordered(split_program(essi(ESSI)), range(3)).split("\n")) == sorted(ESSI.split("\n"))


@pytest.mark.linuxcnc
def test_linuxcnc_finds_the_burns_of_essi_where_they_were() -> None:
    plain = ESSI  # without arcs, each zero with its digit, as it can be spelt for LinuxCNC
    for old, new in (("++", "+0+"), ("+300+\n", "+300+0\n"), ("+-300", "+0-300"), ("+0+250+\n", "\n")):
        assert old in plain
        plain = plain.replace(old, new)
    apart = split_program(essi(plain))
    before = canon.run(in_linuxcnc(plain, "essi"), 0.001)
    after = canon.run(in_linuxcnc(reordered(apart, [2, 0, 1]), "essi"), 0.001)
    assert (before.error, after.error) == (None, None)
    for k, burn in zip([2, 0, 1], after.burns, strict=True):
        assert np.abs(np.array(burn.points) - np.array(before.burns[k].points)).max() <= 0.001


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ("5\n3\nbetween", "5\n0\n3\nbetween", 20, "words behind the program's end"),
        ("6\n53\n39+1200\n", "53\n39+1200\n", 26, "a rapid with the torch on"),
        ("+300+\n", "29\n+300+\n", 27, "29 is not supported here"),
        ("+300+\n", "82\n+300+\n", 27, "82 is not supported here"),
        ("48\n5\n+100", "5\n+100", 10, "68 comes later in the program"),
    ],
)
def test_what_is_refused_of_essi_names_its_line(old: str, new: str, line: int, said: str) -> None:
    assert old in ESSI
    with pytest.raises(InputError, match=said) as caught:
        reordered(split_program(essi(ESSI.replace(old, new, 1))), [2, 1, 0])
    assert caught.value.line == line
