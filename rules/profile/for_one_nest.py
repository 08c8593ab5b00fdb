"""What a plan says that it was made with, beside its nest and its profile."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
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


def changed_since(then: ForOneNest | None, now: ForOneNest | None) -> Iterator[str]:
    """A sentence for each thing that a plan was made with, and is not given now, or the other way round.

    Examples
    --------
    >>> list(changed_since(ForOneNest("plate.job.yaml", "1a2b"), None))
    ['the plan was made with the job file plate.job.yaml, which is not given here']
    >>> list(changed_since(None, ForOneNest(settings=("leads.lead_in=4 mm",))))
    ['the plan was made without --set leads.lead_in=4 mm, which is given here']
    """
    then, now = then or ForOneNest(), now or ForOneNest()
    if then.sha256 and now.sha256 and then.sha256 != now.sha256:
        yield "the job file is not the one the plan was made with (its sha256 differs)"
    elif then.sha256 and not now.sha256:
        yield f"the plan was made with the job file {then.file}, which is not given here"
    elif now.sha256 and not then.sha256:
        yield f"the plan was made without the job file {now.file}, which is given here"
    for option, before, given in (("--set", then.settings, now.settings), ("--lock", then.locks, now.locks)):
        yield from (f"the plan was made with {option} {said}, which is not given here" for said in _only(before, given))
        yield from (f"the plan was made without {option} {said}, which is given here" for said in _only(given, before))


def _only(these: tuple[str, ...], those: tuple[str, ...]) -> Iterator[str]:
    return (one for one in these if one not in those)
