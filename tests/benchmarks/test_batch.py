"""The table of how many nests a minute: what is measured is kept, and the same command goes on from there."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from kerfwise.benchmarks import batch


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Stands in the place of kerfwise: each call writes a file a nest; which ways were run."""
    ways: list[str] = []

    def run(arguments: list[str], folder: Path) -> None:
        ways.append(" ".join([arguments[0], *arguments[8:]]))
        given = Path(arguments[1])
        nests = sorted(given.iterdir()) if given.is_dir() else [given]
        out = Path(arguments[arguments.index("-o") + 1]) if "-o" in arguments else folder
        out.mkdir(exist_ok=True)
        for nest in nests:
            (out / f"{nest.stem}.nc").write_text("M30\n")

    monkeypatch.setattr(batch, "run", run)
    return ways


def printed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *options: str) -> list[str]:
    monkeypatch.setattr(sys, "argv", ["batch", "--nests", "2", *options])
    assert batch.main() == 0
    return [line for line in capsys.readouterr().out.splitlines() if line.startswith("| ")]


def test_what_is_measured_is_kept(
    ran: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    into = ("--into", str(tmp_path / "kept"))
    first = printed(monkeypatch, capsys, *into, "--ways", "1")
    assert ran == ["solve"] * 3, "once to compile, then each nest"
    both = printed(monkeypatch, capsys, *into, "--ways", "1", "2")
    assert [line for line in ran[3:] if line != "solve"] == ["batch --jobs 1"]
    assert both[:2] == first
    assert both[2].startswith("| batch, 1 job |")
    with pytest.raises(SystemExit):
        printed(monkeypatch, capsys, *into, "--nests", "3")


def test_a_way_that_was_stopped_begins_anew(
    ran: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    old = tmp_path / "out2"
    old.mkdir()
    (old / "half.nc").write_text("x")
    printed(monkeypatch, capsys, "--into", str(tmp_path), "--ways", "1", "2")
    assert sorted(path.name for path in old.iterdir()) == ["nest0001.nc", "nest0002.nc"]
