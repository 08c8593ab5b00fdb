"""What somebody changes while the server waits for an answer stays: nothing is written over it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from kerfwise.apps.viewer.serve import profile_writing
from kerfwise.apps.viewer.serve.nest_folder import Folder
from kerfwise.apps.viewer.serve.server import Server
from kerfwise.apps.viewer.serve.session import Session
from kerfwise.tests.apps.viewer.serve.served import SMALL, in_a_loop

LOCK = "locks: [A first]\n"
Answer = Callable[[str, dict[str, Any]], Any]


class Answered(Server):
    """A server whose desk answers at once, after what a test has somebody do meanwhile."""

    answer: Answer

    async def asked(self, question: str, **given: Any) -> Any:
        return self.answer(question, given)


def opened_as(given: dict[str, Any]) -> dict[str, Any]:
    sha256 = str(Path(given["wanted"].nest).stat().st_size)
    return {"sha256": sha256, "shapes": {}, "answers": {}, "job": given["wanted"].job_text}


@pytest.fixture
def nest(tmp_path: Path) -> Path:
    (path := tmp_path.resolve() / "small.json").write_text(SMALL, encoding="utf-8")
    return path


@pytest.fixture
def server(nest: Path) -> Answered:
    made = Answered(Folder(nest.parent))
    made.answer = lambda question, given: opened_as(given)
    return made


def lock(session: Session) -> None:
    """Somebody locks something in another tab."""
    session.changed(wanted=replace(session.wanted, job_text=(session.wanted.job_text or "") + LOCK))


def test_an_edit_that_is_made_while_a_changed_nest_is_read(server: Answered, nest: Path) -> None:
    async def run() -> Session:
        session = await server.open_nest(nest)
        nest.write_text(f"{SMALL}\n", encoding="utf-8")
        edits = iter([lock])

        def answer(question: str, given: dict[str, Any]) -> Any:
            for edit in edits:
                edit(session)
                break
            return opened_as(given)

        server.answer = answer
        return await server.open_nest(nest)

    session = in_a_loop(run())
    assert session.wanted.job_text == LOCK
    assert session.opened["job"] == LOCK


def test_a_lock_that_is_made_while_a_new_profile_is_written(server: Answered, nest: Path) -> None:
    async def run() -> Session:
        session = await server.open_nest(nest)
        edits = iter([lock])

        def answer(question: str, given: dict[str, Any]) -> Any:
            text = given["wanted"].job_text or ""
            for edit in edits:
                edit(session)
                break
            return {"job_text": f"profile: ours.yaml\n{text}"} if question == "edited" else opened_as(given)

        server.answer = answer
        await profile_writing._want_anew(server, session, nest.with_name("ours.yaml"))
        return session

    assert in_a_loop(run()).wanted.job_text == f"profile: ours.yaml\n{LOCK}"


def test_a_lock_that_is_made_while_a_written_profile_is_read_again(server: Answered, nest: Path) -> None:
    (profile := nest.with_name("ours.yaml")).write_text("based_on: plasma-carbon-steel\n", encoding="utf-8")

    async def run() -> Session:
        session = await server.open_nest(nest)
        edits = iter([lock])

        def answer(question: str, given: dict[str, Any]) -> Any:
            if question == "profile_files":
                return [str(profile)]
            for edit in edits:
                edit(session)
                break
            return opened_as(given)

        server.answer = answer
        await profile_writing._read_again(server, profile, "written")
        return session

    session = in_a_loop(run())
    assert session.wanted.job_text == LOCK
    assert session.wanted.profile_now == "written"
