"""The verb engines: what can be used here, and what to do where MiniZinc is missing."""

from __future__ import annotations

import json
from pathlib import Path

import minizinc
import pytest
from click.testing import CliRunner

from kerfwise import InputError, solve
from kerfwise.cli import program
from kerfwise.tests.commands.run_cli import kerfwise


@pytest.mark.minizinc
def test_the_solvers_of_minizinc_are_listed() -> None:
    result = kerfwise("engines")
    assert result.code == 0
    first, *others = result.out.splitlines()
    assert first.split()[0] == "portfolio"
    assert "old name cp-sat" in first
    assert any(line.split()[:3] == ["minizinc", "--solver", "gecode"] for line in others), result.out


@pytest.mark.parametrize("named", [("gecode",), ("chuffed", "--engine", "cp-sat-alone")])
def test_a_solver_without_its_engine_is_refused(named: tuple[str, ...]) -> None:
    """It was not looked at."""
    done = CliRunner().invoke(program, ["solve", "none.json", "--solver", *named])
    assert done.exit_code == 2
    assert "--solver is for --engine minizinc" in done.output


@pytest.mark.minizinc
def test_what_minizinc_lacks_is_no_fault_of_the_nest() -> None:
    nest = str(Path(__file__).parents[2] / "examples" / "nests" / "e1x_6.json")
    done = kerfwise("solve", nest, "--engine", "minizinc", "--solver", "gecod")
    assert done.err.startswith("kerfwise: MiniZinc here: unknown solver 'gecod'")


def test_python_refuses_a_solver_without_its_engine() -> None:
    nest = Path(__file__).parents[2] / "examples" / "nests" / "e1x_6.dxf"
    with pytest.raises(InputError, match="the solver chuffed is for the engine minizinc"):
        solve(nest, solver="chuffed")


def test_without_minizinc_it_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(minizinc, "default_driver", None)
    result = kerfwise("engines")
    assert result.code == 0
    assert "apt-get install minizinc" in result.out


@pytest.mark.parametrize("named", [(), ("--engine", "cp-sat"), ("--engine", "portfolio")])
def test_plans_name_the_engine_by_its_name_of_today(named: tuple[str, ...], tmp_path: Path) -> None:
    nest, plan = tmp_path / "one.json", tmp_path / "one.plan.json"
    square = [[50, 50], [150, 50], [150, 150], [50, 150]]
    nest.write_text(
        json.dumps(
            {
                "format": "kerfwise-nest/1",
                "units": "mm",
                "sheet": {"width": 200, "height": 200},
                "parts": [{"id": "P1", "outer": square, "holes": [], "marks": []}],
            }
        )
    )
    done = CliRunner().invoke(program, ["solve", str(nest), "--plan", str(plan), *named])
    assert done.exit_code == 0, done.output
    assert json.loads(plan.read_text())["solve"]["engine"] == "portfolio"


def test_a_plan_that_bears_the_old_name_is_read(tmp_path: Path) -> None:
    nest = Path(__file__).parents[2] / "examples" / "nests" / "e1x_6.dxf"
    plan = tmp_path / "old.plan.json"
    runner = CliRunner()
    assert runner.invoke(program, ["solve", str(nest), "--plan", str(plan)]).exit_code == 0
    old = json.loads(plan.read_text())
    old["solve"]["engine"] = "cp-sat"
    plan.write_text(json.dumps(old))
    checked = runner.invoke(program, ["check", str(nest), str(plan)])
    assert checked.exit_code == 0, checked.output


def test_a_name_that_is_none_is_answered_with_those_that_are() -> None:
    result = CliRunner().invoke(program, ["bench", "nothing.json", "--engine", "cpsat"])
    assert result.exit_code == 2
    assert "portfolio" in result.output
    assert "'cp-sat'" not in result.output
