"""Burns in another order: each is the same, with what holds for it; what leans on others is refused."""

import random

import numpy as np
import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.check.reader.old import OldProgram, read_old
from kerfwise.postproc.old.pieces import taken_apart
from kerfwise.postproc.old.reordered import expect_same, reordered
from kerfwise.tests.postproc.old.programs import FEED, HEAD, READ, REFUSED, line
from kerfwise.tests.tools import canon


def read(text: str) -> OldProgram:
    return read_old(text, feed_mm_min=2500)


@pytest.mark.parametrize("name", READ)
def test_burns_stay_as_they_are_in_any_order(name: str) -> None:
    apart = taken_apart(read(READ[name]))
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
        apart = taken_apart(read(text))
        again = read(reordered(apart, range(len(apart.pieces))))
        assert again.program.idle_mm == pytest.approx(read(text).program.idle_mm)


def test_each_burn_has_its_material_and_asks_for_that_feed() -> None:
    text = READ["materials"]
    apart = taken_apart(read(text))
    rows = reordered(apart, [3, 0, 2, 1]).splitlines()
    said = [row.split("(")[0].strip() for row in rows if row.startswith(("M190", "F#", "G0", "M66"))]
    assert said[3:7] == ["M190 P4", "M66 P3 L3 Q1", "F#<_hal[plasmac.cut-feed-rate]>", "G0 X20 Y80"]
    assert said[7:11] == ["M190 P1", "M66 P3 L3 Q1", "F#<_hal[plasmac.cut-feed-rate]>", "G0 X20 Y20"]


def test_a_slow_hole_is_slow_wherever_it_comes() -> None:
    apart = taken_apart(read(READ["slow holes"]))
    written = read(reordered(apart, [0, 2, 4, 1, 3, 5]))
    feeds = [burn.feeds_mm_s[0] * 60 for burn in written.program.burns]
    assert feeds == pytest.approx([1500, 1500, 1500, 2500, 2500, 2500])


def test_line_numbers_are_in_order_again() -> None:
    apart = taken_apart(read(READ["numbered"]))
    rows = [row for row in reordered(apart, [1, 0]).splitlines() if row.startswith("N")]
    assert [int(row.split()[0][1:]) for row in rows] == [10 * k for k in range(1, len(rows) + 1)]


def test_a_burn_that_leans_on_the_feed_of_another_gets_it() -> None:
    text = HEAD + "F2500\n" + line(0, 0, 9, 0) + "F1200\n" + line(0, 9, 9, 9) + line(0, 20, 9, 20) + "M2\n"
    apart = taken_apart(read(text))
    feeds = [b.feeds_mm_s[0] * 60 for b in read(reordered(apart, [2, 0, 1])).program.burns]
    assert feeds == pytest.approx([1200, 2500, 1200])


def test_a_program_that_is_not_the_same_is_seen() -> None:
    apart = taken_apart(read(READ["rows"]))
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
    apart = taken_apart(read(text))
    return reordered(apart, range(len(apart.pieces))[::-1])


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused_names_its_line(name: str) -> None:
    text, at, said = REFUSED[name]
    with pytest.raises(InputError, match=said) as caught:
        turned_round(text)
    assert caught.value.line == (at or None)


def test_a_feed_that_nobody_gives_is_asked_for() -> None:
    with pytest.raises(InputError, match="--feed") as caught:
        read_old(READ["rows"])
    assert caught.value.line == 4


@pytest.mark.linuxcnc
@pytest.mark.parametrize("name", ["squares with holes", "no way home", "numbered", "squares"])
def test_linuxcnc_finds_the_same_burns(name: str) -> None:
    text = READ[name]
    apart = taken_apart(read(text))
    order = list(range(len(apart.pieces)))[::-1]
    before, after = canon.run(text, 0.001), canon.run(reordered(apart, order), 0.001)
    assert (after.error, len(after.burns)) == (None, len(before.burns))
    for k, burn in zip(order, after.burns, strict=True):
        was = before.burns[k]
        assert np.abs(np.array(burn.points) - np.array(was.points)).max() <= 0.001
        assert (burn.tool, burn.feeds_mm_min) == (was.tool, was.feeds_mm_min)
