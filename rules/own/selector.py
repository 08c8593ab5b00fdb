"""Which contours an own rule is about: the facts it may name, selectors over them, and how far it reaches."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import shapely
import yaml

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.nest import CONTOUR_KINDS, Nest
from kerfwise.encoder.text import unknown
from kerfwise.rules.judging.metal import host_holes, places
from kerfwise.rules.options.kind import Choice, OptionKind, Unfit
from kerfwise.rules.options.yaml_positions import Problems, entries, is_empty, shape
from kerfwise.rules.rule import USUAL, Plate

from .criteria import (
    AREAS,
    COUNTED,
    FLAGS,
    FREE,
    KILOGRAMS,
    LENGTHS,
    ROUNDING_MM,
    SECONDS,
    TEXTS,
    Criterion,
    ValueKind,
    none_has,
    word_kind,
)
from .measures import (
    areas_mm2,
    corner_distances_mm,
    cut_seconds,
    edge_gaps_mm,
    lengths_mm,
    middles_mm,
    rectangle_sides_mm,
    rectangles_mm,
    sizes_mm,
    weights_kg,
)

if TYPE_CHECKING:
    from kerfwise.encoder.candidates.candidate import Candidate
    from kerfwise.encoder.facts.facts import Facts


NOT = "not"


@dataclass(frozen=True, slots=True)
class Selector:
    """The contours that meet every criterion, less those that `excluded` selects; without criteria, all.

    Examples
    --------
    >>> from kerfwise.rules.own.criteria import Pattern
    >>> from kerfwise.rules.own.selector import nest_values as known_of_nest
    >>> from kerfwise.rules.own.selector import measure_nest as measured
    >>> from kerfwise.rules.case import nest, part, rect
    >>> plate = nest(100, 100, part("P1", rect(10, 10, 80, 80), [rect(30, 30, 20, 20)]))
    >>> known = known_of_nest(measured(plate, None, long_ratio=4, web_mm=25))
    >>> Selector((("kind", Pattern("hole")),)).chosen(known)
    (0,)
    """

    criteria: tuple[tuple[str, Criterion], ...] = ()
    excluded: Selector | None = None

    def chosen(self, known: KnownFacts) -> tuple[int, ...]:
        """Numbers of the contours selected, ascending."""
        columns = [(criterion, known.values(name)) for name, criterion in self.criteria]
        out = set(self.excluded.chosen(known)) if self.excluded else set()
        return tuple(
            k
            for k in range(len(known.nest.contours))
            if k not in out and all(criterion.met(column[k]) for criterion, column in columns)
        )

    def why_nothing(self, known: KnownFacts) -> str:
        """Why it selects no contour: what is asked of a fact that no contour has, and what there is.

        Examples
        --------
        >>> from kerfwise.rules.own.criteria import Pattern
        >>> from kerfwise.rules.own.selector import measure_nest as measured
        >>> from kerfwise.rules.case import nest, part, rect
        >>> plate = measured(nest(100, 100, part("P1", rect(10, 10, 80, 80))), None, long_ratio=4, web_mm=25)
        >>> Selector((("kind", Pattern("hole")),)).why_nothing(nest_values(plate))
        "none has the kind 'hole'; there is 'outer'"
        """
        for name, criterion in self.criteria:
            values = known.values(name)
            if not any(criterion.met(value) for value in values):
                return none_has(name.replace(ATTRIBUTE, "attribute "), criterion.plain(), values)
        return "none meets all that it asks"

    def names(self) -> set[str]:
        """The facts that it looks at."""
        return {name for name, _ in self.criteria} | (self.excluded.names() if self.excluded else set())

    def plain(self) -> dict[str, object]:
        """The YAML data that reads back as this selector."""
        result = {name: criterion.plain() for name, criterion in self.criteria}
        return result | ({NOT: self.excluded.plain()} if self.excluded else {})


def read_selector(node: yaml.Node, problems: Problems, what: str) -> Selector:
    """The selector that a mapping states: `{fact: criterion, …, not: {…}}`."""
    if is_empty(node) or not isinstance(node, yaml.MappingNode):
        problems.add(node, f"{what}: expected a selector such as {{kind: hole, area_mm2: '< 100'}}, got {shape(node)}")
        return Selector()
    criteria: list[tuple[str, Criterion]] = []
    excluded = None
    for name, key_node, value in entries(node, problems, what):
        fact = named_fact(name)
        if name == NOT:
            excluded = read_selector(value, problems, f"{what}.{NOT}")
        elif fact is None:
            attribute = f"{ATTRIBUTE}{name.partition('.')[2] or '<name>'}"
            problems.add(key_node, f"{what}: {unknown('fact', name, [*NAMED_FACTS, NOT, attribute])}")
        else:
            try:
                criteria.append((name, fact.kind.read(value)))
            except Unfit as error:
                problems.add(value, f"{what}.{name}: {error}")
    return Selector(tuple(criteria), excluded)


class _SelectorForm:
    """A selector as the value of a key."""

    def read(self, node: yaml.Node, problems: Problems, what: str) -> Selector:
        return read_selector(node, problems, what)

    def plain(self, value: Selector) -> object:
        return value.plain()

    def schema(self) -> dict[str, Any]:
        return {"$ref": "#/$defs/selector"}


SELECTOR = _SelectorForm()


def selector_schema() -> dict[str, Any]:
    """JSON Schema of a selector, to be referred to as `#/$defs/selector`."""
    facts = {
        name: {"description": fact.help + (f" ({fact.kind.unit})" if fact.kind.unit else ""), **fact.kind.schema()}
        for name, fact in NAMED_FACTS.items()
    }
    anything = named_fact(f"{ATTRIBUTE}x")
    assert anything is not None
    return {
        "type": "object",
        "properties": {**facts, NOT: {"$ref": "#/$defs/selector"}},
        "patternProperties": {r"^attribute\..+": anything.kind.schema()},
        "additionalProperties": False,
    }


# How far an own rule reaches: over the whole sheet, or within each part, zone, or group of one attribute.

WORDS = ("sheet", "part", "zone")


@dataclass(frozen=True, slots=True)
class Scope(OptionKind):
    """sheet, part, zone, or attribute.<name>: the parts that the nest gives the same value there."""

    def read(self, node: yaml.Node) -> str:
        text = str(node.value) if isinstance(node, yaml.ScalarNode) else ""
        if text.startswith(ATTRIBUTE) and text != ATTRIBUTE:
            return text
        if text not in WORDS:
            raise self.refuse(node)
        return text

    def write(self, value: str) -> str:
        return value

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [Choice(WORDS).schema(), {"type": "string", "pattern": r"^attribute\..+"}]}

    def expected(self) -> str:
        return f"{', '.join(WORDS)} or {ATTRIBUTE}<name>"


def groups(known: KnownFacts, scope: str) -> list[tuple[int, ...]]:
    """Contour numbers group by group; a contour without a value for the scope is in none.

    Examples
    --------
    >>> from kerfwise.rules.own.selector import measure_nest as measured
    >>> from kerfwise.rules.own.selector import nest_values as known_of_nest
    >>> from kerfwise.rules.case import nest, part, rect
    >>> two = part("A", rect(10, 10, 80, 80), [rect(30, 30, 20, 20)]), part("B", rect(110, 10, 80, 80))
    >>> plate = nest(300, 100, *two)
    >>> groups(known_of_nest(measured(plate, None, long_ratio=4, web_mm=25)), "part")
    [(0, 1), (2,)]
    """
    if scope == "sheet":
        return [tuple(range(len(known.nest.contours)))]
    found: dict[str, list[int]] = {}
    for k, value in enumerate(known.values(scope)):
        if value is not None:
            found.setdefault(str(value), []).append(k)
    return [tuple(members) for members in found.values()]


# The facts that own rules select by, measured from a nest with plain shapely.
#
# The check judges by these alone; the facts that models are built on are not looked at here.


@dataclass(frozen=True, eq=False, slots=True)
class MeasuredNest:
    """What values are measured from: a nest, its cuts if there are any, two thresholds, and the plate."""

    nest: Nest
    cuts: CutSequence
    long_ratio: float
    web_mm: float
    plate: Plate = USUAL

    @property
    def zones(self) -> Mapping[str, int]:
        """The zones that its cuts state."""
        return {cut.contour: cut.zone for cut in self.cuts if cut.zone}


def measure_nest(
    nest: Nest, cuts: CutSequence | None, long_ratio: float, web_mm: float, plate: Plate = USUAL
) -> MeasuredNest:
    """What there is to measure; without cuts no zone is known."""
    return MeasuredNest(nest, cuts or CutSequence(()), long_ratio, web_mm, plate)


def is_long(m: MeasuredNest) -> list[bool]:
    """Outer contours whose smallest rectangle has one side at least `long_ratio` times the other (Petunin 2009)."""
    sides = rectangles_mm(m.nest)
    slim = sides.max(axis=1) >= m.long_ratio * sides.min(axis=1) * (1 - 1e-9)
    return [bool(s) and c.kind == "outer" for s, c in zip(slim, m.nest.contours, strict=True)]


def hosts(m: MeasuredNest) -> list[str]:
    """Id of the part in whose hole a contour's part lies, "" for none."""
    of_part = host_holes(m.nest)
    return [of_part[c.part].part if c.part in of_part else "" for c in m.nest.contours]


