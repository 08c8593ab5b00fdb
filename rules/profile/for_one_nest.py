"""What a plan says that it was made with, beside its nest and its profile."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class ForOneNest:
    """What a plan was made with beside nest and profile: the job file by name and sha256, and what was said beside it.

    `settings` and `locks` are those of the command line (or of Python), in one line each, with the names of the nest.
    `numbered` says which contour each number stood for that the job file calls one by, such as `#7`.
    """

    file: str = ""
    sha256: str = ""
    settings: tuple[str, ...] = ()
    locks: tuple[str, ...] = ()
    numbered: Mapping[str, str] = field(default_factory=dict)

    def as_json(self) -> dict[str, Any]:
        """What a plan says of it."""
        told = {"file": self.file, "sha256": self.sha256} if self.file else {}
        asked = {"set": list(self.settings), "locks": list(self.locks), "numbered": dict(self.numbered)}
        return told | {key: value for key, value in asked.items() if value}

    @staticmethod
    def of_json(data: Mapping[str, Any]) -> ForOneNest:
        """The same, read back."""
        return ForOneNest(
            data.get("file", ""),
            data.get("sha256", ""),
            tuple(data.get("set", ())),
            tuple(data.get("locks", ())),
            dict(data.get("numbered", {})),
        )
