"""The page: one file that holds all it needs, asks nobody, and lets no name out of its data."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from kerfwise.apps.viewer import page
from kerfwise.apps.viewer.page.page_html import as_script_data, bundled, page_and_policy, page_html
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.report import Spot, draw
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.postproc.report.plausible import plate, plausible_plan

FILES = Path(page.__file__).parent / "page_files"
MOST_LINES = 200
EVIL = "</script><b>@data<!-- \u2028 &amp;"


class Read(HTMLParser):
    """The elements of a page with their attributes, and the texts of its scripts and its style."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.seen: list[tuple[str, dict[str, str | None]]] = []
        self.texts: dict[str, str] = {}
        self._inside = ""
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append((tag, dict(attrs)))
        named = dict(attrs)
        self._inside = str(named.get("id", named.get("type", tag))) if tag in ("script", "style") else ""

    def handle_endtag(self, tag: str) -> None:
        self._inside = ""

    def handle_data(self, data: str) -> None:
        if self._inside:
            self.texts[self._inside] = self.texts.get(self._inside, "") + data

    @property
    def data(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(self.texts["data"])
        return found


@pytest.fixture(name="plate")
def a_plate() -> Nest:
    return plate()


def test_the_page_has_nest_and_plan(plate: Nest) -> None:
    plan = plausible_plan(plate)
    data = Read(draw(plate, plan, ".html").decode()).data
    names = [contour["id"] for contour in data["nest"]["contours"]]
    (side,) = data["sides"]
    assert [names[cut["contour"]] for cut in side["cuts"]] == [p.cut.contour for p in plan.cuts]
    assert [cut["because"] for cut in side["cuts"]] == [list(p.because) for p in plan.cuts]
    assert data["nest"]["contours"][names.index("A.hole1")]["rows"] == [60, 120, 1, 180, 120, 1]


@pytest.mark.parametrize(("excuses", "light"), [(1, 0.1), (0, None)])
def test_the_page_has_the_gap_without_the_weight_of_excuses(plate: Nest, excuses: int, light: float | None) -> None:
    plan = plausible_plan(plate)
    solve = replace(
        plan.solve, status="feasible", objective=1_010_000.0, bound=1_009_000.0, gap=1 / 1010, excuses=excuses
    )
    page = Read(draw(plate, replace(plan, solve=solve), ".html").decode())
    (side,) = page.data["sides"]
    assert (side["figures"]["gap"], side["figures"]["light_gap"]) == (1 / 1010, light)
    assert "places that are not kept aside" in page.texts["module"]


def test_the_page_of_a_spot_names_what_is_wrong(plate: Nest) -> None:
    data = Read(draw(plate, None, ".html", spot=Spot(frozenset({"A.hole1"}), "too near")).decode()).data
    assert (data["sides"], data["caption"]) == ([], "too near")
    assert [data["nest"]["contours"][k]["id"] for k in data["alert"]] == ["A.hole1"]


def test_a_name_cannot_break_out_of_the_page() -> None:
    def drawn(name: str) -> str:
        plate = nest(300, 300, part(name, rect(0, 0, 200, 200)))
        return draw(plate, plausible_plan(plate), ".html").decode()

    page = drawn(EVIL)
    read = Read(page)
    assert page.count("</script>") == 3
    assert [tag for tag, _ in read.seen] == [tag for tag, _ in Read(drawn("A")).seen]
    assert read.data["nest"]["parts"] == [EVIL]


def test_a_title_is_text() -> None:
    page = page_html({"title": '<i>&"@style'})
    assert "<title>&lt;i&gt;&amp;&quot;@style</title>" in page


def test_a_name_that_is_no_utf_8_is_written_all_the_same() -> None:
    name = b"a\xff".decode("utf-8", "surrogateescape")
    assert as_script_data({"file": name}).encode() == b'{"file":"a\\udcff"}'


def test_the_policy_lets_these_scripts_run_and_no_request_out() -> None:
    read = Read(page_html({"title": "x"}))
    (policy,) = (
        str(given["content"]) for tag, given in read.seen
        if tag == "meta" and given.get("http-equiv") == "Content-Security-Policy"
    )  # fmt: skip
    allowed = {words[0]: words[1:] for words in (unescape(part).split() for part in policy.split(";"))}
    assert allowed["default-src"] == ["'none'"]
    assert "connect-src" not in allowed
    for what, kind in (("script-src", "module"), ("style-src", "style")):
        digest = base64.b64encode(hashlib.sha256(read.texts[kind].encode()).digest()).decode()
        assert allowed[what] == [f"'sha256-{digest}'"]
    assert "connect-src 'self'" in page_and_policy({}, connect=True).policy


def test_the_page_names_no_other_place() -> None:
    read = Read(page_html({}))
    addresses = [value for _, given in read.seen for name, value in given.items() if name in ("src", "href")]
    assert addresses == ["data:,"]
    assert "http:" not in bundled("static.js")
    assert "https:" not in bundled("static.js")
    assert "url(" not in read.texts["style"]


def test_every_module_is_in_the_page_once_after_what_it_needs() -> None:
    script = bundled("static.js")
    names = re.findall(r"^// ([\w-]+\.js)$", script, re.MULTILINE)
    needed = {path.name for path in FILES.glob("*.js")} - {"types.js"}
    assert sorted(names) == sorted(needed)
    for name in names:
        for other in re.findall(r'^import .* from "\./(.*)";$', (FILES / name).read_text(), re.MULTILINE):
            if other != name and name not in (FILES / other).read_text():  # two modules may need each other
                assert names.index(other) < names.index(name), (name, other)
    assert not re.search(r"^(import|export)\b", script, re.MULTILINE)


def test_a_page_may_begin_with_a_module_from_elsewhere() -> None:
    more = {"served.js": 'import { start } from "./start.js";\n\nstart(null);\n', "hands.css": ".hand { color: red }"}
    read = Read(page_and_policy({}, "served.js", more=more).html)
    assert read.texts["module"].endswith("// served.js\n\nstart(null);\n")
    assert "function start(" in read.texts["module"]
    assert read.texts["style"].endswith(".hand { color: red }")


def test_no_two_modules_use_a_name_at_their_top_level() -> None:
    names = re.findall(r"^(?:async )?(?:function\*?|class|const|let) (\w+)", bundled("static.js"), re.MULTILINE)
    assert sorted(names) == sorted(set(names))


@pytest.mark.parametrize("path", sorted(FILES.iterdir()), ids=lambda path: path.name)
def test_a_module_is_one_idea(path: Path) -> None:
    assert len(path.read_text().splitlines()) <= MOST_LINES
