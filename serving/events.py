"""News of nests as server-sent events, for as long as a browser listens."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Mapping
from typing import Any

from starlette.responses import StreamingResponse

from .news import Item
from .session import Session
from .turns import Turns

SILENT_S = 15.0
"""After so long without news a comment is sent, so that a connection that has gone is seen."""


class Stream(StreamingResponse):
    """Tells the state of a nest at once, or of all that are open, and then whatever changes.

    Parameters
    ----------
    sessions
        All that are open, by id; those that are opened later are told too.
    turns
        Whose turn it is to be planned.
    of
        The id of one nest, or "" for all.
    """

    def __init__(self, sessions: Mapping[str, Session], turns: Turns, of: str = "") -> None:
        self._sessions, self._turns, self._of = sessions, turns, of
        super().__init__(self._news(), media_type="text/event-stream")

    async def _news(self) -> AsyncIterator[str]:
        ear = self._turns.news.listen(self._of)
        try:
            yield self._event(("planner", ""))
            for key in [self._of] if self._of else [*self._sessions]:
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
            self._turns.news.leave(ear)

    def _event(self, item: Item) -> str:
        what, key = item
        told: dict[str, Any]
        if what == "planner":
            told = {"nest": self._turns.of}
        elif what == "state":
            told = self._sessions[key].as_json()
        else:
            session = self._sessions[key]
            told = {"id": key, "version": session.version, "solving": session.solving}
        return f"event: {what}\ndata: {json.dumps(told, ensure_ascii=False)}\n\n"
