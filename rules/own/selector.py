"""Selectors: which contours an own rule is about."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import yaml

from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, entries, is_empty, shape

from .criterion import Criterion
from .named_facts import ATTRIBUTE, NAMED_FACTS, KnownFacts, named_fact

NOT = "not"


@dataclass(frozen=True, slots=True)
class Selector:
    """The contours that meet every criterion, less those that `excluded` selects; without criteria, all.

    Examples
    --------
    >>> from kerfwise.rules.own.criterion import Pattern
    >>> from kerfwise.rules.own.named_facts import known_of_nest
    >>> from kerfwise.rules.own.measures import measured
    >>> from kerfwise.encoder.by_hand import nest, part, rect
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

    def names(self) -> set[str]:
        """The facts that it looks at."""
        return {name for name, _ in self.criteria} | (self.excluded.names() if self.excluded else set())

    def plain(self) -> dict[str, object]:
        """The YAML data that reads back as this selector."""
        made = {name: criterion.plain() for name, criterion in self.criteria}
        return made | ({NOT: self.excluded.plain()} if self.excluded else {})


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
