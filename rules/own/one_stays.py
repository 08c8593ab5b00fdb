"""Own rules that leave one contour in to hold the others: one_stays_while."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import yaml

from kerfwise.encoder.cut import CutSequence
from kerfwise.rules.options.yaml_positions import Problems
from kerfwise.rules.statements import NoGood

from .demand import Ask, Breach, Chosen
from .selector import Selector, read_selector

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


@dataclass(frozen=True, slots=True)
class OneStays(Ask):
    """As long as all of `held` are still in, at least one of the selected is too."""

    KEYS = {"one_stays_while": "one of the selected is left in as long as all of this selector are in"}  # noqa: RUF012

    MINDS_WHAT_IS_OUT = True

    held: Selector

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> OneStays:
        return OneStays(read_selector(node, problems, what))

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        return {"$ref": "#/$defs/selector"}

    def plain(self) -> tuple[str, object]:
        return "one_stays_while", self.held.plain()

    def selectors(self) -> tuple[Selector, ...]:
        return (self.held,)

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[NoGood]:
        for out, left in self._sets(chosen):
            text = f"{_listed(chosen.ids(*out))} are not all cut while {_listed(chosen.ids(*left))} stay in"
            yield NoGood(frozenset(out), frozenset(left), chosen.about((*out, *left), text))

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        at = cuts.positions()
        for out, left in self._sets(chosen):
            out_at = [at.get(name, len(cuts) + 1) for name in chosen.ids(*out)]
            first_left = min(at.get(name, len(cuts) + 1) for name in chosen.ids(*left))
            if max(out_at) < first_left:
                ids = chosen.ids(*out)
                text = f"{_listed(ids)} are all cut (cut {max(out_at)}) while {_listed(chosen.ids(*left))} are still in"
                yield (*ids, *chosen.ids(*left)), text, tuple(sorted(out_at))

    def _sets(self, chosen: Chosen) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
        held = set(self.held.chosen(chosen.known))
        for selected, group in chosen.groups:
            left = tuple(k for k in group if k in held and k not in selected)
            if selected and left:
                yield selected, left


def _listed(ids: tuple[str, ...]) -> str:
    return ", ".join(ids) if len(ids) <= 6 else f"{ids[0]} … {ids[-1]}"
