"""The page of the Python interface is made from the docstrings; the README's Python example and the notebooks run."""

from __future__ import annotations

import json
import re
from pathlib import Path

import nbclient
import nbformat
import pytest

import kerfwise
from kerfwise.tests.docs.api_page import page
from kerfwise.tests.tools.amount import few

ROOT = Path(kerfwise.__file__).parent
NOTEBOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.ipynb"))


def test_the_page_is_current() -> None:
    again = "python -m kerfwise.tests.docs.api_page > api.md && mv api.md docs/api.md makes it again"
    assert (ROOT / "docs" / "api.md").read_text(encoding="utf-8") == page(), again


def test_the_example_of_the_readme(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (example,) = (code for code in re.findall(r"```python\n(.*?)```", text, re.DOTALL) if "import kerfwise" in code)
    (tmp_path / "examples").symlink_to(ROOT / "examples", target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    exec(compile(example, "README.md", "exec"), {})
    said = capsys.readouterr().out
    assert said.startswith("optimal ")
    assert "\nP5.outer is cut " in said
    named = re.findall(r"# out/(\S+), (\S+), (\S+):", example)[0]
    stem = named[0].removesuffix(".nc")
    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == sorted(
        [named[0], *(f"{stem}{suffix}" for suffix in named[1:])]
    )


def test_notebooks_are_kept_without_output() -> None:
    assert len(NOTEBOOKS) == 3
    for notebook in NOTEBOOKS:
        for cell in json.loads(notebook.read_text(encoding="utf-8"))["cells"]:
            assert cell.get("outputs", []) == []
            assert cell.get("execution_count") is None


@pytest.mark.slow
@pytest.mark.parametrize("notebook", few(NOTEBOOKS), ids=lambda path: path.stem)
def test_every_notebook_runs(notebook: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(ROOT.parent) if ROOT.name == "kerfwise" else "")
    made = nbformat.read(notebook, as_version=4)
    nbclient.NotebookClient(made, timeout=600, resources={"metadata": {"path": str(notebook.parent)}}).execute()
    shown = [output for cell in made.cells if cell.cell_type == "code" for output in cell.outputs]
    assert any("text/html" in output.get("data", {}) for output in shown)
