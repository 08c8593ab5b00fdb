"""The addresses that are asked with POST: what changes something, or has something planned."""

from __future__ import annotations

from functools import partial
from http import HTTPStatus
from typing import Any

from starlette.requests import Request
from starlette.responses import JSONResponse, Response

from kerfwise.encoder.errors import InputError

from .answers import Answer, changes_in, gone, said_in, session_of, whole
from .profiles import values_of, write_profile
from .saving import save
from .server import Server
from .session import Session, back_to


class Writing:
    """What changes a session carries the version that it has seen."""

    def __init__(self, server: Server) -> None:
        self._server = server

    def answers(self) -> dict[str, Answer]:
        """Each by its address."""
        return {
            "/api/open": self.open,
            "/api/drop": self.drop,
            "/api/{id}/edit": self.edit,
            "/api/{id}/cut": self.cut,
            "/api/{id}/back": self.back,
            "/api/{id}/solve": self.solve,
            "/api/{id}/cancel": self.cancel,
            "/api/{id}/try": self.tried,
            "/api/{id}/save": self.save,
            "/api/{id}/effect": self.effect,
            "/api/{id}/profile": self.write_profile,
        }

    async def open(self, request: Request) -> Response:
        """`{"nest": NAME, "repair": false}` gives the session's state."""
        said = await said_in(request, "nest", "repair")
        path = self._server.folder.nest(str(said.get("nest", "")))
        return JSONResponse((await self._server.open_nest(path, said.get("repair") is True)).as_json())

    async def drop(self, request: Request) -> Response:
        """A drawing as the body, `?name=plate.dxf&repair=0`: one that can be cut is written into the folder."""
        said = request.query_params
        session = await self._server.drop(said.get("name", ""), await request.body(), said.get("repair") == "1")
        return JSONResponse(session.as_json(), HTTPStatus.CREATED)

    async def edit(self, request: Request) -> Response:
        """`{"version": 3, "changes": [{"lock": "P2 first"}, …]}`; see `edits.py` for what can be changed."""
        session, said = await self._writing(request, "changes")
        undone = await self._server.edit(session, changes_in(said.get("changes")))
        return JSONResponse({**session.as_json(), "undone": undone})

    async def cut(self, request: Request) -> Response:
        """`{"version": 3, "upto": 7}`: the first cuts of the shown plan are made already; 0 takes that back."""
        session, said = await self._writing(request, "upto")
        await self._server.cut_up_to(session, whole(said.get("upto")))
        return JSONResponse(session.as_json())

    async def back(self, request: Request) -> Response:
        """`{"version": 3, "to": 1}`: an earlier plan is shown, and what it was made of is wanted again."""
        session, said = await self._writing(request, "to")
        number = whole(said.get("to"))
        await self._server.want(session, back_to(session, number), shown=number)
        return JSONResponse(session.as_json())

    async def solve(self, request: Request) -> Response:
        """`{"version": 3, "work": 30, "relax": false}`: the planning begins; events tell how it goes."""
        session, said = await self._writing(request, "work", "relax")
        work = said.get("work")
        if work is not None and not (isinstance(work, int | float) and 0 < work <= 10_000):
            raise InputError(f"work: expected a number over 0, got {work!r}")
        self._server.planning.solve(session, work, said.get("relax") is True)
        return JSONResponse(session.as_json(), HTTPStatus.ACCEPTED)

    async def cancel(self, request: Request) -> Response:
        """`{"at_once": false}`: the best plan so far is kept, unless it is to end at once."""
        session, said = self._session(request), await said_in(request, "version", "at_once")
        self._server.planning.cancel(session, said.get("at_once") is True)
        return JSONResponse(session.as_json(), HTTPStatus.ACCEPTED)

    async def tried(self, request: Request) -> Response:
        """`{"changes": […], "relax": false}`: what they would bring; nothing is changed. Who hangs up cancels it."""
        session, said = self._session(request), await said_in(request, "version", "changes", "relax")
        changes, relax = changes_in(said.get("changes") or []), said.get("relax") is True
        return await self._planned(request, session, "tried", changes=changes, relax=relax)

    async def effect(self, request: Request) -> Response:
        """`{"changes": [{"rule": "pierce", "key": "clearance", "to": "2 mm"}]}`: what they would bring on the nest.

        Nothing is changed. Who hangs up cancels it.
        """
        session, said = self._session(request), await said_in(request, "version", "changes")
        return await self._planned(request, session, "effect", values=values_of(said.get("changes")))

    async def save(self, request: Request) -> Response:
        """`{"version": 3}`: the files of the shown plan and its job file, and the command line that makes the same."""
        session, said = await self._writing(request)
        shown = session.current
        profile_sha256 = "" if shown is None else await self._server.asked("profile_sha256", wanted=shown.wanted)
        session.expect(said.get("version"))  # the desk took its time, and another tab did not wait
        told = save(session, self._server.folder, profile_sha256)
        return JSONResponse({**session.as_json(), "saved": told})

    async def write_profile(self, request: Request) -> Response:
        """`{"version": 3, "sha256": …, "changes": […], "as": "ours.yaml"}`: they are written into the profile."""
        session, said = await self._writing(request, "sha256", "changes", "as")
        told = await write_profile(self._server, session, said)
        return JSONResponse({**session.as_json(), "written": told})

    async def _planned(self, request: Request, session: Session, question: str, **given: Any) -> Response:
        hung_up = partial(gone, request)
        asked = self._server.planning.asked(session.name, question, hung_up, wanted=session.wanted, **given)
        return JSONResponse(await asked)

    def _session(self, request: Request) -> Session:
        return session_of(self._server, request)

    async def _writing(self, request: Request, *keys: str) -> tuple[Session, dict[str, Any]]:
        session, said = self._session(request), await said_in(request, "version", *keys)
        session.expect(said.get("version"))
        return session, said
