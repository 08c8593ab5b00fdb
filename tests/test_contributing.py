"""CONTRIBUTING.md and CHANGELOG.md name what is there."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from importlib import util
from pathlib import Path

import pytest

import kerfwise

ROOT = Path(kerfwise.__file__).parent
PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
CHANGES = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def test_every_command_starts_something_that_is_there() -> None:
    modules = re.findall(r"python -m ([\w.]+)", PAGE)
    scripts = re.findall(r"(?:python|sh) ([\w/]+\.(?:py|sh))", PAGE)
    assert len(modules) > 1
    assert len(scripts) > 3
    assert [name for name in modules if util.find_spec(name) is None] == []
    assert [name for name in scripts if not (ROOT / name).is_file()] == []


def test_every_generated_page_is_there() -> None:
    pages = re.findall(r"^\| `(\S+)` \|", PAGE.split("## Generated pages")[1], re.MULTILINE)
    assert len(pages) > 3
    assert [page for page in pages if not (ROOT / page).is_file()] == []


@pytest.mark.parametrize("page", ["docs/rules.md", "docs/profile.md", "rules/profile/profile.schema.json"])
def test_a_quick_command_prints_its_page(page: str) -> None:
    line = next(line for line in PAGE.splitlines() if line.startswith(f"| `{page}` |"))
    module = re.findall(r"python -m (\S+) >", line)[0]
    made = subprocess.run([sys.executable, "-m", module], capture_output=True, check=True, cwd=ROOT.parent)
    assert made.stdout == (ROOT / page).read_bytes()


def test_every_marker_is_registered() -> None:
    registered = {marker.split(":")[0] for marker in PYPROJECT["tool"]["pytest"]["ini_options"]["markers"]}
    for words in re.findall(r'-m "([^"]+)"', PAGE):
        assert set(words.split()) - {"not", "and"} <= registered


def test_folders_are_those_of_the_layers_in_their_order() -> None:
    (one_way,) = (c for c in PYPROJECT["tool"]["importlinter"]["contracts"] if "encoder" in str(c.get("layers")))
    rows = [layer.split(" | ") for layer in one_way["layers"]]
    layers = [layer.removeprefix("kerfwise.") for row in rows for layer in reversed(row)]
    layers = [f"{name}.py" if name == "pipeline" else name for name in layers]
    table = re.findall(r"^\| `([\w.]+)`(?:, `[\w.]+`)? \|", PAGE.split("## What a change needs")[0], re.MULTILINE)
    assert table == [layer for layer in reversed(layers) if layer in table]
    assert set(layers) - set(table) == {"app_modules", "arrays", "cli", "rule_kit"}


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", "CHANGELOG.md"])
def test_every_link_leads_somewhere(page: str) -> None:
    links = re.findall(r"\]\(([^)#]+)", (ROOT / page).read_text(encoding="utf-8"))
    assert links
    assert [link for link in links if "://" not in link and not (ROOT / link).is_file()] == []


def test_the_version_has_its_place_in_the_changelog() -> None:
    assert re.search(r"^## \[Unreleased\]$", CHANGES, re.MULTILINE)
    released = re.search(rf"^## \[{re.escape(kerfwise.__version__)}\] - \d{{4}}-\d\d-\d\d$", CHANGES, re.MULTILINE)
    assert released or f"This will be {kerfwise.__version__}," in CHANGES
    kinds = set(re.findall(r"^### (\w+)$", CHANGES, re.MULTILINE))
    assert kinds <= {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}
