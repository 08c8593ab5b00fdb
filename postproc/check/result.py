"""What a check finds: a judgement on every rule, and whether any hard one is broken."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from kerfwise.rules.rule import Strength, Violation

if TYPE_CHECKING:
    from .judged_cuts import JudgedCuts

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


@dataclass(frozen=True, slots=True)
class Measured:
    """The check's own count: paths with the torch (or the marking tool) on, their length, and idle travel, mm."""

    paths: int
    on_mm: float
    idle_mm: float


@dataclass(frozen=True, slots=True)
class CheckResult:
    """The judgements, those on the program itself first, then the profile's rules; warnings fail nothing.

    `by_rules` are the cuts of a plan with what the rules say of them, for the check of its program.
    """

    rules: tuple[Judgement, ...]
    warnings: tuple[str, ...]
    measured: Measured
    by_rules: JudgedCuts | None = field(default=None, compare=False, repr=False)

    @property
    def ok(self) -> bool:
        """Whether every hard rule holds."""
        return all(j.holds for j in self.rules if j.strength == "hard")

    def rule(self, rule_id: str) -> Judgement:
        """The judgement on one rule (KeyError if there is none)."""
        return {j.id: j for j in self.rules}[rule_id]

    def broken(self) -> tuple[str, ...]:
        """Ids of the hard rules that are broken, or cannot be judged and have to be."""
        return tuple(j.id for j in self.rules if j.strength == "hard" and not j.holds)

    def __str__(self) -> str:
        from .report import report

        return report(self)
