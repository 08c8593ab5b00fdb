"""What a plan keeps of the hard rules: all, all but for some places, or not enough to be cut; and that in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

How = Literal["excused", "relaxed", "dropped", "broken"]
Kind = Literal["kept", "kept but for", "broken"]

_HOW: tuple[How, ...] = ("excused", "relaxed", "dropped")
_NAMED = 6
"""Places that are named of one rule in one sentence."""


@dataclass(frozen=True, slots=True)
class Place:
    """One place where a hard rule does not hold: which rule, the ids of the contours, and why that is so.

    It is `excused` by the rule itself, `relaxed` as a planner has asked, `dropped` where orders contradict each other,
    or `broken`.
    """

    how: How
    rule: str
    contours: tuple[str, ...]
    why: str

    def __str__(self) -> str:
        return f"{self.how}, {self.rule}: {', '.join(self.contours)}: {self.why}"


@dataclass(frozen=True, slots=True)
class PlanState:
    """Whether every hard rule holds without exception, or but for some places, or the check refuses the plan.

    Soft rules do not count. `places` are those where a hard rule does not hold, of a plan that is broken only those
    that are `broken`. An order that was dropped and holds all the same is kept.

    Examples
    --------
    >>> PlanState("kept").words()
    'ok: every hard rule holds'
    >>> state = PlanState.of([Place("excused", "part-rigidity", (f"P{k}.outer",), "thin") for k in (3, 4)])
    >>> state.short(), state.words()
    ('kept but for 2 places', 'ok, but 2 places are not kept: 2 excused (part-rigidity: P3.outer; P4.outer)')
    """

    kind: Kind
    places: tuple[Place, ...] = ()

    @staticmethod
    def of(places: Sequence[Place]) -> PlanState:
        """The state with these places."""
        broken = tuple(place for place in places if place.how == "broken")
        if broken:
            return PlanState("broken", broken)
        return PlanState("kept but for", tuple(places)) if places else PlanState("kept")

    @property
    def count(self) -> int:
        """How many places are not kept."""
        return len(self.places)

    def short(self) -> str:
        """The state in a few words."""
        return f"kept but for {_places(self.count)}" if self.kind == "kept but for" else self.kind

    def words(self) -> str:
        """The state in a sentence, with every place that is not kept, many of one rule counted."""
        if self.kind == "kept":
            return "ok: every hard rule holds"
        if self.kind == "broken":
            rules = dict.fromkeys(place.rule for place in self.places)
            return f"FAILED: {len(rules)} hard rules broken: {', '.join(rules)}"
        verb = "is" if self.count == 1 else "are"
        return f"ok, but {_places(self.count)} {verb} not kept: {', '.join(self._counted())}"

    def _counted(self) -> Iterator[str]:
        for how in _HOW:
            by_rule: dict[str, list[str]] = {}
            for place in self.places:
                if place.how == how:
                    by_rule.setdefault(place.rule, []).append(" and ".join(place.contours) or "the sheet")
            if by_rule:
                text = "; ".join(f"{rule}: {_first(names)}" for rule, names in by_rule.items())
                yield f"{sum(map(len, by_rule.values()))} {how} ({text})"

    def for_operator(self) -> str:
        """What it means for the sheet, to whoever stands at the machine."""
        if self.kind == "kept":
            return "kept: cut it as the program says"
        if self.kind == "broken":
            return "broken: do not cut this sheet"
        return f"{self.short()}: metal may move or tip there, stand by when these are cut: {self.named()}"

    def named(self) -> str:
        """The contours of the first places."""
        return _first(list(dict.fromkeys(" and ".join(place.contours) or "the sheet" for place in self.places)))

    def as_json(self) -> dict[str, Any]:
        """As a plan states it."""
        places = [{"how": p.how, "rule": p.rule, "contours": list(p.contours), "why": p.why} for p in self.places]
        return {"kind": self.kind, "count": self.count, "places": places}

    @staticmethod
    def of_json(data: Mapping[str, Any]) -> PlanState:
        """The same, read back."""
        places = (Place(p["how"], p["rule"], tuple(p["contours"]), p["why"]) for p in data["places"])
        return PlanState(data["kind"], tuple(places))


def _places(count: int) -> str:
    return f"{count} place{'' if count == 1 else 's'}"


def _first(names: Sequence[str]) -> str:
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return "; ".join(names[:_NAMED]) + more
