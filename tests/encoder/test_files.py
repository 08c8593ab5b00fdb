"""What is read from files and folders, how much of it, and how errors list what is wrong."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from kerfwise import InputError
from kerfwise.encoder import files
from kerfwise.encoder.errors import MOST_DETAILS
from kerfwise.encoder.files import expect_readable, is_file, is_folder, is_there, only_ours, read_limited


def test_a_file_is_read_up_to_a_size(tmp_path: Path) -> None:
    path = tmp_path / "a.nc"
    path.write_bytes(b"x" * 1_000_000)
    assert len(read_limited(path, 1_000_000)) == 1_000_000
    path.write_bytes(b"x" * 1_000_001)
    with pytest.raises(InputError, match=r"a\.nc: holds over 1 MB: too large"):
        read_limited(path, 1_000_000)


@pytest.mark.skipif(not is_there("/dev/zero"), reason="Linux")
def test_what_never_ends_is_not_read_to_its_end() -> None:
    with pytest.raises(InputError, match="holds over 2 MB"):
        read_limited("/dev/zero", 2_000_000)


@pytest.mark.parametrize("name", ["", "nowhere", "n" * 300, "a\0b", "a\udcff\ud800", "nowhere/x"])
def test_whether_something_is_there_is_answered_for_every_name(name: str, tmp_path: Path) -> None:
    assert not is_file(tmp_path / name)
    assert is_folder(tmp_path / name) == is_there(tmp_path / name) == (name == "")


posix = pytest.mark.skipif(not hasattr(os, "getuid"), reason="Windows has no such rights")


@posix
@pytest.mark.parametrize(("mode", "ours"), [(0o700, True), (0o755, True), (0o757, False), (0o1777, False)])
def test_a_folder_is_ours_where_no_other_may_write(tmp_path: Path, mode: int, ours: bool) -> None:
    folder = tmp_path / "kept"
    folder.mkdir()
    folder.chmod(mode)
    assert only_ours(folder) is ours


@posix
def test_what_lies_above_counts_as_well(tmp_path: Path) -> None:
    folder = tmp_path / "open" / "kept"
    folder.mkdir(parents=True)
    folder.parent.chmod(0o777)
    assert not only_ours(folder)  # somebody may put another in its place
    folder.parent.chmod(0o1777)  # as in /tmp: only who owns it may
    assert only_ours(folder)


@posix
def test_of_another_user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "kept"
    folder.mkdir()
    if os.getuid() == 0:
        os.chown(folder, 12345, -1)
    else:
        monkeypatch.setattr(os, "getuid", lambda: 12345)
    assert not only_ours(folder)


def test_only_files_of_the_folders_given_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    served, other = tmp_path / "served", tmp_path / "served too"
    for folder in (served, other):
        folder.mkdir()
        (folder / "a.yaml").write_text("secret", encoding="utf-8")
    (served / "link.yaml").symlink_to(other / "a.yaml")
    (served / "here.yaml").symlink_to(served / "a.yaml")
    monkeypatch.setattr(files, "_only_within", None)
    assert read_limited(other / "a.yaml") == b"secret"
    files.read_only_within([served])
    monkeypatch.chdir(served)
    for name in ("a.yaml", "here.yaml", served / "a.yaml", "../served/a.yaml"):
        assert read_limited(name) == b"secret"
    for name in (other / "a.yaml", "../served too/a.yaml", "link.yaml", "/etc/passwd", "../nothing", "/dev/zero"):
        with pytest.raises(InputError, match="it lies outside of the folder that is served"):
            read_limited(name)
    with pytest.raises(InputError, match="no file, but a folder"):
        expect_readable(served)
    with pytest.raises(FileNotFoundError):
        read_limited("nothing.yaml")


def text(lines: int) -> list[str]:
    return str(InputError("wrong", file="nest.dxf", details=tuple(f"line {k}" for k in range(lines)))).splitlines()


def test_a_long_list_is_cut_short_and_says_how_many_are_left_out() -> None:
    assert text(0) == ["nest.dxf: wrong"]
    assert text(MOST_DETAILS)[-1] == f"  - line {MOST_DETAILS - 1}"
    assert text(MOST_DETAILS + 92)[-2:] == [f"  - line {MOST_DETAILS - 1}", "  … and 92 more"]
