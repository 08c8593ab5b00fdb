"""What a check finds: a judgement on every rule, and whether any hard one is broken; and the same as text."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from kerfwise.encoder.shown import shown

from .judged_cuts import JudgedCuts
from .judgement import Judgement

MOST = 20
MOST_SOFT = 3


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
        return report(self)


def report(result: CheckResult, most: int = MOST) -> str:
    """Every rule a line, what breaks it below; the last line says how it ends.

    At most `most` sentences a rule are told, and at most `MOST_SOFT` where the rule is soft and breaking it but costs.
    """
    width = max((len(j.id) for j in result.rules), default=0)
    lines = [line for judgement in result.rules for line in _lines(judgement, width, most)]
    lines += [f"warning: {shown(text)}" for text in result.warnings[:most]]
    if len(result.warnings) > most:
        lines.append(f"... and {len(result.warnings) - most} more warnings")
    measured = result.measured
    lines.append(f"measured: {measured.paths} paths, {measured.on_mm:.1f} mm torch on, {measured.idle_mm:.1f} mm idle")
    lines.append("ok: every hard rule holds" if result.ok else f"FAILED: {_failed(result)}")
    return "\n".join(lines)


def _failed(result: CheckResult) -> str:
    """The hard rules that fail, in words: those that are broken, and those that could not be judged."""
    failed = [result.rule(name) for name in result.broken()]
    broken = [judgement.id for judgement in failed if judgement.violations]
    unknown = [judgement.id for judgement in failed if not judgement.violations]
    told = [f"{len(broken)} hard rules broken: {', '.join(broken)}"] if broken else []
    told += [f"{len(unknown)} hard rules cannot be judged: {', '.join(unknown)}"] if unknown else []
    return "; ".join(told)


def _lines(judgement: Judgement, width: int, most: int) -> Iterator[str]:
    yield f"{judgement.verdict:<10} {judgement.strength:<4} {judgement.id:<{width}}  {shown(judgement.sentence)}"
    if judgement.unjudged is not None:
        yield f"    {shown(judgement.unjudged)}"
    told = most if judgement.strength == "hard" else min(most, MOST_SOFT)
    for violation in judgement.violations[:told]:
        yield f"    {shown(violation.text)}"
    if len(judgement.violations) > told:
        yield f"    ... and {len(judgement.violations) - told} more"
    for excused in judgement.excused[:most]:
        yield f"    excused: {shown(excused.violation.text)} ({shown(excused.why)})"
    if len(judgement.excused) > most:
        yield f"    ... and {len(judgement.excused) - most} more excused"
