"""Lists of parts to nests and programs from Python: as the command line does it."""

from __future__ import annotations

from pathlib import Path

import pytest

import kerfwise
from kerfwise.tests.commands.run_cli import kerfwise as run

FOLDER = Path(kerfwise.__file__).parent / "examples" / "parts"
PARTS = {FOLDER / "flange.json": 3, FOLDER / "tag.json": 4}


def test_nests_are_those_of_the_command_line(tmp_path: Path) -> None:
    laid = kerfwise.nest(PARTS, sheets={"1000x600": 1}, rounds=2)
    saved = laid.save(tmp_path / "python")
    words = [f"{file}={count}" for file, count in PARTS.items()]
    ended = run("nest", *words, "--sheet", "1000x600=1", "--rounds", "2", "-o", tmp_path / "line")
    assert ended.code == 0
    assert str(laid) in ended.out
    for path in saved:
        assert path.read_bytes() == (tmp_path / "line" / path.name).read_bytes(), path.name
    assert laid.missing == {}
    assert 0 < laid.use < 1
    assert str(laid.picture()).startswith("<svg")


def test_programs_are_made_and_saved(tmp_path: Path) -> None:
    made = kerfwise.make({FOLDER / "tag.json": 2}, sheets="300x200", rounds=1, work=0.3)
    assert made.programs[0].startswith("sheet1.nc: ")
    names = {path.name for path in made.save(tmp_path / "out")}
    assert {"sheet1.nc", "sheet1.plan.json", "sheet1.json", "nests.json"} <= names
    assert kerfwise.check(tmp_path / "out" / "sheet1.json", tmp_path / "out" / "sheet1.nc").ok


def test_a_callback_ends_the_look_and_nothing_is_weighed_then() -> None:
    seen: list[int] = []
    laid = kerfwise.nest(
        PARTS,
        sheets="1000x600",
        purpose="cutting",
        weigh=2,
        weigh_work=0.2,
        on_round=lambda n, sheets: seen.append(n) or False,
    )
    assert seen == [1]
    assert laid.interrupted
    assert laid.prices == ()


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"engine": "parrow"}, "unknown engine 'parrow'"),
        ({"purpose": "speed"}, "unknown purpose 'speed'"),
        ({"rounds": 0}, "rounds: expected a whole number from 1, got 0"),
        ({"edge_mm": 0.0}, "the torch runs half a kerf"),
        ({"gap_mm": -1.0}, "gap_mm: expected 0 or more"),
    ],
)
def test_what_cannot_be_used_is_refused(more: dict[str, object], said: str) -> None:
    with pytest.raises(kerfwise.InputError, match=said):
        kerfwise.nest(PARTS, sheets="1000x600", **more)  # type: ignore[arg-type]


@pytest.mark.slow
def test_what_is_weighed_is_told() -> None:
    laid = kerfwise.nest(PARTS, sheets="1000x600", purpose="cutting", weigh=2, weigh_work=0.2, rounds=2)
    assert len(laid.prices) == 2
    assert "← taken" in str(laid)
