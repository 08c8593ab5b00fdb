"""What an own rule can ask of the contours it selects, and rules about how a contour is cut and entered."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import yaml

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.text import unknown
from kerfwise.rules.options.kind import Choice, Flag, Unfit
from kerfwise.rules.options.yaml_positions import Problems, entries, is_empty, shape
from kerfwise.rules.statements import About, Forbid, Statement

from .criteria import LENGTHS, Criterion, NumberSpan
from .selector import KnownFacts, Selector

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


# What an own rule can ask of the contours it selects: the interface that every statement of the language has.

MOST = 250_000
"""Own rules that come to more single statements than this on one nest are refused; they would outgrow any solver."""

Breach = tuple[tuple[str, ...], str, tuple[int, ...]]
"""A breach: contour ids, what is wrong in words, positions of the cuts."""


@dataclass(frozen=True, eq=False, slots=True)
class Chosen:
    """Which contours of a nest a rule is about: its id and reason, and group by group (selected, all of the group)."""

    rule: str
    why: str
    known: KnownFacts
    groups: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]

    @property
    def nest(self) -> Nest:
        """The nest that contours are numbered in."""
        return self.known.nest

    def ids(self, *contours: int) -> tuple[str, ...]:
        """Ids of contours by number."""
        return tuple(self.nest.contours[k].id for k in contours)

    def about(self, contours: tuple[int, ...], sentence: str) -> About:
        """Where a statement comes from, with the rule's reason behind the sentence."""
        return About(self.rule, self.ids(*contours), f"{sentence}: {self.why}")

    def check_size(self, count: int) -> None:
        """Refuse a rule that comes to more than `MOST` statements."""
        if count > MOST:
            raise InputError(
                f"{self.rule} comes to {count:,} statements on this nest, at most {MOST:,} are taken; select fewer "
                "contours or narrow its scope"
            )


class Constraint(ABC):
    """One kind of demand; `KEYS` are the words for it in a profile with a line of help each.

    `MINDS_WHAT_IS_OUT` is that of a rule, see there.
    """

    KEYS: ClassVar[dict[str, str]]
    MINDS_WHAT_IS_OUT: ClassVar[bool] = False

    @classmethod
    @abstractmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> Constraint:
        """The demand that stands under `key`."""

    @classmethod
    @abstractmethod
    def schema(cls, key: str) -> dict[str, Any]:
        """JSON Schema of what may stand under `key`."""

    @abstractmethod
    def plain(self) -> tuple[str, object]:
        """Key and YAML data that read back as this demand."""

    @abstractmethod
    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[Statement]:
        """The demand as statements, all hard."""

    @abstractmethod
    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        """Where cuts do not meet the demand."""

    def selectors(self) -> tuple[Selector, ...]:
        """The further selectors it has."""
        return ()

    def facts(self) -> set[str]:
        """Names of the facts that it looks at, beside those of its selectors."""
        return set()

    def pairs(self, chosen: Chosen) -> list[tuple[int, int]]:
        """Contour numbers (before, after) that it orders."""
        return []

    def together(self, chosen: Chosen) -> list[tuple[int, ...]]:
        """Sets of contour numbers that it keeps free of others."""
        return []

    def unjudged(self, cuts: CutSequence) -> str | None:
        """Why it cannot be judged on these cuts, where that is so."""
        return None


def read_true(node: yaml.Node, problems: Problems, what: str) -> None:
    """For keys that say all by being there: note anything but `true` as a problem."""
    try:
        if Flag().read(node):
            return
    except Unfit as error:
        problems.add(node, f"{what}: {error}")
        return
    problems.add(node, f"{what}: expected true; leave the key out to ask nothing")


# Own rules about how a contour is cut: direction, and where it may be pierced and entered.

DIRECTIONS = Choice(("cw", "ccw"))
NC_ROUNDING_MM = 0.05
"""A point this near to a limit is on either side of it: programs round their coordinates."""

PLACES = {
    "x_mm": "its x",
    "y_mm": "its y",
    "left_gap_mm": "distance from the left side of the sheet",
    "right_gap_mm": "distance from the right side of the sheet",
    "bottom_gap_mm": "distance from the bottom side of the sheet",
    "top_gap_mm": "distance from the top side of the sheet",
    "edge_gap_mm": "distance from the nearest side of the sheet",
}
"""What can be said of a pierce or an entry, each a length."""


