"""Files that led to a traceback, or to no end, once: each is answered in one message, with exit code 2 or a verdict."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.tests.commands.run_cli import kerfwise

CASES = Path(__file__).parent / "cases"
NEST, PLAN = CASES / "small.json", CASES / "plan_with_unknown_contour.plan.json"


@pytest.mark.parametrize("words", [("explain", NEST, PLAN, "A.outer"), ("plot", NEST, PLAN, "-o", "drawn.svg")])
def test_a_plan_of_a_contour_that_the_nest_does_not_have(tmp_path: Path, words: tuple[str, ...]) -> None:
    done = kerfwise(*(tmp_path / word if word == "drawn.svg" else word for word in words))
    assert done.code == 2
    assert "cut 3 is of 'D.holetrue', which is no contour of it" in done.err
    assert not (tmp_path / "drawn.svg").exists()


def test_check_says_which_cut_it_is() -> None:
    done = kerfwise("check", NEST, PLAN)
    assert done.code == 1
    assert "cut 3 is of D.holetrue, which the nest does not have" in done.out


def test_a_grid_of_scrap_lines_too_fine_to_end(tmp_path: Path) -> None:
    done = kerfwise("solve", NEST, "-p", CASES / "feed_law_overflows.yaml", "-o", tmp_path / "out.nc")
    assert done.code == 2
    assert "cuts.scrap.grid: 1.5 mm is not likely" in done.err
    assert list(tmp_path.iterdir()) == []
