"""Own rules that keep contours together: together."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import yaml

from kerfwise.encoder.cut import CutSequence
from kerfwise.rules.options.yaml_positions import Problems
from kerfwise.rules.statements import Contiguous

from .demand import Ask, Breach, Chosen, read_true

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


@dataclass(frozen=True, slots=True)
class Together(Ask):
    """The selected contours of each group make one run of cuts."""

    KEYS = {"together": "true: the selected contours follow each other without another between"}  # noqa: RUF012

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> Together:
        read_true(node, problems, what)
        return Together()

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        return {"const": True}

    def plain(self) -> tuple[str, object]:
        return "together", True

    def together(self, chosen: Chosen) -> list[tuple[int, ...]]:
        return [selected for selected, _ in chosen.groups if len(selected) > 1]

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[Contiguous]:
        for run in self.together(chosen):
            ids = chosen.ids(*run)
            listed = ", ".join(ids) if len(ids) <= 6 else f"{ids[0]} … {ids[-1]}"
            yield Contiguous(run, chosen.about(run, f"{listed} follow each other"))

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        at = cuts.positions()
        for run in self.together(chosen):
            places = sorted(at[name] for name in chosen.ids(*run) if at.get(name, 0) > cuts.made)
            for a, b in pairwise(places):
                if b == a + 1:
                    continue
                before, stranger, after = (cuts[k - 1].contour for k in (a, a + 1, b))
                text = f"{stranger} (cut {a + 1}) comes between {before} (cut {a}) and {after} (cut {b})"
                yield (before, stranger, after), text, (a, a + 1, b)
                break
