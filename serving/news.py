"""News of the server's nests, and who waits for them."""

from __future__ import annotations

import asyncio
import secrets
from dataclasses import dataclass, field

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
