"""The addresses of the server: pages, what there is to know of a nest and its plans, and what changes something."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Mapping
from functools import partial
from http import HTTPStatus
from typing import Any

from anyio import to_thread
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response, StreamingResponse

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text

from .guard import Answer, changes_in, gone, said_in, session_of, whole
from .nest_folder import NestFile, is_readable
from .news import Item
from .package_pages import list_page, static_file, worked_page
from .profile_writing import profile_told, values_of, write_profile
from .server import Server, key_of, save
from .session import Session, request_after_cuts, restore_plan, with_job_text

LISTED_S, MOST_ROWS = 0.5, 500
"""A list of nests waits no longer for the last of them, and tells no more at a time."""
SORTED = ("name", "changed", "size", "state")
STATES = ("broken", "kept but for", "unchecked", "", "kept")
"""What a list may be sorted by; and states of plans, "" for none, in the order in which they want to be looked at."""

# The addresses that are asked with GET: pages, and what there is to know of a nest and its plans.


class Reading:
    """What changes nothing; `first` is the name of the nest that the server was started with."""

    def __init__(self, server: Server, first: str | None) -> None:
        self._server, self._first = server, first

    def answers(self) -> dict[str, Answer]:
        """Each by its address."""
        return {
            "/": self.home,
            "/files/{name:path}": self.file,
            "/nest/{id}": self.nest,
            "/api/nests": self.nests,
            "/api/thumbnail": self.thumbnail,
            "/api/events": self.all_events,
            "/api/{id}/page": self.page,
            "/api/{id}/heat": self.heat,
            "/api/{id}/bent": self.bent,
            "/api/{id}/state": self.state,
            "/api/{id}/why": self.why,
            "/api/{id}/move": self.move,
            "/api/{id}/profile": self.profile,
            "/api/{id}/room": self.room,
            "/api/{id}/rule": self.rule,
            "/api/{id}/program": self.program,
            "/api/{id}/events": self.events,
        }

    async def home(self, request: Request) -> Response:
        """The nest that the server was started with, or the list of those in its folder."""
        return HTMLResponse(list_page())

    async def file(self, request: Request) -> Response:
        """A script or style sheet of the list."""
        return static_file(request.path_params["name"])

    async def nest(self, request: Request) -> Response:
        """The page of a nest; one that an earlier server had open is opened again."""
        session = await self._server.reopen(request.path_params["id"])
        return worked_page(session_of(self._server, request).name if session is None else session.name)

    async def nests(self, request: Request) -> Response:
        """`?find=plate&sort=changed&from=500`: nests whose names have that text, some hundred from a place on.

        They are sorted by `name`, by what was `changed` last, by `size`, the largest first, or by `state`. `found` says
        how many there are so far, `complete` whether these are all, `left` how many come after these rows. `unreadable`
        are names, as they can be shown, under which no nest can be opened.
        """
        query = request.query_params
        found, complete = await to_thread.run_sync(self._server.nests.known, LISTED_S)
        said, first, by = (
            query.get("find", "").casefold(),
            max(0, whole(query.get("from", 0))),
            query.get("sort", "name"),
        )
        wanted = [one for one in found if is_readable(one.name) and said in one.name.casefold()]
        if by not in SORTED:
            raise InputError(f"sort: expected one of {', '.join(SORTED)}, got {escape_text(by)!r}")
        if by != "name":
            wanted = await to_thread.run_sync(self._sorted, wanted, by)
        rows = [self._row(one) for one in wanted[first : first + MOST_ROWS]]
        answer = {
            "nests": [row["name"] for row in rows],
            "rows": rows,
            "found": len(wanted),
            "complete": complete,
            "left": max(0, len(wanted) - first - len(rows)),
            "unreadable": [escape_text(one.name) for one in found if not is_readable(one.name)][:MOST_ROWS],
            "first": self._first,
        }
        return JSONResponse(answer)

    def _sorted(self, nests: list[NestFile], by: str) -> list[NestFile]:
        """By something else than their names, by which they come; of equals the first name comes first."""
        if by == "state":
            return sorted(nests, key=lambda one: STATES.index(self._state(key_of(one.name))))
        return sorted(nests, key=lambda one: -(one.changed if by == "changed" else one.size))

    def _state(self, key: str) -> str:
        """The state of the plan that is shown of a nest; "" where there is none."""
        session = self._server.sessions.get(key)
        current = None if session is None else session.current
        state = self._server.kept.state_of(key) if session is None else "" if current is None else current.state
        return state if state in STATES else ""

    def _row(self, nest: NestFile) -> dict[str, Any]:
        """A nest of the list, with its plans: how many there are, and the state of the one that is shown."""
        key = key_of(nest.name)
        session = self._server.sessions.get(key)
        plans = self._server.kept.plans_kept(key) if session is None else len(session.alternatives)
        return {
            "name": nest.name,
            "size": nest.size,
            "changed": nest.changed,
            "plans": plans,
            "state": self._state(key),
        }

    async def thumbnail(self, request: Request) -> Response:
        """`?nest=plate.dxf`: a small picture of it, as a data URL; "" for one that cannot be read as it is."""
        path = self._server.folder.nest(request.query_params.get("nest", ""))
        return JSONResponse({"picture": await self._server.thumbnail(path)})

    async def room(self, request: Request) -> Response:
        """How far parts keep from each other and from the edge, and which are cut already."""
        return JSONResponse(await self._server.asked("room", wanted=self._session(request).wanted))

    async def page(self, request: Request) -> Response:
        """What the page shows (`kerfwise-page/1`), of `?plan=2` or the shown plan; of two with `?plan=1&with=2`."""
        number, other, session = _plan(request), request.query_params.get("with"), self._session(request)
        if other is None:
            data = await self._server.page(session, number)
        elif number is None:
            raise InputError("with: expected plan too, the number of the other plan")
        else:
            data = await self._server.compared(session, number, whole(other))
        return Response(data, media_type="application/json")

    async def heat(self, request: Request) -> Response:
        """How hot the shown plan makes the sheet, or null."""
        return JSONResponse(await self._about(request, "heat"))

    async def bent(self, request: Request) -> Response:
        """How the sheet moves while a plan is cut, and how far each part is off: a simulation of seconds to minutes."""
        return JSONResponse(await self._about(request, "bent"))

    async def state(self, request: Request) -> Response:
        """The session, and the name of the nest that the planner works for."""
        told = self._server.as_json(self._session(request))
        return JSONResponse({**told, "planner": self._server.planning.turns.of})

    async def why(self, request: Request) -> Response:
        """`?contour=P1.outer&plan=2`: as `kerfwise explain --json`, with `text`."""
        contour = request.query_params.get("contour", "")
        return JSONResponse(await self._about(request, "why", contour=contour))

    async def move(self, request: Request) -> Response:
        """`?contours=P1.outer&place=3&look=0`: whether they may be cut from that place on, and what it costs."""
        query = request.query_params
        contours = query.getlist("contours")
        if not contours:
            raise InputError("contours: expected the id of a contour or the name of a part")
        arguments = {
            "contours": contours,
            "place": whole(query.get("place")),
            "look": query.get("look") == "1",
        }
        return JSONResponse(await self._about(request, "move", **arguments))

    async def program(self, request: Request) -> Response:
        """The NC text of a plan."""
        plan = self._session(request).looked_at(_plan(request))
        if plan is None:
            raise InputError("there is no plan yet")
        return Response(plan.program, media_type="text/plain; charset=utf-8")

    async def all_events(self, request: Request) -> Response:
        """Server-sent events of all nests that are open, one stream for all tabs of a browser."""
        return Stream(self._server)

    async def events(self, request: Request) -> Response:
        """Server-sent events: `state` when anything has changed, `progress` while the engines run, `planner`."""
        return Stream(self._server, self._session(request).id)

    async def profile(self, request: Request) -> Response:
        """The rules of the nest's profile with strengths and options, and whether its file may be written."""
        return JSONResponse(await profile_told(self._server, self._session(request)))

    async def rule(self, request: Request) -> Response:
        """`?rule=pierce`: its page, and pictures of what is wrong and what is right."""
        wanted = self._session(request).wanted
        return JSONResponse(await self._server.asked("rule", wanted=wanted, rule=request.query_params.get("rule", "")))

    async def _about(self, request: Request, question: str, **given: Any) -> Any:
        return await self._server.about(self._session(request), question, _plan(request), **given)

    def _session(self, request: Request) -> Session:
        return session_of(self._server, request)


