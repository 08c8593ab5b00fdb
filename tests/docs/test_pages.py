"""Every page can be found, and every link, anchor and path in the pages leads somewhere."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

import kerfwise
from kerfwise.tests.docs.pages import Page, reachable

ROOT = Path(kerfwise.__file__).resolve().parent
DOCS = ROOT / "docs"
PAGES = [*sorted(ROOT.glob("*.md")), *sorted(DOCS.glob("**/*.md")), ROOT / "examples" / "nests" / "README.md"]
SITE = yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
AT_ROOT = {"contributing.md", "changelog.md"}
"""Pages that the site takes from the root."""
MADE_ON_THE_WAY = ("/long_parts_last", "hull_before/model_data")
"""In the names of the files that the readers of docs/writing-a-rule.md and docs/first-changes.md make."""


def in_nav(entries: list[dict[str, Any]]) -> Iterator[str]:
    for entry in entries:
        for inside in entry.values():
            yield from in_nav(inside) if isinstance(inside, list) else [inside]


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_link_and_path_leads_somewhere(path: Path) -> None:
    page = Page(ROOT, path)
    assert page.broken_links() == []
    assert [name for name in page.missing_files() if not any(made in name for made in MADE_ON_THE_WAY)] == []


def test_every_page_is_in_the_nav_once() -> None:
    named = list(in_nav(SITE["nav"]))
    pages = {str(path.relative_to(DOCS)) for path in DOCS.glob("**/*.md")}
    missing = sorted(pages - set(named))
    assert not missing, f"mkdocs.yml, nav: give a place to {', '.join(missing)}"
    assert sorted(named) == sorted(pages | AT_ROOT)


def test_every_page_is_reached_from_the_index() -> None:
    reached = reachable(Page(ROOT, DOCS / "index.md"))
    missing = sorted(path.name for path in DOCS.glob("**/*.md") if path not in reached)
    assert not missing, f"docs/index.md: say for which job one reads {', '.join(missing)}"
    linked = {target for target, _ in Page(ROOT, DOCS / "index.md").links()}
    assert sorted(path.name for path in DOCS.glob("*.md") if path not in linked | {DOCS / "index.md"}) == []


def test_the_readme_leads_to_the_index() -> None:
    assert DOCS / "index.md" in {target for target, _ in Page(ROOT, ROOT / "README.md").links()}


def test_the_suite_builds_the_site_strictly() -> None:
    (line,) = (line for line in (ROOT / "tests" / "run.sh").read_text().splitlines() if "mkdocs build" in line)
    assert "--quiet" not in line.split("#")[0], "mkdocs build --quiet passes in spite of broken links"
    assert SITE["strict"] is True


def test_the_site_takes_nothing_from_elsewhere() -> None:
    assert SITE["theme"]["font"] is False
    assert not any(key in SITE for key in ("extra_javascript", "extra_css", "repo_url"))
    assert SITE["plugins"] == ["search"]
    pictures = [line for path in PAGES for line in path.read_text(encoding="utf-8").splitlines() if "](http" in line]
    assert not [line for line in pictures if "![" in line]


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("# A b\n[x](#a-b), [x](other.md#c-d), [x](https://example.org/y)", []),
        ("[x](none.md)", ["page.md: there is no none.md"]),
        ("[x](#nothing)", ["page.md: page.md has no heading #nothing"]),
        ("[x](other.md#nothing)", ["page.md: other.md has no heading #nothing"]),
        ("`[x](none.md)`\n```\n[x](none.md)\n# No heading\n```\n", []),
        ("```\n# No heading\n```\n[x](#no-heading)", ["page.md: page.md has no heading #no-heading"]),
        ("# Twice\n## Twice\n[x](#twice-1)", []),
    ],
)
def test_a_link_that_leads_nowhere_is_found(text: str, wrong: list[str], tmp_path: Path) -> None:
    (tmp_path / "other.md").write_text("## C, `d`?\n")
    (tmp_path / "page.md").write_text(text)
    found = Page(tmp_path, tmp_path / "page.md").broken_links()
    assert [line.replace(f"{tmp_path}/", "") for line in found] == wrong


@pytest.mark.parametrize(
    ("text", "missing"),
    [
        ("`rules/there.py`, python rules/there.py, rules/there.py.", []),
        ("`rules/gone.py` and `models/gone`", ["models/gone", "rules/gone.py"]),
        ("`rules/catalogue/<rule>.py`, `rules/*.mzn`, `plant/rules/x.mzn`, and/or", []),
    ],
)
def test_a_path_that_is_not_there_is_found(text: str, missing: list[str], tmp_path: Path) -> None:
    (tmp_path / "rules" / "catalogue").mkdir(parents=True)
    (tmp_path / "rules" / "there.py").touch()
    (tmp_path / "page.md").write_text(text)
    assert Page(tmp_path, tmp_path / "page.md").missing_files() == missing


def test_a_page_that_no_link_leads_to_is_found(tmp_path: Path) -> None:
    (tmp_path / "index.md").write_text("[a](a.md)")
    (tmp_path / "a.md").write_text("[b](b.md#c)")
    for name in ("b.md", "c.md"):
        (tmp_path / name).touch()
    reached = reachable(Page(tmp_path, tmp_path / "index.md"))
    assert {path.name for path in reached} == {"index.md", "a.md", "b.md"}
