"""A check's result as text: every rule with its verdict, and a sentence for every violation."""

from __future__ import annotations

from collections.abc import Iterator

from kerfwise.encoder.shown import shown

from .result import CheckResult, Judgement

MOST = 20
MOST_SOFT = 3


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
