"""What a check says of one rule."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from kerfwise.rules.rule import Strength, Violation

Verdict = Literal["holds", "broken", "excused", "not judged", "off"]


@dataclass(frozen=True, slots=True)
class Excused:
    """A violation that may stand, and why."""

    violation: Violation
    why: str


@dataclass(frozen=True, slots=True)
class Judgement:
    """One rule against one plan or program; one that is off is not judged at all.

    `unjudged` says why nothing can be said, where that is so. A rule that `must_be_judged` does not hold then.
    """

    id: str
    strength: Strength
    sentence: str
    violations: tuple[Violation, ...] = ()
    excused: tuple[Excused, ...] = ()
    unjudged: str | None = None
    must_be_judged: bool = False

    @property
    def holds(self) -> bool:
        """Whether nothing breaks the rule but what is excused, as far as it has to be known."""
        return not self.violations and not (self.must_be_judged and self.unjudged is not None)

    @property
    def verdict(self) -> Verdict:
        """The judgement in a word or two."""
        if self.strength == "off":
            return "off"
        if self.violations:
            return "broken"
        if self.unjudged is not None:
            return "not judged"
        return "excused" if self.excused else "holds"