def _plan(request: Request) -> int | None:
    """`?plan=2`; None for the shown one."""
    number = request.query_params.get("plan")
    return whole(number) if number else None


# The addresses that are asked with POST: what changes something, or has something planned.


class Writing:
    """What changes a session carries the version that it has seen."""

    def __init__(self, server: Server) -> None:
        self._server = server

    def answers(self) -> dict[str, Answer]:
        """Each by its address."""
        return {
            "/api/open": self.open,
            "/api/drop": self.drop,
            "/api/preview": self.preview,
            "/api/{id}/edit": self.edit,
            "/api/{id}/nest": self.change_nest,
            "/api/{id}/cut": self.cut,
            "/api/{id}/back": self.back,
            "/api/{id}/solve": self.solve,
            "/api/{id}/cancel": self.cancel,
            "/api/{id}/keep": self.keep,
            "/api/{id}/differences": self.differences,
            "/api/{id}/try": self.tried,
            "/api/{id}/save": self.save,
            "/api/{id}/effect": self.effect,
            "/api/{id}/profile": self.write_profile,
        }

    async def open(self, request: Request) -> Response:
        """`{"nest": NAME, "repair": false, "answers": {"frame": "sheet"}}` gives the session's state.

        A drawing that raises questions is refused with them; answers are kept in its job file once all are given.
        """
        body = await said_in(request, "nest", "repair", "answers")
        path = self._server.folder.nest(str(body.get("nest", "")))
        session = await self._server.open_nest(path, body.get("repair") is True, _answers_in(body.get("answers")))
        return JSONResponse(self._server.as_json(session))

    async def preview(self, request: Request) -> Response:
        """`{"nest": NAME, "repair": false, "answers": {…}}`: a picture of how it is understood so; nothing is kept."""
        body = await said_in(request, "nest", "repair", "answers")
        path = self._server.folder.nest(str(body.get("nest", "")))
        answers = _answers_in(body.get("answers"))
        return JSONResponse({"picture": await self._server.preview(path, body.get("repair") is True, answers)})

    async def drop(self, request: Request) -> Response:
        """A drawing as the body, `?name=plate.dxf&repair=0`: one that can be cut is written into the folder.

        `&answers={"frame": "sheet"}` answers its questions; with `&preview=1` a picture is all that is made.
        """
        query = request.query_params
        name, repair, body = query.get("name", ""), query.get("repair") == "1", await request.body()
        try:
            answers = _answers_in(json.loads(query.get("answers") or "{}"))
        except json.JSONDecodeError:
            answers = _answers_in("no JSON")
        if query.get("preview") == "1":
            return JSONResponse({"picture": await self._server.preview_of_drop(name, body, repair, answers)})
        session = await self._server.drop(name, body, repair, answers)
        return JSONResponse(self._server.as_json(session), HTTPStatus.CREATED)

    async def edit(self, request: Request) -> Response:
        """`{"version": 3, "changes": [{"lock": "P2 first"}, …]}`; see `job_edits.py` for what can be changed.

        With `"plan": true`, here and where a plan is gone back to or cut in part, what is wanted then is planned at
        once: a planning that runs gives way.
        """
        session, body = await self._writing(request, "changes", "plan")
        undone = await self._server.edit(session, changes_in(body.get("changes")))
        self._plan(session, body)
        return JSONResponse({**self._server.as_json(session), "undone": undone})

    async def change_nest(self, request: Request) -> Response:
        """`{"version": 3, "changes": ["drop P1", "move P2 10 0"], "as": "plate2.json"}`: the new nest is opened.

        Without a name nothing is written: its parts are told, or what would collide.
        """
        session, body = await self._writing(request, "changes", "as")
        changes, name = body.get("changes"), body.get("as")
        if not isinstance(changes, list) or not changes or not all(isinstance(one, str) for one in changes):
            raise InputError(f"changes: expected lines such as 'drop P1', got {changes!r}")
        if name is not None and not isinstance(name, str):
            raise InputError(f"as: expected the name of a nest, got {name!r}")
        result = await self._server.change_nest(session, changes, name)
        return JSONResponse(result, HTTPStatus.OK if name is None else HTTPStatus.CREATED)

    async def cut(self, request: Request) -> Response:
        """`{"version": 3, "upto": 7}`: the first cuts of the shown plan are made already; 0 takes that back."""
        session, body = await self._writing(request, "upto", "plan", shown=True)
        wanted = request_after_cuts(session, session.wanted, session.shown, whole(body.get("upto")))
        await self._server.want(session, wanted)
        self._plan(session, body)
        return JSONResponse(self._server.as_json(session))

    async def back(self, request: Request) -> Response:
        """`{"version": 3, "to": 1}`: an earlier plan is shown, and what it was made of is wanted again.

        With `"job_text"` and `"upto"`, which an undo sends, that is wanted in place of what the plan was made of; to 0
        is back to no plan.
        """
        session, body = await self._writing(request, "to", "job_text", "upto", "plan")
        number = whole(body.get("to"))
        wanted = restore_plan(session, number)
        if "upto" in body and (upto := whole(body["upto"])) != wanted.upto:
            wanted = request_after_cuts(session, wanted, number, upto)
        if "job_text" in body:
            wanted = with_job_text(session, wanted, body["job_text"])
        await self._server.want(session, wanted, shown=number, following=0)
        self._plan(session, body)
        return JSONResponse(self._server.as_json(session))

    async def solve(self, request: Request) -> Response:
        """`{"version": 3, "work": 30, "relax": false}`: the planning begins; events tell how it goes."""
        session, body = await self._writing(request, "work", "relax")
        work = body.get("work")
        if work is not None and not (isinstance(work, int | float) and 0 < work <= 10_000):
            raise InputError(f"work: expected a number over 0, got {work!r}")
        self._server.planning.solve(session, work, body.get("relax") is True)
        return JSONResponse(self._server.as_json(session), HTTPStatus.ACCEPTED)

    async def cancel(self, request: Request) -> Response:
        """`{"at_once": false}`: the best plan so far is kept, unless it is to end at once."""
        session, body = self._session(request), await said_in(request, "version", "at_once")
        self._server.planning.cancel(session, body.get("at_once") is True)
        return JSONResponse(self._server.as_json(session), HTTPStatus.ACCEPTED)

    async def keep(self, request: Request) -> Response:
        """`{"number": 3, "kept": true}`: that plan is never thrown away, however many come."""
        session, body = self._session(request), await said_in(request, "version", "number", "kept")
        session.keep(whole(body.get("number")), body.get("kept") is not False)
        return JSONResponse(self._server.as_json(session))

    async def differences(self, request: Request) -> Response:
        """`{"version": 3, "job": "disk"}` or `"kept"`: that job file counts; with `{"nest": "seen"}` the drawing is."""
        session, body = await self._writing(request, "job", "nest")
        job = body.get("job")
        if job not in (None, "disk", "kept") or (job is None) == (body.get("nest") != "seen"):
            raise InputError('expected {"job": "disk"}, {"job": "kept"} or {"nest": "seen"}')
        await self._server.settle(session, job)
        return JSONResponse(self._server.as_json(session))

    async def tried(self, request: Request) -> Response:
        """`{"changes": […], "relax": false}`: what they would bring; nothing is changed. Who hangs up cancels it."""
        session, body = self._session(request), await said_in(request, "version", "changes", "relax")
        changes, relax = changes_in(body.get("changes") or []), body.get("relax") is True
        return await self._planned(request, session, "tried", changes=changes, relax=relax)

    async def effect(self, request: Request) -> Response:
        """`{"changes": [{"rule": "pierce", "key": "clearance", "to": "2 mm"}]}`: what they would bring on the nest.

        Nothing is changed. Who hangs up cancels it.
        """
        session, body = self._session(request), await said_in(request, "version", "changes")
        return await self._planned(request, session, "effect", values=values_of(body.get("changes")))

    async def save(self, request: Request) -> Response:
        """`{"version": 3}`: the files of the shown plan and its job file, and the command line that makes the same."""
        session, body = await self._writing(request, shown=True)
        plan = session.current
        profile_sha256 = picture = ""
        if plan is not None and plan.sha256 == session.opened["sha256"]:  # another one is refused anyway
            profile_sha256 = await self._server.asked("profile_sha256", wanted=plan.wanted)
            picture = await self._server.about(session, "picture")
        session.expect(body.get("version"), shown=True)  # the desk took its time, and another tab did not wait
        saved = save(session, self._server.folder, profile_sha256, picture)
        return JSONResponse({**self._server.as_json(session), "saved": saved})

    async def write_profile(self, request: Request) -> Response:
        """`{"version": 3, "sha256": …, "changes": […], "as": "ours.yaml"}`: they are written into the profile."""
        session, body = await self._writing(request, "sha256", "changes", "as")
        result = await write_profile(self._server, session, body)
        return JSONResponse({**self._server.as_json(session), "written": result})

    async def _planned(self, request: Request, session: Session, question: str, **given: Any) -> Response:
        hung_up = partial(gone, request)
        answer = self._server.planning.asked(session.name, question, hung_up, wanted=session.wanted, **given)
        return JSONResponse(await answer)

    def _session(self, request: Request) -> Session:
        return session_of(self._server, request)

    async def _writing(self, request: Request, *keys: str, shown: bool = False) -> tuple[Session, dict[str, Any]]:
        session, body = self._session(request), await said_in(request, "version", *keys)
        session.expect(body.get("version"), shown)
        return session, body

    def _plan(self, session: Session, body: Mapping[str, Any]) -> None:
        if body.get("plan") is True:
            self._server.planning.solve(session)


