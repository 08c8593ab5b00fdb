"""Own rules that order contours: before, after, first, last."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import yaml

from kerfwise.encoder.cut import CutSequence
from kerfwise.rules.options.yaml_positions import Problems
from kerfwise.rules.statements import Precede

from .demand import Ask, Breach, Chosen, read_true
from .selector import Selector, read_selector

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


@dataclass(frozen=True, slots=True)
class OrderAsk(Ask):
    """`key` is one of `KEYS`; `other` whom the selected come before or after, None for first and last."""

    KEYS = {  # noqa: RUF012
        "before": "every selected contour is cut before every contour of this selector",
        "after": "every selected contour is cut after every contour of this selector",
        "first": "true: the selected contours are cut before all others",
        "last": "true: the selected contours are cut after all others",
    }

    key: str
    other: Selector | None = None

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> OrderAsk:
        if key in ("before", "after"):
            return OrderAsk(key, read_selector(node, problems, what))
        read_true(node, problems, what)
        return OrderAsk(key)

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        return {"$ref": "#/$defs/selector"} if key in ("before", "after") else {"const": True}

    def plain(self) -> tuple[str, object]:
        return self.key, self.other.plain() if self.other else True

    def selectors(self) -> tuple[Selector, ...]:
        return (self.other,) if self.other else ()

    def pairs(self, chosen: Chosen) -> list[tuple[int, int]]:
        others = set(self.other.chosen(chosen.known)) if self.other else None
        sides = []
        for selected, members in chosen.groups:
            inside = set(selected)
            rest = [k for k in members if (k not in inside if others is None else k in others)]
            sides.append((selected, rest) if self.key in ("before", "first") else (rest, selected))
        chosen.check_size(sum(len(first) * len(then) for first, then in sides))
        return [(a, b) for first, then in sides for a in first for b in then if a != b]

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[Precede]:
        for a, b in self.pairs(chosen):
            first, then = chosen.ids(a, b)
            yield Precede(a, b, chosen.about((a, b), f"{first} is cut before {then}"))

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        at = cuts.positions()
        for a, b in self.pairs(chosen):
            first, then = chosen.ids(a, b)
            if first in at and then in at and at[first] > at[then]:
                text = f"{first} (cut {at[first]}) must be cut before {then} (cut {at[then]})"
                yield (first, then), text, (at[then], at[first])