def depths(m: MeasuredNest) -> list[int]:
    """How many contours lie around every contour."""
    host = host_holes(m.nest)

    def of_part(part: str) -> int:
        depth = 0
        while part in host:
            part, depth = host[part].part, depth + 2
        return depth

    return [of_part(c.part) + (c.kind not in ("outer", "scrap")) for c in m.nest.contours]


def neighbour_counts(m: MeasuredNest) -> list[int]:
    """How many other parts in the same place come as near as `web_mm` to each outer contour; 0 for holes and marks."""
    at = places(m.nest, host_holes(m.nest))
    return count_near(m.nest, [at[part.id] for part in m.nest.parts], m.web_mm)


def count_near(nest: Nest, place: Sequence[object], web_mm: float) -> list[int]:
    """For every contour the number of other parts of the same place within `web_mm`; `place` is given part by part."""
    lines = [part.outer.line for part in nest.parts]
    a, b = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=web_mm + ROUNDING_MM)
    count = [0] * len(nest.contours)
    for first, second in zip(a.tolist(), b.tolist(), strict=True):
        if first != second and place[first] == place[second]:
            count[nest.index[nest.parts[first].outer.id]] += 1
    return count


def zones(m: MeasuredNest) -> list[int | None]:
    """The zone that the cut of every contour states, None where it states none."""
    stated = m.zones
    return [stated.get(c.id) for c in m.nest.contours]


