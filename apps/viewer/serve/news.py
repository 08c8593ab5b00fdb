"""News of the server's nests and who waits for them, whose turn the planner is, and work that nobody waits for."""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import AsyncIterator, Coroutine
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any

Item = tuple[str, str]
"""What has news (`state`, `progress` or `planner`), and the id of the nest; "" for what is of no nest."""


@dataclass(eq=False)
class Ear:
    """Somebody who waits for news of one nest, or of all with "". What is told twice is heard once, as it is then."""

    of: str = ""
    _heard: dict[Item, None] = field(default_factory=dict)
    _woken: asyncio.Event = field(default_factory=asyncio.Event)

    def tell(self, what: str, of: str) -> None:
        """There is news."""
        if self.of in ("", of) or not of:
            self._heard[what, of] = None
            self._woken.set()

    async def next(self) -> list[Item]:
        """What has news since the last call, in the order in which it came; waits for some."""
        await self._woken.wait()
        self._woken.clear()
        heard = [*self._heard]
        self._heard.clear()
        return heard


class News:
    """Tells all who listen; `server` is another text for every server that is started."""

    def __init__(self) -> None:
        self.server = secrets.token_hex(8)
        self._ears: set[Ear] = set()

    def listen(self, of: str = "") -> Ear:
        """News of a nest from now on, or of all, until `leave`."""
        ear = Ear(of)
        self._ears.add(ear)
        return ear

    def leave(self, ear: Ear) -> None:
        """No more news."""
        self._ears.discard(ear)

    def tell(self, what: str, of: str = "") -> None:
        """Tell who listens to the nest, or all where it is of none."""
        for ear in self._ears:
            ear.tell(what, of)

    @property
    def listeners(self) -> int:
        """How many listen."""
        return len(self._ears)


# Whose turn it is: the planner works for one nest at a time, and the others wait in the order in which they came.


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


# Work that nobody waits for, ended with the server.


class Background:
    """Coroutines that run beside the answers."""

    def __init__(self) -> None:
        self._jobs: set[asyncio.Task[None]] = set()

    def begin(self, work: Coroutine[Any, Any, None]) -> None:
        """Let it run."""
        job = asyncio.get_running_loop().create_task(work)
        self._jobs.add(job)
        job.add_done_callback(self._jobs.discard)

    async def end(self) -> None:
        """Cancel what runs still, and wait for its end."""
        jobs = [*self._jobs]
        for job in jobs:
            job.cancel()
        await asyncio.gather(*jobs, return_exceptions=True)
