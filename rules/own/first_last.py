"""Own rules about how a sheet, a part, a zone begins and ends: not_first, not_last."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import yaml

from kerfwise.encoder.cut import CutSequence
from kerfwise.rules.options.yaml_positions import Problems
from kerfwise.rules.statements import AtLeast, Before

from .demand import Ask, Breach, Chosen, read_true

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


@dataclass(frozen=True, slots=True)
class Ends(Ask):
    """`key` says which end. Where a group holds only selected contours nothing can be asked of it."""

    KEYS = {  # noqa: RUF012
        "not_first": "true: cutting does not begin with a selected contour",
        "not_last": "true: cutting does not end with a selected contour",
    }

    key: str

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> Ends:
        read_true(node, problems, what)
        return Ends(key)

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        return {"const": True}

    def plain(self) -> tuple[str, object]:
        return self.key, True

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[AtLeast]:
        chosen.check_size(sum(len(selected) * (len(group) - len(selected)) for selected, group in chosen.groups))
        for selected, rest in _asked(chosen):
            for k in selected:
                (name,) = chosen.ids(k)
                if self.key == "not_last":
                    literals, what = tuple(Before(k, other) for other in rest), "not the last to be cut"
                else:
                    literals, what = tuple(Before(other, k) for other in rest), "not the first to be cut"
                yield AtLeast(literals, (1,) * len(rest), 1, chosen.about((k,), f"{name} is {what}"))

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        at = cuts.positions()
        for selected, rest in _asked(chosen):
            places = {at[name]: name for name in chosen.ids(*selected, *rest) if name in at}
            if not places:
                continue
            if self.key == "not_last" and all(at.get(name, 0) <= cuts.made for name in chosen.ids(*rest)):
                continue  # nothing else is left of the group
            position = max(places) if self.key == "not_last" else min(places)
            name = places[position]
            if name in chosen.ids(*selected):
                end = "the last" if self.key == "not_last" else "the first"
                yield (name,), f"{name} (cut {position}) must not be {end}", (position,)


def _asked(chosen: Chosen) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Group by group the selected contours and the others, where there are both."""
    for selected, group in chosen.groups:
        inside = set(selected)
        rest = tuple(k for k in group if k not in inside)
        if selected and rest:
            yield selected, rest
