"""Whose turn it is: the planner works for one nest at a time, and the others wait in the order in which they came."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from .news import News


class Turns:
    """Gives the planner to one nest at a time, and tells all which one has it."""

    def __init__(self, news: News) -> None:
        self.news = news
        self.of = ""
        """The name of the nest that the planner works for; "" while it has nothing to do."""
        self.waiting = 0
        """How many wait for their turn."""
        self._lock = asyncio.Lock()

    @asynccontextmanager
    async def turn(self, nest: str) -> AsyncIterator[None]:
        """Wait for the turn of a nest, and have it for the time of the context."""
        self.waiting += 1
        try:
            await self._lock.acquire()
        finally:
            self.waiting -= 1
        try:
            self._give(nest)
            yield
        finally:
            self._give("")
            self._lock.release()

    def _give(self, nest: str) -> None:
        self.of = nest
        self.news.tell("planner")
