import hashlib
import json
import subprocess
import sys
from pathlib import Path

import pytest

from kerfwise import InputError, read_nest

SMALL = {
    "format": "kerfwise-nest/1",
    "sheet": {"width": 100, "height": 50},
    "parts": [{"id": "A", "outer": [[5, 5], [45, 5], [45, 45]]}],
}


def test_a_nest_knows_its_file_but_not_the_folder(tmp_path: Path) -> None:
    path = tmp_path / "Small.JSON"
    path.write_text(json.dumps(SMALL))
    nest = read_nest(str(path))
    assert nest.file == "Small.JSON"
    assert nest.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.mark.parametrize("suffix", [".json", ".dxf", ".svg"])
def test_a_missing_file_and_an_empty_one(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"nest{suffix}"
    with pytest.raises(InputError, match="there is no such file"):
        read_nest(path)
    for nothing in (b"", b" \r\n\t"):
        path.write_bytes(nothing)
        with pytest.raises(InputError, match="the file is empty") as error:
            read_nest(path)
        assert error.value.file == path


def test_a_folder(tmp_path: Path) -> None:
    folder = tmp_path / "nest.json"
    folder.mkdir()
    for path in (folder, tmp_path):
        with pytest.raises(InputError, match="this is a folder"):
            read_nest(path)


@pytest.mark.parametrize("name", ["nest.dwg", "nest", "", "nest.json.gz", "\0.xml"])
def test_a_format_nobody_reads(name: str) -> None:
    with pytest.raises(InputError, match=r"expected \.dxf, \.json, \.svg|this is a folder"):
        read_nest(name)


def test_a_name_no_file_can_have() -> None:
    with pytest.raises(InputError, match="the file cannot be opened"):
        read_nest("a\0b.json")


def test_reading_json_loads_no_cad_library(tmp_path: Path) -> None:
    path = tmp_path / "small.json"
    path.write_text(json.dumps(SMALL))
    script = (
        "import sys; from kerfwise.encoder.readers import read_nest; read_nest(sys.argv[1]); "
        "print([m for m in ('ezdxf', 'svgelements', 'scipy', 'numba', 'ortools') if m in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", script, str(path)], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"
