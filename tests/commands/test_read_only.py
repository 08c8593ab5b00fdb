"""Where nothing may be written - home, installation, temporary files, the folder - all that writes nothing works.

The commands run as a user who is bound by permissions: root is stripped of what lets it write everywhere.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.tests.commands.test_boundary import PLAIN
from kerfwise.tests.tools.amount import few

ROOT = Path(package.__file__).parent
LEFT_OUT = ("tests", "docs", ".git", "__pycache__", ".*", "*.egg-info", "build", "examples", "benchmarks")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX")]


def bound(*command: str) -> list[str]:
    """The command, as a user who may not write where permissions say so."""
    if os.geteuid() != 0:
        return list(command)
    setpriv = shutil.which("setpriv")
    assert setpriv, "setpriv (util-linux) is missing: run this test as another user than root"
    return [setpriv, "--bounding-set=-all", "--inh-caps=-all", *command]


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An installation, a home, and a folder with files; none of it may be written."""
    place = tmp_path_factory.mktemp("read-only")
    shutil.copytree(ROOT, place / "site" / "kerfwise", ignore=shutil.ignore_patterns(*LEFT_OUT))
    (place / "home").mkdir()
    work = place / "work"
    work.mkdir()
    (work / "plain.json").write_text(json.dumps(PLAIN))
    command = [sys.executable, "-m", "kerfwise.cli", "solve", "plain.json", "--work", "0.1"]
    subprocess.run(command, cwd=work, check=True, capture_output=True)
    for path in (place, *place.rglob("*")):
        if not path.is_symlink():
            path.chmod(0o555 if path.is_dir() else 0o444)
    yield place
    for path in (place, *place.rglob("*")):
        if path.is_dir():
            path.chmod(0o755)


def ended(place: Path, *words: str, temporary: str = "home") -> subprocess.CompletedProcess[str]:
    home = str(place / "home")
    env = {
        "PATH": os.environ["PATH"],
        "HOME": home,
        "XDG_CACHE_HOME": home,
        "TMPDIR": str(place / temporary),
        "PYTHONPATH": str(place / "site"),
    }
    return subprocess.run(
        bound(sys.executable, "-m", "kerfwise.cli", *words),
        cwd=place / "work",
        env=env,
        capture_output=True,
        text=True,
        check=False,
    )


def test_nothing_may_be_written_there(place: Path) -> None:
    for folder in ("home", "work", "site/kerfwise", "site/kerfwise/models/engines"):
        tried = subprocess.run(bound("touch", str(place / folder / "x")), capture_output=True, check=False)
        assert tried.returncode != 0
    found = subprocess.run(
        bound(sys.executable, "-c", "import kerfwise; print(kerfwise.__file__)"),
        env={"PYTHONPATH": str(place / "site")},
        capture_output=True,
        text=True,
        check=True,
    )
    assert found.stdout.startswith(str(place / "site"))


@pytest.mark.parametrize(
    "words",
    few(
        [
            ("check", "plain.json", "plain.nc"),
            ("explain", "plain.json", "plain.plan.json", "A.outer"),
            ("profile", "check", "water-jet"),
            ("rules", "pierce"),
            ("check", "plain.json", "plain.plan.json"),
            ("time", "plain.json", "plain.nc"),
            ("facts", "plain.json"),
            ("profile", "show", "laser-wood"),
            ("rules",),
            ("engines",),
            ("--version",),
        ],
        2,
    ),
)
def test_what_writes_nothing_works(words: tuple[str, ...], place: Path) -> None:
    done = ended(place, *words)
    assert (done.returncode, done.stdout != "") == (0, True), done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    "words",
    few(
        [
            ("plot", "plain.json", "-o", "out.svg"),
            ("rules", "new", "some-rule", "--into", "../site/kerfwise"),
            ("facts", "plain.json", "-o", "facts.json"),
            ("rules", "pierce", "--picture", "pierce.svg"),
        ],
        2,
    ),
)
def test_what_writes_says_where_it_may_not(words: tuple[str, ...], place: Path) -> None:
    done = ended(place, *words)
    assert done.returncode == 2, done.stderr
    [line] = [line for line in done.stderr.splitlines() if line.startswith("kerfwise: ")]
    assert "ermission denied" in line or "no source checkout" in line


def test_a_plan_is_made_where_its_outputs_alone_may_be_written(place: Path, tmp_path: Path) -> None:
    """Kernels could not be kept there; a small nest needs none."""
    out = tmp_path / "out.nc"
    done = ended(place, "solve", "plain.json", "--work", "0.1", "--engine", "ideals", "-o", str(out))
    assert done.returncode == 0, done.stderr
    assert out.read_bytes() == (place / "work" / "plain.nc").read_bytes()
    assert "kernels" not in done.stderr