def attributes(nest: Nest, name: str) -> list[Any]:
    """What the nest's file says of every contour's part under that name, None where it says nothing.

    Where no part says anything under the very name, CAPITALS and small letters are the same: blocks write NO and Order.
    """
    key = name
    if not any(name in part.attributes for part in nest.parts):
        alike = (other for part in nest.parts for other in part.attributes if other.lower() == name.lower())
        key = next(alike, name)
    return [nest.part_of[c.part].attributes.get(key) if c.part else None for c in nest.contours]


# The facts that selectors of own rules may name: one table for reading, messages, schema and docs.
#
# Every fact has two columns. `of_facts` takes it from the facts that plans are made with; `of_nest` measures it from
# the nest, for the check. For a contour's own measures (its name, its size) both are the same geometry.

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
    of_plate: Callable[[Nest, Plate], Values] | None = None


def _plated(name: str, kind: ValueKind, help: str, of: Callable[[Nest, Plate], Values]) -> NamedFact:
    """A measure of a contour, or of all, on the plate that the profile is for."""
    return NamedFact(name, kind, help, lambda facts: (), lambda m: (), of)


def _own(name: str, kind: ValueKind, help: str, of: Callable[[Nest], Values]) -> NamedFact:
    """A measure of a contour by itself."""
    return NamedFact(name, kind, help, lambda facts: of(facts.nest), lambda m: of(m.nest))


