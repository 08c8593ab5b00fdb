"""The verb engines: what can be used here, and what to do where MiniZinc is missing."""

from __future__ import annotations

import minizinc
import pytest
from click.testing import CliRunner

from kerfwise.commands.engines import command


@pytest.mark.minizinc
def test_the_solvers_of_minizinc_are_listed() -> None:
    result = CliRunner().invoke(command)
    assert result.exit_code == 0
    first, *others = result.output.splitlines()
    assert first.startswith("cp-sat")
    assert any(line.split()[:3] == ["minizinc", "--solver", "gecode"] for line in others), result.output


def test_without_minizinc_it_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(minizinc, "default_driver", None)
    result = CliRunner().invoke(command)
    assert result.exit_code == 0
    assert "apt-get install minizinc" in result.output
