"""One server for the tests of this folder; each test takes a folder of its own."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser

from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.tests.apps.viewer.serve.at_page import AtPage
from kerfwise.tests.apps.viewer.serve.served import SMALL, Open, Served, Tab, browser_of, serving
from kerfwise.tests.tools.amount import few

Look = Callable[..., AtPage]
WIDTHS = pytest.mark.parametrize("wide", [1400, 390])
"""By mouse and by touch."""
MOUSE_FIRST = pytest.mark.parametrize("wide", few([1400, 390]))
"""By mouse; by touch as well with `--all`, where both go the same way."""
TOUCH_FIRST = pytest.mark.parametrize("wide", few([390, 1400]))
"""By touch; by mouse as well with `--all`."""
FIRST = ["A.hole1", "A.outer", "B.outer", "C.outer"]


@pytest.fixture(scope="package")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with serving(tmp_path_factory.mktemp("nests"), also=[tmp_path_factory.mktemp("also")]) as made:
        yield made


@pytest.fixture(scope="package")
def client(served: Served) -> Iterator[httpx.Client]:
    """A browser that has the token, on the server's own pages."""
    with browser_of(served.address) as made:
        yield made


@pytest.fixture
def opened(served: Served, client: httpx.Client, tmp_path: Path) -> Open:
    """Puts a nest into a folder of the test's own, and opens it."""

    def opens(nest: str | Path = SMALL, name: str = "small.json", job: str | None = None) -> Tab:
        folder = served.server.folder.path / tmp_path.name
        folder.mkdir(exist_ok=True)
        if isinstance(nest, Path):
            name = nest.name
            shutil.copy(nest, folder / name)
        else:
            (folder / name).write_text(nest, encoding="utf-8")
        if job is not None:
            (folder / f"{Path(name).stem}.job.yaml").write_text(job, encoding="utf-8")
        answer = client.post("/api/open", json={"nest": f"{tmp_path.name}/{name}"})
        assert answer.status_code == 200, answer.text
        return Tab(client, answer.json()["id"], answer.json()["version"], folder / name)

    return opens


@pytest.fixture
def plate(opened: Open) -> Tab:
    """A plate that is planned for minutes with 200 of work: without zones nothing is proven of it."""
    return opened(json.dumps(make_sheet(1, 60)), "plate.json", "set:\n  rules.zone-order: off\n")


@pytest.fixture
def look(browser: Browser, served: Served) -> Iterator[Look]:
    """Opens a nest's page; at the end nothing may be wrong in it, and nothing asked of anybody else."""
    opened: list[AtPage] = []

    def looks(tab: Tab | None = None, wide: int = 1400) -> AtPage:
        at = AtPage(browser, served, wide)
        opened.append(at)
        if tab is not None:
            at.open(tab)
        return at

    yield looks
    for at in opened:
        at.close()
    assert [at.wrong for at in opened] == [[] for _ in opened]


@pytest.fixture
def planned(opened: Open) -> Tab:
    """The small nest with its first plan."""
    tab = opened()
    tab.solved()
    return tab