def _edge_gap(side: str, column: int) -> NamedFact:
    return NamedFact(
        f"{side}_gap_mm",
        LENGTHS,
        f"distance from the {side} side of the sheet",
        lambda facts: [float(v) for v in facts.edge_gap_mm[:, column]],
        lambda m: edge_gaps_mm(m.nest, side),
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
    return count_near(facts.nest, place, facts.options.web_mm)


_TABLE = (
    _own("kind", word_kind(CONTOUR_KINDS), "what the contour is", lambda n: [c.kind for c in n.contours]),
    _own("part", TEXTS, "id of its part, empty for a scrap line", lambda n: [c.part for c in n.contours]),
    _own(
        "id",
        TEXTS,
        "its own id, `<part>.outer`, `<part>.hole1` …, `scrap1` …",
        lambda n: [c.id for c in n.contours],
    ),
    _own("layer", TEXTS, "its layer in the drawing", lambda n: [c.source.layer for c in n.contours]),
    _own("colour", TEXTS, "its colour there, a name or #rrggbb", lambda n: [c.source.colour for c in n.contours]),
    _own(
        "block",
        TEXTS,
        "the blocks that it lies in there, outermost first, as in `PANEL/HINGE`",
        lambda n: [c.source.block for c in n.contours],
    ),
    _own("text", TEXTS, "the writing that a mark is a stroke of", lambda n: [c.source.text for c in n.contours]),
    _own(
        "quantity",
        COUNTED,
        "how many of its part are wanted, by the name of its block, its layer or the file",
        lambda n: attributes(n, "quantity"),
    ),
    _own("area_mm2", AREAS, "area inside it, 0 for an open line", areas_mm2),
    _own("length_mm", LENGTHS, "its length", lengths_mm),
    _own("width_mm", LENGTHS, "its extent along x", lambda n: sizes_mm(n, 0)),
    _own("height_mm", LENGTHS, "its extent along y", lambda n: sizes_mm(n, 1)),
    _own(
        "short_side_mm",
        LENGTHS,
        "shorter side of the smallest rectangle around it, at any angle",
        lambda n: rectangle_sides_mm(n, longer=False),
    ),
    _own("long_side_mm", LENGTHS, "longer side of that rectangle", lambda n: rectangle_sides_mm(n, longer=True)),
    NamedFact(
        "long",
        FLAGS,
        "an outer contour whose longer side is at least `long_ratio` (rule start-side) times the shorter",
        lambda facts: [bool(v) for v in facts.long],
        is_long,
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
        lambda m: edge_gaps_mm(m.nest, "edge"),
    ),
    _own("x_mm", LENGTHS, "x of its middle, as it is drawn", lambda n: middles_mm(n, 0)),
    _own("y_mm", LENGTHS, "y of its middle, as it is drawn", lambda n: middles_mm(n, 1)),
    _own("corner_distance_mm", LENGTHS, "from the sheet's lower left corner to its middle", corner_distances_mm),
    _plated("cut_s", SECONDS, "what it takes to pierce and cut it, without leads and travel", cut_seconds),
    _plated("weight_kg", KILOGRAMS, "weight of its part: area, thickness, density", weights_kg),
    _plated("thickness_mm", LENGTHS, "thickness of the sheet", lambda n, p: [p.thickness_mm] * len(n.contours)),
    _plated("material", TEXTS, "grade of the sheet", lambda n, p: [p.material] * len(n.contours)),
    _plated("process", TEXTS, "what cuts: plasma, laser, oxyfuel…", lambda n, p: [p.process] * len(n.contours)),
    NamedFact("depth", COUNTED, "how many contours lie around it, 0 for a part on the sheet", _depths, depths),
    NamedFact("host", TEXTS, "id of the part in whose hole its part lies, empty for none", _hosts, hosts),
    NamedFact(
        "hosted",
        FLAGS,
        "whether its part lies in a hole of another part",
        lambda facts: [host != "" for host in _hosts(facts)],
        lambda m: [host != "" for host in hosts(m)],
    ),
    NamedFact(
        "neighbours_count",
        COUNTED,
        "of an outer contour: other parts in the same place no further off than 25 mm",
        _neighbour_counts,
        neighbour_counts,
    ),
    NamedFact(
        "zone",
        COUNTED,
        "zone in which it is cut, from 1",
        lambda facts: facts.zone.tolist(),
        lambda m: zones(m),
    ),
)

NAMED_FACTS: Mapping[str, NamedFact] = {fact.name: fact for fact in _TABLE}


def named_fact(name: str) -> NamedFact | None:
    """The fact of that name, `attribute.<anything>` included; None for an unknown one."""
    if name.startswith(ATTRIBUTE) and name != ATTRIBUTE:
        key = name.removeprefix(ATTRIBUTE)
        return _own(name, FREE, f"what the nest says under {key!r}", lambda n: attributes(n, key))
    return NAMED_FACTS.get(name)


NC_ROUNDING_MM = 0.05
"""A point this near to a limit is on either side of it: programs round their coordinates."""


class KnownFacts:
    """The values of named facts for every contour of one nest, computed when first asked for, and the ways to cut.

    `ways` are the candidates, or the cuts that are judged, each with the number of its contour. Points of theirs are
    known to `slack_mm`. A program that is `resumed` goes on after a stop.
    """

    def __init__(
        self,
        nest: Nest,
        plate: Plate,
        values: Callable[[NamedFact], Values],
        ways: Sequence[tuple[int, Cut | Candidate]],
        slack_mm: float,
        resumed: bool,
    ) -> None:
        self.nest, self.plate, self._values = nest, plate, values
        self.ways, self.slack_mm, self.resumed = ways, slack_mm, resumed
        self._found: dict[str, Values] = {}

    def values(self, name: str) -> Values:
        """The fact of that name, contour by contour."""
        if name not in self._found:
            fact = named_fact(name)
            assert fact is not None, name
            of = fact.of_plate
            self._found[name] = self._values(fact) if of is None else of(self.nest, self.plate)
        return self._found[name]


def facts_values(facts: Facts, plate: Plate = USUAL) -> KnownFacts:
    """Values as plans are made with."""
    ways = [(c.contour, c) for c in facts.candidates]
    return KnownFacts(facts.nest, plate, lambda fact: fact.of_facts(facts), ways, 0.0, bool(facts.already_cut))


def nest_values(m: MeasuredNest) -> KnownFacts:
    """Values as the check measures them."""
    ways = [(m.nest.index.get(cut.contour, -1), cut) for cut in m.cuts]
    return KnownFacts(m.nest, m.plate, lambda fact: fact.of_nest(m), ways, NC_ROUNDING_MM, m.cuts.made > 0)
