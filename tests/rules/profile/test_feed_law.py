"""Feed laws: every row of the ByStar 3015's table, a plant's own law, and what is refused."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

import kerfwise as package
from kerfwise.encoder.errors import InputError
from kerfwise.rules.profile.load import load_profile, shipped_profiles
from kerfwise.rules.profile.time_section import FeedLaw, LawKind, LawPiece, shipped_laws
from kerfwise.tests.commands.run_cli import kerfwise

# Tavaeva and Petunin, table 1: n0, the feed set, the polynomial from n³ down, the power; m/s.
TABLE = {
    "st10kp-1mm": (172, 0.13, (-2e-12, 2e-8, -7e-5, 0.1415), (0.6633, -0.317)),
    "st10kp-2mm": (167, 0.0975, (-1e-12, 2e-8, -5e-5, 0.105), (0.49, -0.315)),
    "st10kp-3mm": (242, 0.06, (-4e-13, 5e-9, -2e-5, 0.066), (0.2145, -0.229)),
    "st10kp-3.5mm": (242, 0.042, (-3e-13, 3e-9, -1e-5, 0.0462), (0.1501, -0.229)),
    "st10kp-3.9mm": (242, 0.042, (-3e-13, 3e-9, -1e-5, 0.0462), (0.1501, -0.229)),
    "st10kp-4mm": (167, 0.04, (-8e-13, 8e-9, -2e-5, 0.0439), (0.1945, -0.306)),
    "st10kp-8mm": (288, 0.027, (-7e-11, 6e-9, -1e-5, 0.031), (0.0634, -0.15)),
    "st10kp-10mm": (288, 0.023, (-6e-11, 5e-9, -1e-5, 0.027), (0.054, -0.15)),
    "amg3m-1mm": (70, 0.1, (-4e-12, 3e-8, -9e-5, 0.105), (0.2572, -0.222)),
    "amg3m-1.5mm": (70, 0.067, (-3e-12, 2e-8, -6e-5, 0.07), (0.1723, -0.222)),
    "amg3m-2mm": (70, 0.048, (-7e-13, 6e-9, -2e-5, 0.0494), (0.0734, -0.1)),
    "amg3m-3mm": (72, 0.025, (-2e-13, 2e-9, -5e-6, 0.0254), (0.0346, -0.075)),
    "amg3m-5mm": (105, 0.015, (-7e-14, 7e-10, -2e-6, 0.0152), (0.0194, -0.057)),
}


def law(name: str) -> FeedLaw:
    return shipped_laws()[f"bystar-3015-{name}"]


def read(text: str) -> FeedLaw | None:
    return LawKind().read(yaml.compose(text, Loader=yaml.SafeLoader))  # type: ignore[arg-type]


def test_every_row_of_the_table_is_shipped() -> None:
    assert list(shipped_laws()) == [f"bystar-3015-{name}" for name in TABLE]
    extrapolated = {name for name in TABLE if "extrapolated" in law(name).source}
    assert extrapolated == {"st10kp-3.5mm", "st10kp-3.9mm", "st10kp-8mm", "st10kp-10mm", "amg3m-1.5mm"}


@pytest.mark.parametrize("name", TABLE)
def test_a_row(name: str) -> None:
    n0, at_n0, polynomial, (factor, exponent) = TABLE[name]
    made = law(name)
    for n in (1, 19, n0 // 2, n0 - 1):
        a, b, c, d = polynomial
        assert made.mm_s(n) == pytest.approx(1000 * (a * n**3 + b * n**2 + c * n + d))
    assert made.mm_s(n0) == 1000 * at_n0
    for n in (n0 + 1, 500, 1962):
        assert made.mm_s(n) == pytest.approx(1000 * factor * n**exponent)


@pytest.mark.parametrize("name", TABLE)
def test_the_formulas_of_a_row_meet_at_its_threshold(name: str) -> None:
    """A digit copied wrong would show here: both formulas are within 5 % of the feed that was set."""
    below, at, above = law(name).pieces
    assert at.up_to is not None
    assert below.at(at.up_to) == pytest.approx(at.at(at.up_to), rel=0.05)
    assert above.at(at.up_to) == pytest.approx(at.at(at.up_to), rel=0.02)


def test_known_answers_of_the_paper() -> None:
    """AMg3M, 1 mm, in m/s to the digits printed; its coefficients are rounded, so the last digit may be off by one."""
    below, _, above = law("amg3m-1mm").pieces
    assert below.at(70) == pytest.approx(0.0989, abs=1e-4)
    assert above.at(70) == pytest.approx(0.1, abs=2e-4)
    assert law("amg3m-1mm").mm_s(70) == 100.0
    assert law("amg3m-1mm").mm_s(19) / 1000 == pytest.approx(0.1033, abs=5e-5)
    assert law("amg3m-1mm").mm_s(1962) / 1000 == pytest.approx(0.04779, abs=1e-5)


def test_points_are_interpolated_and_held_beyond_the_ends() -> None:
    made = read("{points: [[19, 6.12 m/min], [70, 100 mm/s], [1962, 0.04776 m/s]]}")
    assert made is not None
    assert [made.mm_s(n) for n in (1, 19, 70, 1962, 5000)] == [102.0, 102.0, 100.0, 47.76, 47.76]
    assert made.mm_s(44) == pytest.approx(102 - 2 * 25 / 51)
    assert made.fastest_mm_s == 102.0


OWN = "{source: our own, unit: m/min, pieces: [{up_to: 50, polynomial: [6, -0.01]}, {power: [9.0, -1.2e-1]}]}"


def test_a_law_of_ones_own_in_formulas() -> None:
    made = read(OWN)
    assert made == FeedLaw("", "our own", "m/min", (LawPiece(50, (6.0, -0.01)), LawPiece(None, power=(9.0, -0.12))))
    assert made.mm_s(50) == pytest.approx(5500 / 60)
    assert made.mm_s(51) == pytest.approx(9000 * 51**-0.12 / 60)
    assert made.fastest_mm_s == pytest.approx(5990 / 60)


def test_what_is_written_reads_back() -> None:
    for text in (OWN, "{points: [[19, 6.12 m/min], [70, 33.3333 mm/s]]}", "bystar-3015-amg3m-5mm", "none"):
        made = read(text)
        assert read(LawKind().write(made)) == made


@given(
    st.dictionaries(st.integers(1, 1000), st.floats(1e-3, 1e4), min_size=1),
    st.lists(st.integers(1, 2000), min_size=2, max_size=2),
)
def test_points_bound_the_feed(points: dict[int, float], blocks: list[int]) -> None:
    made = FeedLaw(points=tuple(sorted(points.items())))
    assert made.wrong() is None
    for n in blocks:
        assert min(points.values()) * (1 - 1e-12) <= made.mm_s(n) <= made.fastest_mm_s * (1 + 1e-12)
        assert made.mm_s(n) == pytest.approx(points.get(n, made.mm_s(n)))


@given(st.sampled_from(sorted(TABLE)), st.integers(1, 3000))
def test_no_program_is_faster_than_the_fastest(name: str, blocks: int) -> None:
    assert 0 < law(name).mm_s(blocks) <= law(name).fastest_mm_s * (1 + 1e-12)


ENDS = "expected a constant (polynomial: [0.1]) or a power that does not rise, without up_to"
WRONG = {
    "bystar-3015-amg3m-4mm": "1:24: unknown feed law 'bystar-3015-amg3m-4mm': did you mean 'bystar-3015-amg3m-5mm'?",
    "[1, 2]": "1:24: expected a text, got a list of 2",
    "{}": "1:24: expected either points, [[blocks, feed], …], or pieces, one formula each",
    "{point: [[1, 2]]}": "1:25: unknown key 'point': did you mean 'points'? (valid: pieces, points, source, unit)",
    "{points: [[1, 200], [3]]}": "1:44: expected a point [blocks, feed] such as [120, 5.3 m/min]",
    "{points: [[1, quick]]}": "1:38: expected a speed over 0 such as 2500 or '2500 mm/min'",
    "{points: [[5, 200], [5, 100]]}": "1:33: numbers of blocks are expected in ascending order, got 5, 5",
    "{points: [[5, 2]], unit: m/s}": "1:49: unit is of pieces; points carry their own, such as [120, 5.3 m/min]",
    "{pieces: [{power: [1, -1]}]}": "1:24: the formulas need their unit: expected one of mm/min, mm/s, m/min",
    "{unit: m/s, pieces: []}": "1:44: expected a list of pieces",
    "{unit: m/s, pieces: [{up_to: 5}]}": "1:45: expected either polynomial: [a, b, c] (a + b n + c n²) or power",
    "{unit: m/s, pieces: [{power: [1]}]}": "1:53: expected power: [factor, exponent]",
    "{unit: m/s, pieces: [{power: [1, 0.1]}]}": "1:44: the last piece holds for all longer programs: " + ENDS,
    "{unit: m/s, pieces: [{polynomial: [1, 2]}]}": "1:44: the last piece holds for all longer programs: " + ENDS,
    "{unit: m/s, pieces: [{up_to: 9, power: [1, -1]}]}": "1:44: the last piece holds for all longer programs: " + ENDS,
    "{unit: m/s, pieces: [{up_to: 9, polynomial: [1, -0.2]}, {polynomial: [1]}]}": (
        "1:44: the feed must be over 0 for every n, it falls to -800 mm/s"
    ),
    "{unit: m/s, pieces: [{polynomial: [1]}, {power: [1, -1]}]}": (
        "1:44: only the last piece holds for all longer programs: give the others up_to"
    ),
}


@pytest.mark.parametrize("text", WRONG)
def test_mistakes_are_placed(text: str, tmp_path: Path) -> None:
    path = tmp_path / "plant.yaml"
    path.write_text(f"time: {{feed_by_blocks: {text}}}")
    with pytest.raises(InputError) as caught:
        load_profile(path)
    place, _, said = str(caught.value).removeprefix(f"{path}:").partition(": time.feed_by_blocks: ")
    assert f"{place}: {said}".startswith(WRONG[text]), str(caught.value)


def test_the_model_blocks_needs_a_law(tmp_path: Path) -> None:
    path = tmp_path / "plant.yaml"
    path.write_text("name: x\ntime:\n  model: blocks\n")
    with pytest.raises(InputError, match=r"plant.yaml:3:10: time.model: blocks needs a feed law: give time.feed_by"):
        load_profile(path)


def test_a_law_with_a_typo_is_one_mistake(tmp_path: Path) -> None:
    path = tmp_path / "plant.yaml"
    path.write_text("time: {model: blocks, feed_by_blocks: bystar-amg3m-1mm}\n")
    with pytest.raises(InputError, match="did you mean 'bystar-3015-amg3m-1mm'") as caught:
        load_profile(path)
    assert caught.value.details == ()


def test_the_profiles_in_the_docs_load(tmp_path: Path) -> None:
    page = (Path(package.__file__).parent / "docs" / "time.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)
    assert len(blocks) == 5
    for number, text in enumerate(blocks):
        path = tmp_path / f"{number}.yaml"
        path.write_text(text, encoding="utf-8")
        load_profile(path)


LEFT = (
    "time: the feed law bystar-3015-st10kp-2mm is for a cut_feed of 5.85 m/min and is not used at 2 m/min; times are "
    "told at that feed, with acceleration (give time.model for another)"
)


@pytest.mark.parametrize(
    ("text", "model", "notes"),
    [
        ("", "blocks", ()),
        ("machine: {cut_feed: 5.85 m/min}\n", "blocks", ()),
        ("machine: {cut_feed: 2 m/min}\n", "acceleration", (LEFT,)),
        ("machine: {cut_feed: 2 m/min}\ntime: {acceleration: 3 m/s2}\n", "acceleration", (LEFT,)),
        ("machine: {cut_feed: 2 m/min}\ntime: {model: constant}\n", "constant", ()),
        ("machine: {cut_feed: 2 m/min}\ntime: {feed_by_blocks: {points: [[20, 2 m/min]]}}\n", "blocks", ()),
    ],
)
def test_a_law_is_left_out_at_another_feed(tmp_path: Path, text: str, model: str, notes: tuple[str, ...]) -> None:
    (tmp_path / "plant.yaml").write_text(f"based_on: laser-st10kp-2mm\n{text}")
    (tmp_path / "next.yaml").write_text("based_on: plant.yaml\nmachine: {mark_feed: 9 m/min}\n")
    for name in ("plant.yaml", "next.yaml"):
        plant = load_profile(tmp_path / name)
        assert (plant.time.model, plant.time_and_price_notes()) == (model, notes)
    if notes:
        assert plant.said_at["time.model"].endswith("plant.yaml:2")
        assert plant.time.feed_by_blocks is None


def test_a_law_that_is_quicker_than_the_words_of_programs_is_told(tmp_path: Path) -> None:
    text = "machine: {{cut_feed: {}}}\ntime: {{model: blocks, feed_by_blocks: bystar-3015-amg3m-1mm}}\n"
    for feed, notes in (("2 m/min", 1), ("6 m/min", 0)):
        (tmp_path / "plant.yaml").write_text(text.format(feed))
        told = load_profile(tmp_path / "plant.yaml").time_and_price_notes()
        assert [note.partition(", and")[0] for note in told] == [
            "time: by the feed law bystar-3015-amg3m-1mm the torch moves at up to 6.295 m/min"
        ] * notes


def test_no_shipped_profile_is_quicker_than_its_words() -> None:
    assert [note for name in shipped_profiles() for note in load_profile(name).time_and_price_notes()] == []


def test_the_command_line_tells_once_that_a_law_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    ended = kerfwise("profile", "check", "laser-st10kp-2mm")
    assert (ended.code, "feed law" in ended.err) == (0, False)
    nest = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"
    ended = kerfwise("solve", nest, "-p", "laser-st10kp-2mm", "--set", "machine.cut_feed=2 m/min", "--work", "1")
    assert (ended.code, ended.err.count(f"note: {LEFT}")) == (0, 1)
