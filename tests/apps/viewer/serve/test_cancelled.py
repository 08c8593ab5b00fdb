"""What was wanted before somebody cancelled on the page does not begin another planning afterwards."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Request, Route

from kerfwise.tests.apps.viewer.serve.at_page import AtPage
from kerfwise.tests.apps.viewer.serve.conftest import Look
from kerfwise.tests.apps.viewer.serve.served import Served, Tab

pytestmark = [pytest.mark.slow, pytest.mark.browser]

WAITS = "#hands-reached:has-text('another nest is being planned')"
BOTH = """["start here", "no link"].forEach(title =>
  [...document.querySelectorAll("#hands-chosen button")].find(one => one.textContent === title).click())"""
"""Quicker than the server answers."""


def test_two_locks_at_a_time_are_planned_together(look: Look, planned: Tab, served: Served) -> None:
    at = look(planned)
    asked = requests_of(at, "solve")
    at.choose("C.outer")
    with served.planner_taken():
        at.ask(BOTH)
        at.page.wait_for_selector(WAITS)
        locked(at, "C first")
        locked(at, "no link C.outer")
        cancelled(at)
        unlocked(at, "C first")
        assert (planned.state()["solving"], len(asked)) == (None, 0)  # a lock is planned by the request that makes it


def test_a_lock_that_is_told_after_the_end_is_kept_and_not_planned(look: Look, planned: Tab, served: Served) -> None:
    at = look(planned)
    told: list[Callable[[], None]] = []

    def late(route: Route) -> None:
        if told:
            return route.continue_()
        answer = route.fetch()
        told.append(lambda: route.fulfill(response=answer))

    at.choose("C.outer")
    with served.planner_taken():
        at.press("start here")
        at.page.wait_for_selector(WAITS)
        at.page.route("**/edit", late)
        at.press("no link")
        locked(at, "no link C.outer")
        cancelled(at)
        for tell in told:
            tell()
        unlocked(at, "C first")
        assert (planned.state()["locked"], planned.state()["solving"]) == (["no link C.outer"], None)
        assert len(told) == 1


def requests_of(at: AtPage, what: str) -> list[Request]:
    """What the page asks from now on."""
    asked: list[Request] = []
    at.page.on("request", lambda request: asked.append(request) if request.url.endswith(f"/{what}") else None)
    return asked


def locked(at: AtPage, lock: str) -> None:
    at.page.wait_for_selector(f"#hands-locks li:has-text('{lock}')", state="attached")


def cancelled(at: AtPage) -> None:
    at.page.click("#hands-cancel")
    at.page.wait_for_selector("#hands-cancel", state="hidden")


def unlocked(at: AtPage, lock: str) -> None:
    """A change that waits for all that were asked for before."""
    at.panel("locks")
    at.page.click(f"[aria-label='unlock {lock}']")
    at.page.wait_for_selector(f"#hands-locks li:has-text('{lock}')", state="detached")
