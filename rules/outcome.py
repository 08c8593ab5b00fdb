"""How one thing that was tried of a rule went."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class CaseOutcome:
    """What was tried of a rule: a case, by its name, or something else; `wrong` is empty where it went as it should.

    `note` says what could not be tried, where that is no fault of the rule's.
    """

    rule: str
    case: str
    wrong: tuple[str, ...] = ()
    is_case: bool = True
    note: str = ""
