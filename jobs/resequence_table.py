"""What resequence prints: both programs side by side, and each rule's verdict on the old order and the new."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kerfwise.encoder.shown import shown

from .aligned import aligned

if TYPE_CHECKING:
    from .resequenced import Resequenced

_TOLD = 3


def table(made: Resequenced) -> str:
    """Idle travel, pierces, time, and the verdicts; below them what breaks a hard rule in the old order."""
    before, after = made.before, made.after
    rows = [
        ("idle travel", _metres(before.idle_mm), _metres(after.idle_mm), _change(before.idle_mm, after.idle_mm)),
        ("torch on", _metres(before.cut_mm), _metres(after.cut_mm), _change(before.cut_mm, after.cut_mm)),
        ("pierces", str(before.pierces), str(after.pierces), _difference(before.pierces, after.pierces)),
        ("time", clock_text(before.time_s), clock_text(after.time_s), _change(before.time_s, after.time_s)),
    ]
    if before.verdict is not None and after.verdict is not None:
        now = {judgement.id: judgement for judgement in after.verdict.rules}
        for judgement in before.verdict.rules:
            if judgement.strength != "off" and judgement.id in now:
                then = judgement.verdict, now[judgement.id].verdict
                rows.append((f"{judgement.strength} {judgement.id}", *then, "" if then[0] == then[1] else "changed"))
    head = ("", "before", "after", "")
    lines = [*aligned([head, *rows]), *_broken(made)]
    lines.append(made.ends if made.changed else f"unchanged: {made.ends}")
    return "\n".join(lines)


def _broken(made: Resequenced) -> list[str]:
    """What breaks hard rules in the old order."""
    told: list[str] = []
    for judgement in made.before.verdict.rules if made.before.verdict is not None else ():
        if judgement.strength == "hard" and judgement.violations:
            told += [f"before: {judgement.id}: {shown(v.text)}" for v in judgement.violations[:_TOLD]]
            if len(judgement.violations) > _TOLD:
                told.append(f"before: {judgement.id}: ... and {len(judgement.violations) - _TOLD} more")
    return told


def clock_text(seconds: float) -> str:
    """Minutes and seconds.

    Examples
    --------
    >>> clock_text(754.4)
    '12:34'
    """
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d}"


def _metres(mm: float) -> str:
    return f"{mm / 1000:.3f} m"


def _change(before: float, after: float) -> str:
    return "" if before <= 0 or abs(after - before) < 1e-6 else f"{(after - before) / before:+.1%}"


def _difference(before: int, after: int) -> str:
    return "" if before == after else f"{after - before:+d}"
