"""Own rules that keep contours apart in time: apart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import shapely
import yaml

from kerfwise.encoder.cut import CutSequence
from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.option import option, options_of
from kerfwise.rules.options.plain_values import Number
from kerfwise.rules.options.quantities import DURATION, LENGTH
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, entries
from kerfwise.rules.statements import Lag

from .criterion import ROUNDING_MM
from .demand import Ask, Breach, Chosen
from .selector import Selector, read_selector

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

FROM = "from"
_CLOCK_S = 0.05


@dataclass(frozen=True, slots=True)
class Apart(Ask):
    """Between any two of the selected, or a selected and one of `other`, lie some cuts or seconds."""

    KEYS = {"apart": "between two selected contours lie other cuts, or seconds: {cuts, time, within, from}"}  # noqa: RUF012

    cuts: int = field(default=0, metadata=option(Number(0, whole=True), "how many other cuts lie between at least"))
    time_s: float = field(default=0.0, metadata=option(DURATION, "how much time lies between at least"))
    within_mm: float | None = field(
        default=None, metadata=option(LENGTH, "asked only of contours that lie no further apart than this")
    )
    other: Selector | None = None

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> Apart:
        options = {o.key: o for o in options_of(cls)}
        given: dict[str, Any] = {}
        so_far = len(problems.found)
        for name, key_node, value in entries(node, problems, what):
            if name == FROM:
                given["other"] = read_selector(value, problems, f"{what}.{FROM}")
            elif name not in options:
                problems.add(key_node, f"{what}: {unknown('key', name, [*options, FROM])}")
            else:
                try:
                    given[options[name].name] = options[name].kind.read(value)
                except Unfit as error:
                    problems.add(value, f"{what}.{name}: {error}")
        if len(problems.found) == so_far and not (given.get("cuts") or given.get("time_s")):
            problems.add(node, f"{what}: say how far apart: cuts, time or both, such as {{cuts: 2}}")
        return Apart(**given)

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        keys = {o.key: {"description": o.help, **o.kind.schema()} for o in options_of(cls)}
        return {
            "type": "object",
            "properties": {**keys, FROM: {"$ref": "#/$defs/selector"}},
            "additionalProperties": False,
            "anyOf": [{"required": ["cuts"]}, {"required": ["time"]}],
        }

    def plain(self) -> tuple[str, object]:
        made: dict[str, object] = {}
        if self.cuts:
            made["cuts"] = self.cuts
        if self.time_s:
            made["time"] = DURATION.write(self.time_s)
        if self.within_mm is not None:
            made["within"] = LENGTH.write(self.within_mm)
        return "apart", made | ({FROM: self.other.plain()} if self.other else {})

    def selectors(self) -> tuple[Selector, ...]:
        return (self.other,) if self.other else ()

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[Lag]:
        for a, b in self._couples(chosen):
            first, second = chosen.ids(a, b)
            about = chosen.about((a, b), f"between {first} and {second} lie {self._asked()}")
            yield Lag(a, b, about, self.cuts, self.time_s)

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        at = cuts.positions()
        for couple in self._couples(chosen):
            if any(name not in at for name in chosen.ids(*couple)):
                continue
            first, then = sorted(chosen.ids(*couple), key=at.__getitem__)
            between = at[then] - at[first] - 1
            waited_s = cuts[at[then] - 1].start_s - cuts[at[first] - 1].end_s
            if between >= self.cuts and waited_s >= self.time_s - _CLOCK_S:
                continue
            seconds = f" and {waited_s:.1f} s" if self.time_s else ""
            text = (
                f"between {first} (cut {at[first]}) and {then} (cut {at[then]}) lie {between} cuts{seconds}, "
                f"not {self._asked()}"
            )
            yield (first, then), text, (at[first], at[then])

    def unjudged(self, cuts: CutSequence) -> str | None:
        if self.time_s and not any(cut.end_s for cut in cuts):
            return "the times of the cuts are not stated"
        return None

    def _asked(self) -> str:
        parts = [f"{self.cuts} cuts"] * bool(self.cuts) + [f"{self.time_s:g} s"] * bool(self.time_s)
        return f"at least {' and '.join(parts)}"

    def _couples(self, chosen: Chosen) -> list[tuple[int, int]]:
        """Each pair of contours once, by number."""
        others = set(self.other.chosen(chosen.known)) if self.other else None
        lines = [c.line for c in chosen.nest.contours]
        found: set[tuple[int, int]] = set()
        for selected, group in chosen.groups:
            partners = selected if others is None else tuple(k for k in group if k in others)
            if self.within_mm is None:
                chosen.check_size(len(selected) * len(partners))
                near = [(a, b) for a in selected for b in partners]
            else:
                tree = shapely.STRtree([lines[k] for k in partners])
                reach = self.within_mm + ROUNDING_MM
                hits = tree.query([lines[k] for k in selected], predicate="dwithin", distance=reach)
                near = [(selected[a], partners[b]) for a, b in hits.T.tolist()]
            found.update((min(a, b), max(a, b)) for a, b in near if a != b)
        chosen.check_size(len(found))
        return sorted(found)
