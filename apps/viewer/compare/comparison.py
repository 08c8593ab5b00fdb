"""Two sides of one nest: figures, rules and cuts, and what may be said of the difference."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from kerfwise.encoder.display import align_columns
from kerfwise.encoder.escape import escape_text
from kerfwise.postproc.check.result import Judgement
from kerfwise.postproc.report.legend import counted

from .differences import CutPair, Figure
from .sides import Side

FORMAT = "kerfwise-comparison/1"


@dataclass(frozen=True, slots=True)
class RulePays:
    """What one rule is on one side: its strength and verdict, its breaches and what they cost, mm, what is not kept.

    `cost_mm` is the weight of a soft rule times its breaches, as the check counts them; hard rules and rules that are
    off cost nothing.
    """

    strength: str
    verdict: str
    breaches: int
    excuses: int
    cost_mm: float
    unkept: str = ""
    """How many places are excused, relaxed and dropped, in words."""

    @property
    def told(self) -> str:
        """The same in a few words."""
        if self.strength in ("off", "-"):
            return self.strength
        if self.verdict == "excused":
            return f"{self.strength}, kept but for {self.unkept}"
        text = f"{self.strength}, {self.verdict}"
        if self.cost_mm:
            text += f": {self.breaches} × = {self.cost_mm / 1000:.3f} m"
        elif self.breaches:
            text += f": {self.breaches} ×"
        return text + (f", {self.unkept}" if self.unkept else "")

    @property
    def quiet(self) -> bool:
        """Whether there is nothing to say of it: a hard rule that holds everywhere, or one that is not asked."""
        return self.strength == "-" or (self.strength, self.verdict) == ("hard", "holds")

    def as_json(self) -> dict[str, Any]:
        """The same as data."""
        return {name: getattr(self, name) for name in self.__slots__}


NOT_ASKED = RulePays("-", "not judged", 0, 0, 0.0)
"""A program is asked other things than a plan."""


@dataclass(frozen=True, eq=False, slots=True)
class Compared:
    """Two sides, A and B, and what differs.

    Attributes
    ----------
    a, b
        Each with `plan` (None for a program), `verdict`, `times` and, where it was asked for, `heat`.
    figures
        Lengths, pierces, times, cost: `key`, `a`, `b` and `texts` of each.
    rules
        Id of each rule, and what it is on both sides: `strength`, `verdict`, `breaches`, `excuses`, `cost_mm`.
    cuts
        Every contour in both: its position in each, and what differs, in `told`.
    notes
        What is to be known of one side, such as that its plan was made with another profile.
    """

    a: Side
    b: Side
    figures: tuple[Figure, ...]
    rules: tuple[tuple[str, RulePays, RulePays], ...]
    cuts: tuple[CutPair, ...]
    notes: tuple[str, ...] = ()

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C, or the progress callback, ended the planning of a side."""
        return self.a.interrupted or self.b.interrupted

    @property
    def changed(self) -> tuple[CutPair, ...]:
        """The cuts that differ in more than the number of their position."""
        return tuple(pair for pair in self.cuts if not pair.same)

    @property
    def claim(self) -> str:
        """What the difference may be taken for: no more than is proven."""
        if not self.changed:
            return "both make the same cuts in the same order"
        if self.a.optimal and self.b.optimal:
            return (
                "each plan is proven optimal within its own zones and entries only: with other zones or entries the "
                "difference may be another"
            )
        found = [name for name, side in (("A", self.a), ("B", self.b)) if not side.optimal]
        one = f"{found[0]} is" if len(found) == 1 else "A and B are"
        return f"{one} not proven optimal: the difference is between these two, and better ones may exist"

    def as_json(self) -> dict[str, Any]:
        """The comparison as `kerfwise compare --json` prints it."""
        return {
            "format": FORMAT,
            "nest": self.a.given.nest.file,
            "a": _side(self.a),
            "b": _side(self.b),
            "claim": self.claim,
            "figures": {figure.key: figure.as_json() for figure in self.figures},
            "rules": [{"id": name, "a": a.as_json(), "b": b.as_json()} for name, a, b in self.rules],
            "changed": [pair.as_json() for pair in self.changed],
        }


def rules_of(a: Side, b: Side) -> tuple[tuple[str, RulePays, RulePays], ...]:
    """Id, and what the rule is on both sides: of every rule that is on in one of them, and of the program's own."""
    first, second = _paid(a), _paid(b)
    names = dict.fromkeys([*first, *second])
    rows = [(name, first.get(name, NOT_ASKED), second.get(name, NOT_ASKED)) for name in names]
    return tuple(row for row in rows if {row[1].strength, row[2].strength} - {"off", "-"})


