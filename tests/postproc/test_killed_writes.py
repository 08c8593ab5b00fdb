"""A command that is killed with all that belongs to it: whoever reads its files next finds one generation."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kerfwise.encoder import swap
from kerfwise.encoder.contents import contents
from kerfwise.encoder.errors import InputError
from kerfwise.postproc.files import write_files
from kerfwise.tests.postproc.test_files import NAMES, WRITER, folder_with_old
from kerfwise.tests.tools.amount import few

ALONE = f"import sys\nsys.executable = ''\n{WRITER}"
"""Writes as `WRITER` does, with no process beside it that would go on: a kill ends all, as a power cut does."""
posix = pytest.mark.skipif(os.name != "posix", reason="SIGKILL")


def read(*places: Path) -> str:
    """The one generation that the files are of, as the next command reads them."""
    for place in places:
        leave_alone(place.parent)
    found = {contents(place).decode().split()[0] for place in places}
    assert len(found) == 1, found
    return found.pop()


def leave_alone(folder: Path) -> None:
    """Let time go by: a list is taken over once it has stood longer than any moving takes."""
    long_ago_s = time.time() - 2 * swap.PATIENCE_S
    if (folder / swap.LIST).exists():
        os.utime(folder / swap.LIST, (long_ago_s, long_ago_s))


def killed(moment: int, places: list[Path], folder: Path) -> bool:
    """Whether a run was killed at that moment; False where it was done before."""
    command = [sys.executable, "-c", ALONE, str(moment), *map(str, places)]
    ended = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert ended.returncode in (0, -9), ended.stderr
    return ended.returncode != 0


@posix
@pytest.mark.slow
def test_a_kill_of_everything_at_any_moment_leaves_one_generation_to_read(tmp_path: Path) -> None:
    outcomes, mixed = [], 0
    for moment in range(1, 64):
        folder = folder_with_old(tmp_path / str(moment))
        places = [folder / name for name in NAMES]
        ended = not killed(moment, [Path(name) for name in NAMES], folder)
        mixed += len({place.read_text().split()[0] for place in places}) > 1
        outcomes.append(read(*places))
        if ended:
            break
    assert ended
    assert mixed >= 2  # without whoever reads next there would be two generations
    assert outcomes.count("old") >= 12
    assert outcomes.count("new") >= 6


@posix
@pytest.mark.slow
def test_files_of_several_folders_too(tmp_path: Path) -> None:
    outcomes, moment, ended = [], 0, False
    while not ended:
        moment += 2
        places = [folder_with_old(tmp_path / f"{moment}{k}") / name for k, name in enumerate(NAMES)]
        ended = not killed(moment, places, tmp_path)
        outcomes.append(read(*reversed(places)))
        assert not list(tmp_path.rglob(swap.LIST))
    assert outcomes.count("old") >= 12
    assert outcomes.count("new") >= 6


def half_moved(folder: Path) -> list[Path]:
    """Files of which one is new, and a list that says that all are to be."""
    moves = []
    for name in NAMES:
        (folder / f"{swap.BESIDE}{name}").write_text(f"new {name}")
        moves.append((str(folder / f"{swap.BESIDE}{name}"), str(folder / name), None))
    swap.write_list(str(folder / swap.LIST), moves)
    os.replace(*moves[1][:2])
    leave_alone(folder)
    return [folder / name for name in NAMES]


def test_what_cannot_be_put_right_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder that may not be written: other files in it are read all the same."""
    folder = folder_with_old(tmp_path / "half")
    places = half_moved(folder)
    (folder / "other.nc").write_text("other")

    def refused(new: str, place: str) -> None:
        raise OSError(30, "Read-only file system", place)

    monkeypatch.setattr(os, "replace", refused)
    for place in places:
        with pytest.raises(InputError, match="was killed while it put this file and others") as error:
            contents(place)
        assert error.value.file == place
    assert contents(folder / "other.nc") == b"other"
    monkeypatch.undo()
    assert read(*places) == "new"


def test_a_reader_waits_for_who_is_moving(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = folder_with_old(tmp_path / "moving")
    places = half_moved(folder)
    os.utime(folder / swap.LIST)
    slept = []

    def goes_on(seconds: float) -> None:
        slept.append(seconds)
        if len(slept) == 3:
            swap.take_over(str(folder / swap.LIST))

    monkeypatch.setattr(swap.time, "sleep", goes_on)
    assert contents(places[0]) == b"new out.nc"
    assert len(slept) == 3


@pytest.mark.parametrize(
    "rows",
    [
        [["/x/.kerfwise-a", "/y/b", None]],
        [["/x/a", "/x/b", None]],
        [["{folder}/stolen", "{folder}/out.nc", None], ["{folder}/.kerfwise-b", "{folder}/out.svg", None]],
        [["{folder}/.kerfwise-b", "{folder}/out.svg", "{folder}/out.nc"]],
        [[1, 2, 3]],
        [["{folder}/.kerfwise-b", "{folder}/out.svg"]],
        {"a": 1},
        [None],
        "x",
    ],
)
def test_a_list_that_kerfwise_has_not_written_is_not_obeyed(rows: object, tmp_path: Path) -> None:
    folder = folder_with_old(tmp_path / "found")
    (folder / "stolen").write_text("stolen")
    (folder / swap.LIST).write_text(json.dumps(rows).replace("{folder}", str(folder)) + "\n")
    assert read(*(folder / name for name in NAMES)) == "old"
    assert (folder / "stolen").exists()
    assert sorted(path.name for path in folder.iterdir()) == sorted([*NAMES, "stolen"])


def test_a_list_that_cannot_be_removed_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = folder_with_old(tmp_path / "in the way")
    (folder / swap.LIST).mkdir()
    monkeypatch.setattr(swap, "PATIENCE_S", 0.05)
    with pytest.raises(InputError, match="is in the way") as error:
        write_files({folder / name: "new" for name in NAMES})
    assert error.value.file is not None
    (folder / swap.LIST).rmdir()
    assert read(*(folder / name for name in NAMES)) == "old"
    assert sorted(path.name for path in folder.iterdir()) == sorted(NAMES)


TWO = """
import sys, time
from pathlib import Path
from kerfwise.postproc.files import write_files
time.sleep(float(sys.argv[1]))
for k in range(5):
    write_files({Path(name): f"{sys.argv[2]}{k} {name}" for name in sys.argv[3:]})
"""


@pytest.mark.slow
@pytest.mark.parametrize("moment", few(sorted(range(12), key=lambda moment: moment % 6), 2))
def test_two_runs_at_once_leave_the_files_of_one(moment: int, tmp_path: Path) -> None:
    """One of them starts later, by a little more each time."""
    folder = folder_with_old(tmp_path / "two")
    started = [
        subprocess.Popen([sys.executable, "-c", TWO, str(late_s), who, *NAMES], cwd=folder)
        for who, late_s in (("one", 0.0), ("other", 0.01 * moment))
    ]
    assert [process.wait(60) for process in started] == [0, 0]
    assert read(*(folder / name for name in NAMES)) in ("one4", "other4")
    assert sorted(path.name for path in folder.iterdir()) == sorted(NAMES)