def _answers_in(value: Any) -> dict[str, str]:
    """`{"frame": "sheet"}` as answers to questions of a drawing."""
    answers = {} if value is None else value
    if not isinstance(answers, dict) or not all(isinstance(one, str) and one for row in answers.items() for one in row):
        raise InputError(f'answers: expected {{"QUESTION": "CHOICE"}}, got {value!r}')
    return answers


# News of nests as server-sent events, for as long as a browser listens.

SILENT_S = 15.0
"""After so long without news a comment is sent, so that a connection that has gone is seen."""


class Stream(StreamingResponse):
    """Tells the state of a nest at once, or of all that are open, and then whatever changes.

    Parameters
    ----------
    server
        Whose news they are; nests that are opened later are told too.
    of
        The id of one nest, or "" for all.
    """

    def __init__(self, server: Server, of: str = "") -> None:
        self._server, self._of = server, of
        super().__init__(self._news(), media_type="text/event-stream")

    async def _news(self) -> AsyncIterator[str]:
        ear = self._server.news.listen(self._of)
        try:
            yield self._event(("planner", ""))
            for key in [self._of] if self._of else [*self._server.sessions]:
                yield self._event(("state", key))
            while True:
                try:
                    heard = await asyncio.wait_for(ear.next(), SILENT_S)
                except TimeoutError:
                    yield ": nothing new\n\n"
                    continue
                for item in heard:
                    yield self._event(item)
        finally:
            self._server.news.leave(ear)

    def _event(self, item: Item) -> str:
        what, key = item
        data: dict[str, Any]
        if what == "planner":
            data = {"nest": self._server.planning.turns.of}
        elif what == "state":
            data = self._server.as_json(self._server.sessions[key])
        else:
            session = self._server.sessions[key]
            data = {"id": key, "version": session.version, "solving": session.solving}
        return f"event: {what}\ndata: {json.dumps(data, ensure_ascii=False)}\n\n"
