"""Two sides of one nest: figures, rules and cuts, and what may be said of the difference."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from kerfwise.postproc.check.judgement import Judgement

from .figures import Figure
from .moved import CutPair
from .side import Side

FORMAT = "kerfwise-comparison/1"


@dataclass(frozen=True, slots=True)
class RulePays:
    """What one rule is on one side: its strength and verdict, its breaches and excuses, and what those cost, mm.

    `cost_mm` is the weight of a soft rule times its breaches, as the check counts them; hard rules and rules that are
    off cost nothing.
    """

    strength: str
    verdict: str
    breaches: int
    excuses: int
    cost_mm: float

    @property
    def told(self) -> str:
        """The same in a few words."""
        if self.strength in ("off", "-"):
            return self.strength
        told = f"{self.strength}, {self.verdict}"
        if self.cost_mm:
            told += f": {self.breaches} × = {self.cost_mm / 1000:.3f} m"
        elif self.breaches:
            told += f": {self.breaches} ×"
        return told + (f", {self.excuses} excused" if self.excuses else "")

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
    return RulePays(judged.strength, judged.verdict, breaches, len(judged.excused), breaches * (weight_mm or 0.0))


def _side(side: Side) -> dict[str, Any]:
    plan = side.plan
    return {
        "name": side.name,
        "made": side.made,
        "profile": {"name": side.profile.name, "sha256": side.profile.sha256},
        "ok": side.verdict.ok,
        "broken": list(side.verdict.broken()),
        "proof": side.proof,
        "status": None if plan is None else plan.solve.status,
        "bound_mm": None if plan is None else plan.solve.bound,
        "gap": None if plan is None else plan.solve.gap,
        "time": side.times.as_json(),
    }
