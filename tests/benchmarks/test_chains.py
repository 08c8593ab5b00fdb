"""The page on what chains save, tried on a small plate."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.benchmarks.chain_proofs import rows
from kerfwise.benchmarks.chains import Row, kept, main, row
from kerfwise.benchmarks.plates import made_plate
from kerfwise.encoder.errors import InputError


def test_a_row_tells_plain_plans_and_gaps_apart() -> None:
    plain = Row("plate", "laser", 2.0, None, 12, 20_500.0, 4_250.0, 41.04, 512.3, 0.0, 1.4)
    assert str(plain) == "| plate | laser | 2 | – | 12 | 20.50 | 4.25 | 41.0 | 512 | 0 | 1 |"
    assert " | 3 | " in str(Row("plate", "plasma", 0.5, 3, 9, 1.0, 1.0, 1.0, 1.0, 0.0123, 1.0))
    assert " | 1.23% | " in str(Row("plate", "plasma", 0.5, 3, 9, 1.0, 1.0, 1.0, 1.0, 0.0123, 1.0))


def test_a_row_that_is_kept_is_not_made_again(tmp_path: Path) -> None:
    made = [
        Row("one", "plasma", 2.0, None, 12, 20_500.0, 4_250.0, 41.04, 512.3, None, 1.4),
        Row("two", "plasma", 2.0, 1, 1, 1, 1, 1, 1, 0, 1),
    ]
    file, waiting = tmp_path / "115.2.plain.json", iter(made)
    assert kept(file, lambda: next(waiting)) == kept(file, lambda: next(waiting)) == made[0]
    assert kept(None, lambda: next(waiting)) == made[1]


def test_a_nest_that_is_missing_is_told_before_any_plan(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("sys.argv", ["chains", "--contours", "20", "--nests", str(tmp_path / "none.json")])
    monkeypatch.setattr("kerfwise.benchmarks.chains.row", lambda *_: pytest.fail("a plan was made"))
    with pytest.raises(InputError, match="none"):
        main()


@pytest.mark.slow
def test_links_save_pierces_and_time() -> None:
    nest = made_plate(20, seed=1)
    plain, linked = (row(nest, "plate", "plasma", 2.0, on, 2.0) for on in (False, True))
    assert plain.gap == linked.gap == 0
    assert linked.links
    assert linked.pierces == plain.pierces - linked.links
    assert linked.program_s < plain.program_s


@pytest.mark.slow
def test_zones_are_proven_with_links_and_without() -> None:
    """Both come to a proof; what it takes is for the page to say."""
    (line,) = rows([20], 2.0, 100.0, tries=1)
    cells = line.strip("| ").split(" | ")
    assert len(cells) == 8
    assert "not proven" not in line
    assert int(cells[2]) > 0
