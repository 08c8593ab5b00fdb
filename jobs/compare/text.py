"""What compare prints."""

from __future__ import annotations

from collections.abc import Sequence

from kerfwise.encoder.shown import shown
from kerfwise.jobs.aligned import aligned
from kerfwise.postproc.report.legend import counted

from .comparison import Compared
from .moved import CutPair
from .side import Side

_TOLD = 20


def text(made: Compared) -> str:
    """Both sides by name, the figures, the rules, the cuts that differ, and what may be claimed."""
    lines = [*sides(made), ""]
    lines += aligned([("", "A", "B", ""), *figure_rows(made)])
    telling = [row for row, (_, a, b) in zip(rule_rows(made), made.rules, strict=True) if not (a.quiet and b.quiet)]
    lines += ["", *(aligned([("rule", "A", "B", ""), *telling]) if telling else [])]
    if quiet := len(made.rules) - len(telling):
        lines.append(f"{counted(quiet, 'hard rule')} more, which hold wherever they are asked (--json has them all)")
    lines.append("")
    changed = made.changed
    lines.append(summary_of(changed, len(made.cuts)))
    if changed:
        lines += aligned([("contour", "A", "B", ""), *(cut_row(pair) for pair in changed[:_TOLD])])
        if len(changed) > _TOLD:
            lines.append(f"... and {len(changed) - _TOLD} more (--json has them all)")
    return "\n".join([*lines, "", *proofs(made)])


def sides(made: Compared) -> list[str]:
    """Both sides by name."""
    return [f"A: {_named(made.a)}", f"B: {_named(made.b)}"]


def figure_rows(made: Compared) -> list[tuple[str, str, str, str]]:
    """Label, both values, and the change."""
    return [(figure.label, *figure.texts) for figure in made.figures]


def rule_rows(made: Compared) -> list[tuple[str, str, str, str]]:
    """Id, what the rule is on both sides, and whether that differs."""
    return [(name, a.told, b.told, "" if a == b or "-" in (a.told, b.told) else "changed") for name, a, b in made.rules]


def cut_row(pair: CutPair) -> tuple[str, str, str, str]:
    """Contour, both positions, and what differs."""
    a, b = ("-" if place is None else str(place) for place in (pair.a, pair.b))
    return shown(pair.contour), a, b, pair.told


def proofs(made: Compared) -> list[str]:
    """What is proven of each side, whether the check passes it, and what the difference may be taken for."""
    lines = [f"{letter}: {side.proof}" for letter, side in (("A", made.a), ("B", made.b))]
    lines += [
        f"{letter}: the check refuses it: {', '.join(side.verdict.broken())}"
        for letter, side in (("A", made.a), ("B", made.b))
        if not side.verdict.ok
    ]
    return [*lines, made.claim]


def summary_of(changed: Sequence[CutPair], count: int) -> str:
    """How many cuts differ, and in what."""
    if not changed:
        return f"{counted(count, 'cut')}, none differs"
    kinds = (
        ("moved", sum(pair.moved for pair in changed)),
        ("begun elsewhere", sum(pair.entry_mm > 0 for pair in changed)),
        ("other way round", sum(pair.turned for pair in changed)),
        ("with another lead", sum(pair.lead for pair in changed)),
        ("with other tabs", sum(pair.tabs for pair in changed)),
        ("in one only", sum(None in (pair.a, pair.b) for pair in changed)),
    )
    told = ", ".join(f"{number} {what}" for what, number in kinds if number)
    return f"{len(changed)} of {counted(count, 'cut')} differ: {told or 'linked in one only'}"


def _named(side: Side) -> str:
    made = {"plan": "plan", "program": "program", "solved": "planned now"}[side.made]
    return f"{shown(side.name)} ({made}, profile {shown(side.profile.name)})"
