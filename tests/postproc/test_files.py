"""A set of files is written whole or not at all, whatever becomes of the command meanwhile."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc import output_files
from kerfwise.postproc.output_files import expect_outputs, write_files
from kerfwise.tests.tools.killing import COUNTED

NAMES = ("out.nc", "out.plan.json", "out.svg")
WRITER = f"""
{COUNTED}
from pathlib import Path
from kerfwise.postproc.output_files import write_files
for name in ("open", "fsync", "chmod", "link", "replace", "unlink", "fdopen"):
    setattr(os, name, counted(getattr(os, name)))
write_files({{Path(name): "new " + name for name in sys.argv[1:]}})
print("done")
"""


def folder_with_old(folder: Path) -> Path:
    folder.mkdir()
    for name in NAMES:
        (folder / name).write_text(f"old {name}")
    return folder


def generation(folder: Path) -> str:
    """The one generation that all files are of."""
    found = {(folder / name).read_text().split()[0] for name in NAMES}
    assert len(found) == 1, found
    return found.pop()


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="SIGKILL")
def test_a_kill_at_any_moment_leaves_whole_files_and_no_new_plan_beside_an_old_program(tmp_path: Path) -> None:
    outcomes = []
    for moment in range(1, 128, 2):
        folder = folder_with_old(tmp_path / str(moment))
        command = [sys.executable, "-c", WRITER, str(moment), *NAMES]
        ended = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert ended.returncode in (0, -9), ended.stderr
        texts = [(folder / name).read_text() for name in NAMES]
        assert all(text in (f"old {name}", f"new {name}") for text, name in zip(texts, NAMES, strict=True))
        program, plan, picture = (text.startswith("new") for text in texts)
        assert (program and picture) or not plan
        outcomes.append((program, plan, picture))
        if ended.stdout:
            break
    assert ended.stdout == "done\n"
    assert outcomes.count((False, False, False)) >= 6
    assert outcomes[-1] == (True, True, True)
    assert len(set(outcomes)) > 2


def test_ctrl_c_while_files_take_their_places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = folder_with_old(tmp_path / "pressed")
    replace, made = os.replace, []

    def pressed(new: str, place: str) -> None:
        made.append(place)
        if len(made) == 2:
            raise KeyboardInterrupt
        replace(new, place)

    monkeypatch.setattr(os, "replace", pressed)
    with pytest.raises(KeyboardInterrupt):
        write_files({folder / name: f"new {name}" for name in NAMES})
    assert generation(folder) == "old"
    assert sorted(p.name for p in folder.iterdir()) == sorted(NAMES)


@pytest.mark.parametrize("moment", range(1, 13))
def test_a_disk_that_is_full_at_any_moment(moment: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = folder_with_old(tmp_path / "full")
    count = 0

    for name in ("fsync", "link", "replace", "fdopen"):
        call = getattr(os, name)

        def full(*args: object, call: object = call, **named: object) -> object:
            nonlocal count
            count += 1
            if count == moment:
                raise OSError(28, "No space left on device")
            return call(*args, **named)  # type: ignore[operator]

        monkeypatch.setattr(os, name, full)
    expected, said = "new", ""  # a folder whose names could not be synced, or a copy in place of a link
    try:
        write_files({folder / name: f"new {name}" for name in NAMES})
    except InputError as error:
        expected, said = "old", str(error)
    monkeypatch.undo()
    assert generation(folder) == expected
    assert (expected == "old") == ("cannot write: No space left on device" in said)
    assert sorted(p.name for p in folder.iterdir()) == sorted(NAMES)


@pytest.mark.parametrize("held", NAMES)
def test_a_file_that_another_program_holds_open(held: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Windows refuses to replace it; here the call is made to refuse."""
    folder = folder_with_old(tmp_path / "held")
    replace = os.replace

    def refuses(new: str, place: str) -> None:
        if Path(place).name == held:
            raise PermissionError(13, "Access is denied", new, None, place)
        replace(new, place)

    monkeypatch.setattr(os, "replace", refuses)
    with pytest.raises(InputError, match="Access is denied") as error:
        write_files({folder / name: f"new {name}" for name in NAMES})
    assert Path(str(error.value.file)).name == held
    assert generation(folder) == "old"
    assert sorted(p.name for p in folder.iterdir()) == sorted(NAMES)


def test_a_link_is_followed_and_a_device_refused(tmp_path: Path) -> None:
    place = tmp_path / "place.nc"
    place.write_text("old")
    link = tmp_path / "link.nc"
    link.symlink_to(place)
    write_files({link: "new"})
    assert link.is_symlink()
    assert place.read_text() == "new"
    pipe = tmp_path / "pipe.nc"
    os.mkfifo(pipe)
    for path, words in (
        (pipe, "device or a pipe"),
        (Path("/dev/null"), "device or a pipe"),
        (tmp_path, "a folder"),
        (tmp_path / ("n" * 300), "no file can have this name"),
        (tmp_path / "a\0b.nc", "no file can have this name"),
        (tmp_path / "a\ud800.nc", "no file can have this name"),
    ):
        for write in (lambda p: expect_outputs([p], []), lambda p: write_files({p: "new"})):
            with pytest.raises(InputError, match=words):
                write(path)
    loop = tmp_path / "loop.nc"
    loop.symlink_to(loop)
    with pytest.raises(InputError, match="no file can have this name"):
        expect_outputs([loop], [])


def test_what_is_read_is_known_by_any_of_its_names(tmp_path: Path) -> None:
    read = tmp_path / "plant.yaml"
    read.write_text("name: plant")
    (tmp_path / "link").symlink_to(read)
    (tmp_path / "second").hardlink_to(read)
    for name in ("plant.yaml", "link", "second"):
        with pytest.raises(InputError, match="is read from"):
            expect_outputs([tmp_path / name], [read])


def test_a_name_as_long_as_the_system_allows(tmp_path: Path) -> None:
    path = tmp_path / ("n" * 252 + ".nc")
    write_files({path: "new"})
    assert path.read_text() == "new"
    with pytest.raises(InputError, match="half a character"):
        write_files({tmp_path / "a.nc": "\ud800"})


def test_what_a_kill_left_is_cleared_away_a_day_later(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    left = tmp_path / f"{output_files.BESIDE}abc"
    left.write_text("half")
    write_files({tmp_path / "a.nc": "new"})
    assert left.exists()
    now_s = time.time()
    monkeypatch.setattr(output_files.time, "time", lambda: now_s + 2 * 86400)
    write_files({tmp_path / "a.nc": "new"})
    assert not left.exists()
