"""The facts that selectors of own rules may name: one table for reading, messages, schema and docs.

Every fact has two columns. `of_facts` takes it from the facts that plans are made with; `of_nest` measures it from the
nest, for the check. For a contour's own measures (its name, its size) both are the same geometry.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.nest import KINDS, Nest

from . import measures
from .measures import MeasuredNest
from .value_kinds import AREAS, COUNTED, LENGTHS, FlagKind, FreeKind, TextKind, ValueKind, WordKind

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

Values = Sequence[Any]
ATTRIBUTE = "attribute."
"""`attribute.priority` is what the nest's file says of a part under `priority`."""


@dataclass(frozen=True, slots=True)
class NamedFact:
    """A fact by name: its kind, one line of help, and its values for every contour of a nest, from either source."""

    name: str
    kind: ValueKind
    help: str
    of_facts: Callable[[Facts], Values]
    of_nest: Callable[[MeasuredNest], Values]


def _own(name: str, kind: ValueKind, help: str, of: Callable[[Nest], Values]) -> NamedFact:
    """A measure of a contour by itself."""
    return NamedFact(name, kind, help, lambda facts: of(facts.nest), lambda m: of(m.nest))


def _edge_gap(side: str, column: int) -> NamedFact:
    return NamedFact(
        f"{side}_gap_mm",
        LENGTHS,
        f"distance from the {side} side of the sheet",
        lambda facts: [float(v) for v in facts.edge_gap_mm[:, column]],
        lambda m: measures.edge_gaps_mm(m.nest, side),
    )


def _hosts(facts: Facts) -> list[str]:
    contours, index = facts.nest.contours, facts.nest.index
    hole = {p.id: int(facts.parent[index[p.outer.id]]) for p in facts.nest.parts}
    return [contours[hole[c.part]].part if hole.get(c.part, -1) >= 0 else "" for c in contours]


def _depths(facts: Facts) -> list[int]:
    depth = [0] * facts.n
    for inner in facts.contains[:, 1].tolist():
        depth[inner] += 1
    return depth


def _neighbour_counts(facts: Facts) -> list[int]:
    index = facts.nest.index
    place = [int(facts.parent[index[p.outer.id]]) for p in facts.nest.parts]
    return measures.count_near(facts.nest, place, facts.options.web_mm)


_TABLE = (
    _own("kind", WordKind(KINDS), "what the contour is", lambda n: [c.kind for c in n.contours]),
    _own("part", TextKind(), "id of its part, empty for a scrap line", lambda n: [c.part for c in n.contours]),
    _own(
        "id",
        TextKind(),
        "its own id, `<part>.outer`, `<part>.hole1` …, `scrap1` …",
        lambda n: [c.id for c in n.contours],
    ),
    _own("area_mm2", AREAS, "area inside it, 0 for an open line", measures.areas_mm2),
    _own("length_mm", LENGTHS, "its length", measures.lengths_mm),
    _own("width_mm", LENGTHS, "its extent along x", lambda n: measures.sizes_mm(n, 0)),
    _own("height_mm", LENGTHS, "its extent along y", lambda n: measures.sizes_mm(n, 1)),
    _own(
        "short_side_mm",
        LENGTHS,
        "shorter side of the smallest rectangle around it, at any angle",
        lambda n: measures.rectangle_sides_mm(n, longer=False),
    ),
    _own(
        "long_side_mm", LENGTHS, "longer side of that rectangle", lambda n: measures.rectangle_sides_mm(n, longer=True)
    ),
    NamedFact(
        "long",
        FlagKind(),
        "an outer contour whose longer side is at least `long_ratio` (rule start-side) times the shorter",
        lambda facts: [bool(v) for v in facts.long],
        measures.is_long,
    ),
    _edge_gap("left", 0),
    _edge_gap("right", 1),
    _edge_gap("bottom", 2),
    _edge_gap("top", 3),
    NamedFact(
        "edge_gap_mm",
        LENGTHS,
        "distance from the nearest side of the sheet",
        lambda facts: [float(v) for v in facts.edge_gap_mm.min(axis=1)],
        lambda m: measures.edge_gaps_mm(m.nest, "edge"),
    ),
    NamedFact("depth", COUNTED, "how many contours lie around it, 0 for a part on the sheet", _depths, measures.depths),
    NamedFact("host", TextKind(), "id of the part in whose hole its part lies, empty for none", _hosts, measures.hosts),
    NamedFact(
        "hosted",
        FlagKind(),
        "whether its part lies in a hole of another part",
        lambda facts: [host != "" for host in _hosts(facts)],
        lambda m: [host != "" for host in measures.hosts(m)],
    ),
    NamedFact(
        "neighbours_count",
        COUNTED,
        "of an outer contour: other parts in the same place no further off than 25 mm",
        _neighbour_counts,
        measures.neighbour_counts,
    ),
    NamedFact(
        "zone",
        COUNTED,
        "zone in which it is cut, from 1",
        lambda facts: facts.zone.tolist(),
        lambda m: measures.zones(m),
    ),
)

NAMED_FACTS: Mapping[str, NamedFact] = {fact.name: fact for fact in _TABLE}


def named_fact(name: str) -> NamedFact | None:
    """The fact of that name, `attribute.<anything>` included; None for an unknown one."""
    if name.startswith(ATTRIBUTE) and name != ATTRIBUTE:
        key = name.removeprefix(ATTRIBUTE)
        return _own(name, FreeKind(), f"what the nest says under {key!r}", lambda n: measures.attributes(n, key))
    return NAMED_FACTS.get(name)


class KnownFacts:
    """The values of named facts for every contour of one nest, computed when first asked for."""

    def __init__(self, nest: Nest, values: Callable[[NamedFact], Values]) -> None:
        self.nest, self._values = nest, values
        self._found: dict[str, Values] = {}

    def values(self, name: str) -> Values:
        """The fact of that name, contour by contour."""
        if name not in self._found:
            fact = named_fact(name)
            assert fact is not None, name
            self._found[name] = self._values(fact)
        return self._found[name]


def known_of_facts(facts: Facts) -> KnownFacts:
    """Values as plans are made with."""
    return KnownFacts(facts.nest, lambda fact: fact.of_facts(facts))


def known_of_nest(m: MeasuredNest) -> KnownFacts:
    """Values as the check measures them."""
    return KnownFacts(m.nest, lambda fact: fact.of_nest(m))