def _paid(side: Side) -> dict[str, RulePays]:
    settings = side.profile.settings()
    return {j.id: _pays(j, settings[j.id].weight if j.id in settings else None) for j in side.verdict.rules}


def _pays(judged: Judgement, weight_mm: float | None) -> RulePays:
    breaches = len(judged.violations)
    unkept = ", ".join(f"{count} {how}" for how, count in Counter(one.how for one in judged.excused).items())
    cost_mm = breaches * (weight_mm or 0.0)
    return RulePays(judged.strength, judged.verdict, breaches, len(judged.excused), cost_mm, unkept)


def _side(side: Side) -> dict[str, Any]:
    plan = side.plan
    return {
        "name": side.name,
        "made": side.made,
        "profile": {"name": side.profile.name, "sha256": side.profile.sha256},
        "ok": side.verdict.ok,
        "broken": list(side.verdict.broken()),
        "state": side.verdict.state.as_json(),
        "proof": side.proof,
        "status": None if plan is None else plan.solve.status,
        "bound_mm": None if plan is None else plan.solve.bound,
        "gap": None if plan is None else plan.told_gap,
        "time": side.times.as_json(),
    }


# What compare prints.

_TOLD = 20


def text(compared: Compared) -> str:
    """Both sides by name, the figures, the rules, the cuts that differ, and what may be claimed."""
    lines = [*sides(compared), ""]
    lines += align_columns([("", "A", "B", ""), *figure_rows(compared)])
    telling = [
        row for row, (_, a, b) in zip(rule_rows(compared), compared.rules, strict=True) if not (a.quiet and b.quiet)
    ]
    lines += ["", *(align_columns([("rule", "A", "B", ""), *telling]) if telling else [])]
    if quiet := len(compared.rules) - len(telling):
        lines.append(f"{counted(quiet, 'hard rule')} more, which hold wherever they are asked (--json has them all)")
    lines.append("")
    changed = compared.changed
    lines.append(summary_of(changed, len(compared.cuts)))
    if changed:
        lines += align_columns([("contour", "A", "B", ""), *(cut_row(pair) for pair in changed[:_TOLD])])
        if len(changed) > _TOLD:
            lines.append(f"... and {len(changed) - _TOLD} more (--json has them all)")
    return "\n".join([*lines, "", *proofs(compared)])


def sides(compared: Compared) -> list[str]:
    """Both sides by name."""
    return [f"A: {_named(compared.a)}", f"B: {_named(compared.b)}"]


def figure_rows(compared: Compared) -> list[tuple[str, str, str, str]]:
    """Label, both values, and the change."""
    return [(figure.label, *figure.texts) for figure in compared.figures]


def rule_rows(compared: Compared) -> list[tuple[str, str, str, str]]:
    """Id, what the rule is on both sides, and whether that differs."""
    return [
        (name, a.told, b.told, "" if a == b or "-" in (a.told, b.told) else "changed") for name, a, b in compared.rules
    ]


def cut_row(pair: CutPair) -> tuple[str, str, str, str]:
    """Contour, both positions, and what differs."""
    a, b = ("-" if place is None else str(place) for place in (pair.a, pair.b))
    return escape_text(pair.contour), a, b, pair.told


def proofs(compared: Compared) -> list[str]:
    """What is proven of each side, whether it keeps every hard rule, and what the difference may be taken for."""
    lines = [f"{letter}: {side.proof}" for letter, side in (("A", compared.a), ("B", compared.b))]
    lines += [
        f"{letter}: the check refuses it: {', '.join(side.verdict.broken())}"
        for letter, side in (("A", compared.a), ("B", compared.b))
        if not side.verdict.ok
    ]
    states = [(letter, side.verdict.state) for letter, side in (("A", compared.a), ("B", compared.b))]
    lines += [f"{letter}: {escape_text(state.words())}" for letter, state in states if state.kind == "kept but for"]
    return [*lines, compared.claim]


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
    text = ", ".join(f"{number} {what}" for what, number in kinds if number)
    return f"{len(changed)} of {counted(count, 'cut')} differ: {text or 'linked in one only'}"


def _named(side: Side) -> str:
    kind = {"plan": "plan", "program": "program", "solved": "planned now"}[side.made]
    return f"{escape_text(side.name)} ({kind}, profile {escape_text(side.profile.name)})"
