"""Which contours an own rule is about: selectors over named facts, and how far it reaches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import yaml

from kerfwise.encoder.nearest_name import unknown
from kerfwise.rules.options.kind import Choice, OptionKind, Unfit
from kerfwise.rules.options.yaml_positions import Problems, entries, is_empty, shape

from .criteria import Criterion, none_has
from .known_nest import ATTRIBUTE, NAMED_FACTS, KnownNest, named_fact

NOT = "not"


@dataclass(frozen=True, slots=True)
class Selector:
    """The contours that meet every criterion, less those that `excluded` selects; without criteria, all.

    Examples
    --------
    >>> from kerfwise.rules.own.criteria import Pattern
    >>> from kerfwise.rules.own.known_nest import MeasuredNest
    >>> from kerfwise.rules.case import nest, part, rect
    >>> plate = nest(100, 100, part("P1", rect(10, 10, 80, 80), [rect(30, 30, 20, 20)]))
    >>> known = MeasuredNest(plate, None, long_ratio=4, web_mm=25)
    >>> Selector((("kind", Pattern("hole")),)).chosen(known)
    (0,)
    """

    criteria: tuple[tuple[str, Criterion], ...] = ()
    excluded: Selector | None = None

    def chosen(self, known: KnownNest) -> tuple[int, ...]:
        """Numbers of the contours selected, ascending."""
        columns = [(criterion, known.values(name)) for name, criterion in self.criteria]
        out = set(self.excluded.chosen(known)) if self.excluded else set()
        return tuple(
            k
            for k in range(len(known.nest.contours))
            if k not in out and all(criterion.met(column[k]) for criterion, column in columns)
        )

    def why_nothing(self, known: KnownNest) -> str:
        """Why it selects no contour: what is asked of a fact that no contour has, and what there is.

        Examples
        --------
        >>> from kerfwise.rules.own.criteria import Pattern
        >>> from kerfwise.rules.own.known_nest import MeasuredNest
        >>> from kerfwise.rules.case import nest, part, rect
        >>> plate = MeasuredNest(nest(100, 100, part("P1", rect(10, 10, 80, 80))), None, long_ratio=4, web_mm=25)
        >>> Selector((("kind", Pattern("hole")),)).why_nothing(plate)
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


def groups(known: KnownNest, scope: str) -> list[tuple[int, ...]]:
    """Contour numbers group by group; a contour without a value for the scope is in none.

    Examples
    --------
    >>> from kerfwise.rules.own.known_nest import MeasuredNest
    >>> from kerfwise.rules.case import nest, part, rect
    >>> two = part("A", rect(10, 10, 80, 80), [rect(30, 30, 20, 20)]), part("B", rect(110, 10, 80, 80))
    >>> plate = nest(300, 100, *two)
    >>> groups(MeasuredNest(plate, None, long_ratio=4, web_mm=25), "part")
    [(0, 1), (2,)]
    """
    if scope == "sheet":
        return [tuple(range(len(known.nest.contours)))]
    found: dict[str, list[int]] = {}
    for k, value in enumerate(known.values(scope)):
        if value is not None:
            found.setdefault(str(value), []).append(k)
    return [tuple(members) for members in found.values()]
