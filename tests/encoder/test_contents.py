"""Files are read up to a size, and whatever they are called."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import is_file, is_folder, is_there, read_limited


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
