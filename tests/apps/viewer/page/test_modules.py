"""The page's modules: their types hold, and those that know no screen are tested by themselves in Node.js."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from kerfwise.apps.viewer import page, serve
from kerfwise.apps.viewer.page.page_html import bundled
from kerfwise.apps.viewer.serve.package_pages import ENTRY
from kerfwise.tests.tools.typescript import compiler

HERE = Path(__file__).parent
FILES = Path(page.__file__).parent / "page_files"
HANDS = Path(serve.__file__).parent / "hands"


@pytest.fixture
def modules(tmp_path: Path) -> Path:
    """A folder in which Node.js takes .js files for modules, with those of the page and their tests."""
    shutil.copytree(FILES, tmp_path / "page_files")
    for hand in HANDS.glob("*.js"):  # the server's, which are set into one script with the page's
        shutil.copy(hand, tmp_path / "page_files")
    shutil.copytree(HERE / "units", tmp_path / "units")
    (tmp_path / "package.json").write_text(json.dumps({"type": "module"}))
    return tmp_path


def run(*words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=120, check=False)


def types(folder: Path) -> subprocess.CompletedProcess[str]:
    options = json.loads((HERE / "tsconfig.json").read_text())
    (folder / "tsconfig.json").write_text(json.dumps(options | {"include": ["page_files/*.js"]}))
    return run(*compiler(), "-p", ".", folder=folder)


@pytest.mark.slow
@pytest.mark.typescript
def test_every_type_holds(modules: Path) -> None:
    done = types(modules)
    assert done.returncode == 0, done.stdout


@pytest.mark.slow
@pytest.mark.typescript
def test_a_wrong_type_is_found(modules: Path) -> None:
    for path in modules.glob("page_files/*.js"):
        if path.name != "words.js":
            path.unlink()
    with (modules / "page_files" / "words.js").open("a") as words:
        words.write('clock("one");\n')
    assert "is not assignable to parameter of type 'number'" in types(modules).stdout


@pytest.mark.typescript
def test_modules_that_know_no_screen(modules: Path) -> None:
    node = compiler()[0]
    done = run(node, "units/all.test.js", folder=modules)
    assert done.returncode == 0, done.stdout
    assert "# fail 0" in done.stdout or "fail 0" in done.stdout


@pytest.mark.typescript
@pytest.mark.parametrize("entry", ["static.js", ENTRY])
def test_the_script_of_the_page_is_one_module_without_a_name_twice(tmp_path: Path, entry: str) -> None:
    """Alone, and with the server's hands."""
    hands = [(path.name, path.read_text()) for path in HANDS.glob("*.js")] if entry == ENTRY else []
    (tmp_path / "page.mjs").write_text(bundled(entry, tuple(hands)))
    done = run(compiler()[0], "--check", "page.mjs", folder=tmp_path)
    assert done.returncode == 0, done.stderr
