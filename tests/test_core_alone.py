"""The core plans without any app and without the libraries of apps; a verb of an app says which extra it needs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import kerfwise

NEST = Path(kerfwise.__file__).parent / "examples" / "nests" / "e1x_6.json"
PART = Path(kerfwise.__file__).parent / "examples" / "parts" / "tag.json"
LIBRARIES = ("distributed", "openpyxl", "segno", "spyrrow", "starlette", "uvicorn")
HIDES = """
import sys
class Finder:
    def __init__(self, finder):
        self.finder = finder
    def find_spec(self, name, path=None, target=None):
        if not any(name == one or name.startswith(one + ".") for one in {hidden!r}):
            return self.finder.find_spec(name, path, target)
    def __getattr__(self, name):
        return getattr(self.finder, name)
sys.meta_path = [Finder(finder) for finder in sys.meta_path]
from kerfwise.cli import main
for words in {commands!r}:
    try:
        main(words)
    except SystemExit as end:
        print("ended with", end.code, flush=True)
"""


def run_without(hidden: tuple[str, ...], folder: Path, *commands: list[str]) -> tuple[str, str]:
    """What commands say in one process that cannot import some modules."""
    script = HIDES.format(hidden=hidden, commands=commands)
    ended = subprocess.run([sys.executable, "-c", script], cwd=folder, capture_output=True, text=True, check=True)
    return ended.stdout, ended.stderr


@pytest.mark.slow
def test_the_core_plans_without_apps_and_their_libraries(tmp_path: Path) -> None:
    out, err = run_without(
        ("kerfwise.apps", *LIBRARIES), tmp_path,
        ["solve", str(NEST), "--work", "1"],
        ["check", str(NEST), "e1x_6.nc"],
        ["--help"],
        ["nest", "a.dxf=1"],
        ["solve", str(NEST), "--picture", "page.html"],
    )  # fmt: skip
    assert out.count("ok: every hard rule holds") == 2
    assert "Verbs:" in out
    assert "Verbs of apps" not in out
    assert "unknown verb 'nest'" in err
    assert "the app 'viewer' of kerfwise is not installed" in err
    assert [line for line in out.splitlines() if line.startswith("ended with")] == [
        f"ended with {code}" for code in (0, 0, 0, 2, 2)
    ]


@pytest.mark.slow
def test_a_verb_says_which_extra_it_needs_before_it_works(tmp_path: Path) -> None:
    (tmp_path / "parts.xlsx").write_bytes(b"PK")
    _, err = run_without(
        LIBRARIES, tmp_path,
        ["serve", str(NEST)],
        ["sheet", str(NEST), "any.plan.json"],
        ["nest", "parts.xlsx", "-o", "out"],
        ["nest", "new-list", "-o", "new.xlsx"],
        ["make", f"{PART}=1", "--sheet", "300x300", "-o", "out", "--sheets"],
        ["nest", f"{PART}=1", "--sheet", "300x300", "-o", "out", "--engine", "sparrow"],
        ["batch", str(NEST), "-o", "out", "--sheets"],
        ["batch", str(NEST), "-o", "out", "--scheduler", "tcp://127.0.0.1:9"],
    )  # fmt: skip
    extras = ["serve", "sheets", "nest", "nest", "sheets", "nest", "sheets", "cluster"]
    told = [line for line in err.splitlines() if line.startswith("kerfwise: ")]
    assert len(told) == len(extras), err
    assert all(f"pip install 'kerfwise[{extra}]'" in line for extra, line in zip(extras, told, strict=True)), told
    assert {path.suffix for path in tmp_path.rglob("*") if path.is_file()} <= {".lock", ".xlsx"}
