"""What a user gets: source distribution and wheel are built, and each is installed in an empty environment."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest

import kerfwise

pytestmark = pytest.mark.slow

ROOT = Path(kerfwise.__file__).parent
OUTSIDE = ("tests", "examples", "benchmarks", "docs")
"""Folders of the source distribution that are no part of the package."""
MADE = (".*", "__pycache__", "*.egg-info", "build", "dist", "site", "*.nc", "*.plan.json")
ENVIRONMENT = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV")}
ENVIRONMENT["PIP_NO_COMPILE"] = "1"  # Python compiles what is imported, a small part of what is installed
ENVIRONMENT["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])


def run(command: str | list[str], cwd: Path) -> str:
    """What a command says that must end well, with no kerfwise but the one that it has installed itself."""
    shell = isinstance(command, str)
    ended = subprocess.run(command, shell=shell, cwd=cwd, env=ENVIRONMENT, capture_output=True, text=True)
    assert ended.returncode == 0, (command, ended.stdout, ended.stderr)
    return ended.stdout


def environment(folder: Path) -> Path:
    """A new environment; its folder of commands."""
    run([sys.executable, "-m", "venv", str(folder)], folder.parent)
    return folder / ("Scripts" if os.name == "nt" else "bin")


@dataclass(frozen=True)
class Built:
    """The two files that a release has, and the first one unpacked."""

    sdist: Path
    wheel: Path
    unpacked: Path

    @property
    def sources(self) -> set[str]:
        return {p.relative_to(self.unpacked).as_posix() for p in self.unpacked.rglob("*") if p.is_file()}


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Built:
    """Both, built from a copy of the checkout: the wheel from the source distribution."""
    work = tmp_path_factory.mktemp("built")
    shutil.copytree(ROOT, work / "checkout", ignore=shutil.ignore_patterns(*MADE))
    commands = environment(work / "builder")
    run([str(commands / "python"), "-m", "pip", "install", "-q", "build"], work)
    run([str(commands / "python"), "-m", "build", "--outdir", str(work / "dist"), str(work / "checkout")], work)
    (sdist,), (wheel,) = (work / "dist").glob("*.tar.gz"), (work / "dist").glob("*.whl")
    with tarfile.open(sdist) as archive:
        archive.extractall(work, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
    return Built(sdist, wheel, work / sdist.name.removesuffix(".tar.gz"))


def of_the_package(names: set[str]) -> set[str]:
    """The files in folders of the package, and the modules beside them."""
    inside = {name for name in names if "/" in name and name.split("/")[0] not in OUTSIDE}
    return {n for n in inside if ".egg-info/" not in n} | {n for n in names if "/" not in n and n.endswith(".py")}


def test_the_wheel_is_the_package_and_nothing_else(built: Built) -> None:
    with zipfile.ZipFile(built.wheel) as archive:
        names = {name for name in archive.namelist() if not re.match(r"kerfwise-[^/]+\.dist-info/", name)}
    of_the_wheel = {name.removeprefix("kerfwise/") for name in names}
    assert names == {f"kerfwise/{name}" for name in of_the_wheel}
    assert of_the_wheel == of_the_package(built.sources) | {"py.typed"}
    assert len(of_the_wheel) > 400


def test_the_source_distribution_is_the_checkout(built: Built) -> None:
    ignored = shutil.ignore_patterns(*MADE)
    checkout = set()
    for folder, folders, files in os.walk(ROOT):
        folders[:] = sorted(set(folders) - ignored(folder, folders))
        if Path(folder) != ROOT:
            kept = set(files) - ignored(folder, files)
            checkout |= {Path(folder, name).relative_to(ROOT).as_posix() for name in kept}
    assert {name for name in built.sources if "/" in name and ".egg-info/" not in name} == checkout
    assert {"LICENSE", "README.md", "pyproject.toml", "py.typed"} <= built.sources


@pytest.fixture(scope="module")
def said(built: Built) -> str:
    """What the first command of the README says, which makes an environment with what kerfwise needs and no more."""
    command = re.search(r"^python3 -m venv .+$", (built.unpacked / "README.md").read_text(encoding="utf-8"), re.M)
    assert command is not None
    return run(command[0], built.unpacked)


def test_the_first_command_of_the_readme(built: Built, said: str) -> None:
    assert "ok: every hard rule holds" in said
    assert "written: e1x_6.nc, e1x_6.plan.json, e1x_6.svg" in said
    assert all((built.unpacked / name).stat().st_size > 1000 for name in ("e1x_6.nc", "e1x_6.plan.json", "e1x_6.svg"))


def test_the_wheel_in_an_environment_with_what_it_needs(built: Built, said: str, tmp_path: Path) -> None:
    """That of the README's command, where kerfwise came from the sources; nothing is fetched for the wheel."""
    commands = built.unpacked / ".venv" / ("Scripts" if os.name == "nt" else "bin")
    run([str(commands / "pip"), "uninstall", "-q", "-y", "kerfwise"], tmp_path)
    run([str(commands / "pip"), "install", "-q", "--no-index", str(built.wheel)], tmp_path)
    where = run([str(commands / "python"), "-c", "import kerfwise; print(kerfwise.__file__)"], tmp_path)
    assert where.startswith(str(built.unpacked / ".venv"))
    kerfwise_ = str(commands / "kerfwise")
    assert run([kerfwise_, "--version"], tmp_path) == f"kerfwise, version {kerfwise.__version__}\n"
    assert run([kerfwise_, "rules", "test", "--cases"], tmp_path).endswith(" 0 failed\n")
    run([kerfwise_, "rules", "new", "bars-last", "--python"], tmp_path)
    assert run([kerfwise_, "rules", "test", "bars_last.py"], tmp_path).endswith(" 0 failed\n")
    run([kerfwise_, "rules", "hull-before", "--picture", "rule.svg"], tmp_path)
    nest = str(built.unpacked / "examples" / "nests" / "e1x_6.dxf")
    assert "ok: every hard rule holds" in run([kerfwise_, "solve", nest], tmp_path)
    assert "ok: every hard rule holds" in run([kerfwise_, "check", nest, "e1x_6.nc"], tmp_path)
    look = "from importlib import util; print(util.find_spec('kerfwise.tests'))"
    assert run([str(commands / "python"), "-c", look], tmp_path) == "None\n"
    more = run([str(commands / "pip"), "install", "--dry-run", f"{built.wheel}[serve,cluster,nest]"], tmp_path)
    assert all(f" {name}-" in more for name in ("starlette", "uvicorn", "distributed", "spyrrow"))
