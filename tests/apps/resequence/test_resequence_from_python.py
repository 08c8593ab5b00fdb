"""kerfwise.resequence: the program that the command line writes, from Python; and the example on its page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import kerfwise
from kerfwise.tests.commands.run_cli import kerfwise as command_line
from kerfwise.tests.postproc.old.programs import READ

PAGE = Path(kerfwise.__file__).parent / "docs/resequence.md"


def test_it_gives_what_the_command_line_writes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("old.nc").write_text(READ["squares with holes"])
    assert command_line("resequence", "old.nc", "--sheet", "300x100", "--work", 2, "--picture", "both.svg").code == 0
    better = kerfwise.resequence("old.nc", sheet_mm=(300, 100), work=2)
    assert better.program.encode() == Path("old.resequenced.nc").read_bytes()
    assert better.picture().content == Path("both.svg").read_bytes()
    assert better.picture("png").content.startswith(b"\x89PNG")
    assert better.save("better.nc") == Path("better.nc")
    with pytest.raises(kerfwise.InputError, match="is read from"):
        better.save("old.nc")


def test_what_cannot_be_told_is_refused_and_done_by_travel_if_asked_for(tmp_path: Path) -> None:
    old = tmp_path / "old.nc"
    old.write_text(READ["rows"])
    with pytest.raises(kerfwise.InputError, match="without_rules=True"):
        kerfwise.resequence(old, feed_mm_min=2500)
    assert "no rule was asked" in kerfwise.resequence(old, feed_mm_min=2500, without_rules=True, work=1).ends
    with pytest.raises(kerfwise.InputError, match=r"old\.nc: .*No such file|cannot read"):
        kerfwise.resequence(tmp_path / "gone" / "old.nc")


def test_progress_may_stop_it(tmp_path: Path) -> None:
    old = tmp_path / "old.nc"
    old.write_text(READ["squares with holes"])
    reached: list[kerfwise.Reached] = []
    made = kerfwise.resequence(old, work=2, on_progress=lambda now: bool(reached.append(now)))
    assert reached
    assert made.after.idle_mm <= made.before.idle_mm


def test_the_example_of_the_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("old.nc").write_text(READ["squares with holes"])
    (example,) = re.findall(r"```python\n(.*?)```", PAGE.read_bytes().decode(), re.DOTALL)
    exec(example, {})
    assert Path("better.nc").is_file()