@dataclass(frozen=True, slots=True)
class DirectionConstraint(Constraint):
    """The selected contours are cut in one direction."""

    KEYS = {"direction": "the way round that the selected contours are cut, cw or ccw as seen with y up"}  # noqa: RUF012

    direction: str

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> DirectionConstraint:
        try:
            return DirectionConstraint(str(DIRECTIONS.read(node)))
        except Unfit as error:
            problems.add(node, f"{what}: {error}")
            return DirectionConstraint("")

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        return DIRECTIONS.schema()

    def plain(self) -> tuple[str, object]:
        return "direction", self.direction

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[Forbid]:
        for k in _selected(chosen):
            about = chosen.about((k,), f"{facts.nest.contours[k].id} is cut {self.direction}")
            for c in facts.candidates_of(k):
                if facts.candidates[c].direction != self.direction:
                    yield Forbid(c, about)

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        ids = set(chosen.ids(*_selected(chosen)))
        for k, cut in enumerate(cuts, 1):
            if cut.contour in ids and cut.direction != self.direction:
                yield (cut.contour,), f"{cut.contour} (cut {k}) is cut {cut.direction}, not {self.direction}", (k,)


@dataclass(frozen=True, slots=True)
class EntryConstraint(Constraint):
    """The selected contours are pierced, or entered, only in a place, or anywhere but there."""

    KEYS = {  # noqa: RUF012
        "pierce": "the selected contours are pierced only where this holds: {x_mm, y_mm, left_gap_mm, …}",
        "no_pierce": "the selected contours are not pierced where this holds",
        "entry": "the torch joins the selected contours only where this holds",
        "no_entry": "the torch does not join the selected contours where this holds",
    }

    key: str
    criteria: tuple[tuple[str, Criterion], ...]

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> EntryConstraint:
        if is_empty(node) or not isinstance(node, yaml.MappingNode) or not node.value:
            problems.add(node, f"{what}: expected a place such as {{left_gap_mm: '< 50'}}, got {shape(node)}")
            return EntryConstraint(key, ())
        criteria = []
        for name, key_node, value in entries(node, problems, what):
            if name not in PLACES:
                problems.add(key_node, f"{what}: {unknown('key', name, PLACES)}")
                continue
            try:
                criteria.append((name, LENGTHS.read_one(value)))
            except Unfit as error:
                problems.add(value, f"{what}.{name}: {error}")
        return EntryConstraint(key, tuple(criteria))

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        keys = {name: {"description": help, **LENGTHS.schema_of_one()} for name, help in PLACES.items()}
        return {"type": "object", "properties": keys, "additionalProperties": False, "minProperties": 1}

    def plain(self) -> tuple[str, object]:
        return self.key, {name: criterion.plain() for name, criterion in self.criteria}

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[Forbid]:
        for k in _selected(chosen):
            about = chosen.about((k,), f"{facts.nest.contours[k].id} is {self._asked()}")
            for c in facts.candidates_of(k):
                candidate = facts.candidates[c]
                point = candidate.pierce if "pierce" in self.key else candidate.entry
                if self._met(facts.nest, point, 0.0) == self._refuses:
                    yield Forbid(c, about)

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        ids = set(chosen.ids(*_selected(chosen)))
        slack_mm = -NC_ROUNDING_MM if self._refuses else NC_ROUNDING_MM
        for k, cut in enumerate(cuts, 1):
            point = cut.pierce if "pierce" in self.key else cut.entry
            if cut.contour in ids and self._met(chosen.nest, point, slack_mm) == self._refuses:
                where = f"({point[0]:.2f}, {point[1]:.2f})"
                done = "pierced" if "pierce" in self.key else "entered"
                yield (cut.contour,), f"{cut.contour} (cut {k}) is {done} at {where}; it must be {self._asked()}", (k,)

    @property
    def _refuses(self) -> bool:
        return self.key.startswith("no_")

    def _asked(self) -> str:
        where = " and ".join(f"{name} {criterion.plain()}" for name, criterion in self.criteria)
        done = "pierced" if "pierce" in self.key else "entered"
        return f"not {done} where {where}" if self._refuses else f"{done} only where {where}"

    def _met(self, nest: Nest, point: Point, slack_mm: float) -> bool:
        """Whether a point lies in the place; a slack above 0 takes in what is near, one below 0 leaves it out."""
        values = _places_mm(nest, point)
        spans = [(values[name], span) for name, span in self.criteria if isinstance(span, NumberSpan)]
        if slack_mm < 0:
            return all(span.surely_met(value, -slack_mm) for value, span in spans)
        return all(span.perhaps_met(value, slack_mm) for value, span in spans)


def _places_mm(nest: Nest, point: Point) -> dict[str, float]:
    """Everything in `PLACES` of a point."""
    xmin, ymin, xmax, ymax = nest.sheet.bounds
    x, y = point
    gaps = (x - xmin, xmax - x, y - ymin, ymax - y)
    return dict(zip(PLACES, (x, y, *gaps, min(gaps)), strict=True))


def _selected(chosen: Chosen) -> list[int]:
    return [k for selected, _ in chosen.groups for k in selected]
