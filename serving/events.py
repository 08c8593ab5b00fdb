"""News of a session as server-sent events, for as long as a tab listens."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator

from starlette.responses import StreamingResponse

from .session import Session

SILENT_S = 15.0
"""After so long without news a comment is sent, so that a connection that has gone is seen."""


class Stream(StreamingResponse):
    """Tells the state at once, and then whatever changes."""

    def __init__(self, session: Session) -> None:
        super().__init__(_news(session), media_type="text/event-stream")


async def _news(session: Session) -> AsyncIterator[str]:
    queue = session.listen()
    try:
        yield _event("state", session)
        while True:
            try:
                what = await asyncio.wait_for(queue.get(), SILENT_S)
            except TimeoutError:
                yield ": nothing new\n\n"
                continue
            yield _event(what, session)
    finally:
        session.leave(queue)


def _event(what: str, session: Session) -> str:
    told = session.as_json() if what == "state" else {"version": session.version, "solving": session.solving}
    return f"event: {what}\ndata: {json.dumps(told, ensure_ascii=False)}\n\n"
