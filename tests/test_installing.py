"""What a user gets: source distribution and wheel are built, and each is installed in an empty environment.

What kerfwise needs is fetched into that environment with `--all` only. Otherwise the environment borrows it from the
one that the tests run in, which shows all but a dependency that nobody has declared: `test_packaging.py` does.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest

import kerfwise
from kerfwise.tests.tools.amount import full

pytestmark = pytest.mark.slow

ROOT = Path(kerfwise.__file__).parent
OUTSIDE = ("tests", "examples", "benchmarks", "docs")
"""Folders of the source distribution that are no part of the package."""
MADE = (".*", "__pycache__", "*.egg-info", "build", "dist", "site", "*.nc", "*.plan.json")
ENVIRONMENT = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV")}
ENVIRONMENT["PIP_NO_COMPILE"] = "1"  # Python compiles what is imported, a small part of what is installed
ENVIRONMENT["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])


RULE = "level-ahead"
"""One of many: its cases come with the wheel."""
OWN = ("__pycache__", "_distutils_hack", "kerfwise*", "__editable__*", "pip", "pip-*", "setuptools", "setuptools-*")
"""What an environment has by itself, or is to have; and files in which a folder of packages names others."""


def run(command: str | list[str], cwd: Path, **more: str) -> str:
    """What a command says that must end well, with no kerfwise but the one that it has installed itself."""
    shell = isinstance(command, str)
    ended = subprocess.run(command, shell=shell, cwd=cwd, env=ENVIRONMENT | more, capture_output=True, text=True)
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


@dataclass(frozen=True)
class Installed:
    """The sources after the first command of the README, which makes an environment in them, and what it said."""

    folder: Path
    borrowed: dict[str, str]
    said: str

    def run(self, command: str, *words: object, cwd: Path) -> str:
        """What one of the environment's commands says."""
        commands = self.folder / ".venv" / ("Scripts" if os.name == "nt" else "bin")
        return run([str(commands / command), *map(str, words)], cwd, **self.borrowed)


def lent(folder: Path) -> dict[str, str]:
    """What the environment of the tests has besides kerfwise, for another one that fetches nothing."""
    folder.mkdir()
    for place in {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}:
        own = shutil.ignore_patterns(*OWN, "*.pth")(place, os.listdir(place))
        for name in {*os.listdir(place)} - {*own}:
            (folder / name).symlink_to(Path(place, name))
    return {"PIP_NO_DEPS": "1", "PYTHONPATH": str(folder)}


@pytest.fixture(scope="module", params=["borrowed", full("fetched")])
def installed(request: pytest.FixtureRequest, built: Built, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """The environment of the README's first command: with what kerfwise needs and no more, where that is fetched."""
    text = (built.unpacked / "README.md").read_text(encoding="utf-8")
    command = re.search(r"^python3 -m venv .+$", text, re.M)
    assert command is not None
    work = tmp_path_factory.mktemp(request.param)
    folder = work / built.unpacked.name
    shutil.copytree(built.unpacked, folder)
    borrowed = lent(work / "lent") if request.param == "borrowed" else {}
    return Installed(folder, borrowed, run(command[0], folder, **borrowed))


def test_the_first_command_of_the_readme(installed: Installed) -> None:
    assert "ok: every hard rule holds" in installed.said
    assert "written: e1x_6.nc, e1x_6.plan.json, e1x_6.svg" in installed.said
    assert all((installed.folder / name).stat().st_size > 1000 for name in ("e1x_6.nc", "e1x_6.plan.json", "e1x_6.svg"))


def test_the_wheel_in_an_environment_with_what_it_needs(built: Built, installed: Installed, tmp_path: Path) -> None:
    """That of the README's command, where kerfwise came from the sources; nothing is fetched for the wheel."""

    def says(command: str, *words: object) -> str:
        return installed.run(command, *words, cwd=tmp_path)

    says("pip", "uninstall", "-q", "-y", "kerfwise")
    says("pip", "install", "-q", "--no-index", built.wheel)
    where = says("python", "-c", "import kerfwise; print(kerfwise.__file__)")
    assert where.startswith(str(installed.folder / ".venv"))
    assert says("kerfwise", "--version") == f"kerfwise, version {kerfwise.__version__}\n"
    says("kerfwise", "rules", "new", "bars-last", "--python")
    assert says("kerfwise", "rules", "test", "bars_last.py", "--cases").endswith(" 0 failed\n")
    says("kerfwise", "rules", "hull-before", "--picture", "rule.svg")
    nest = installed.folder / "examples" / "nests" / "e1x_6.dxf"
    assert "ok: every hard rule holds" in says("kerfwise", "solve", nest)
    assert "ok: every hard rule holds" in says("kerfwise", "check", nest, "e1x_6.nc")
    look = "from importlib import util; print(util.find_spec('kerfwise.tests'))"
    assert says("python", "-c", look) == "None\n"
    assert says("kerfwise", "rules", "test", *([RULE] if installed.borrowed else []), "--cases").endswith(" 0 failed\n")
    if not installed.borrowed:
        assert says("kerfwise", "rules", "test", "bars_last.py").endswith(" 0 failed\n")
        more = says("pip", "install", "--dry-run", f"{built.wheel}[serve,cluster,nest,sheets]")
        assert all(
            f" {name}-" in more for name in ("starlette", "uvicorn", "distributed", "openpyxl", "segno", "spyrrow")
        )
