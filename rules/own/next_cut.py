"""Own rules about what is cut directly after what: next."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import yaml

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.text import unknown
from kerfwise.rules.options.kind import Text, Unfit
from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.options.yaml_positions import Problems, entries
from kerfwise.rules.statements import Move

from .constraint import Breach, Chosen, Constraint
from .criteria import LENGTHS, ROUNDING_MM, number_of
from .selector import ATTRIBUTE, NAMED_FACTS, Selector, named_fact, read_selector

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

DIRECTION = "direction"
"""The one thing beside facts that two cuts can have alike: the way round."""
FORMS = {
    "same": "the fact that both have alike, or direction",
    "differs": "the fact that the two do not have alike, or direction",
    "to": "what may follow a selected contour: a selector",
    "never": "what may not follow a selected contour: a selector",
}
WITHIN = "within"
MOST_SHOWN = 4


@dataclass(frozen=True, slots=True)
class NextCut(Constraint):
    """What directly follows a selected contour, within each group; `form` is one of `FORMS`.

    Of `same` and `differs` both cuts are selected, and `fact` is known of both. With `within_mm`, lengths that differ
    by no more are the same. Of `to` and `never` the second may be any contour of the group.
    """

    KEYS = {"next": "which contour may directly follow a selected one: {same, differs, to, never, within}"}  # noqa: RUF012

    form: str
    fact: str = ""
    within_mm: float = 0.0
    other: Selector | None = None

    @classmethod
    def read(cls, key: str, node: yaml.Node, problems: Problems, what: str) -> NextCut:
        values: dict[str, Any] = {}
        so_far = len(problems.found)
        for name, key_node, value in entries(node, problems, what):
            if name not in FORMS and name != WITHIN:
                problems.add(key_node, f"{what}: {unknown('key', name, [*FORMS, WITHIN])}")
            elif name in FORMS and "form" in values:
                problems.add(key_node, f"{what}: a rule asks one thing, this one asks {values['form']} and {name}")
            elif name in ("to", "never"):
                values |= {"form": name, "other": read_selector(value, problems, f"{what}.{name}")}
            elif name == WITHIN:
                try:
                    values["within_mm"] = LENGTH.read(value)
                except Unfit as error:
                    problems.add(value, f"{what}.{name}: {error}")
            else:
                values |= {"form": name, "fact": _fact(value, problems, f"{what}.{name}")}
        if len(problems.found) == so_far:
            if "form" not in values:
                problems.add(node, f"{what}: say what may follow: one of {', '.join(FORMS)}, such as {{same: layer}}")
            elif "within_mm" in values and not _is_length(values.get("fact", "")):
                problems.add(node, f"{what}.{WITHIN}: only lengths such as y_mm, and attributes, are nearly the same")
        return NextCut(**{"form": "same", **values})

    @classmethod
    def schema(cls, key: str) -> dict[str, Any]:
        fact = {
            "anyOf": [
                {"enum": [DIRECTION, *NAMED_FACTS]},
                {"type": "string", "pattern": r"^attribute\..+"},
            ]
        }
        some = {"$ref": "#/$defs/selector"}
        kinds: dict[str, dict[str, Any]] = {"same": fact, "differs": fact, "to": some, "never": some}
        keys = {name: {"description": help, **kinds[name]} for name, help in FORMS.items()}
        within = {"description": "lengths that differ by no more are the same", **LENGTH.schema()}
        return {
            "type": "object",
            "properties": {**keys, WITHIN: within},
            "additionalProperties": False,
            "oneOf": [{"required": [name]} for name in FORMS],
        }

    def plain(self) -> tuple[str, object]:
        result: dict[str, object] = {self.form: self.other.plain() if self.other else self.fact}
        if self.within_mm:
            result[WITHIN] = LENGTH.write(self.within_mm)
        return "next", result

    def selectors(self) -> tuple[Selector, ...]:
        return (self.other,) if self.other else ()

    def facts(self) -> set[str]:
        return {self.fact} - {"", DIRECTION}

    def statements(self, facts: Facts, chosen: Chosen) -> Iterator[Move]:
        if self.fact != DIRECTION:
            for leave, reach, words in self._sides(chosen):
                yield Move(leave, reach, chosen.about(tuple(dict.fromkeys((*leave, *reach))), words))
            return
        by: dict[str, set[int]] = defaultdict(set)
        for c, candidate in enumerate(facts.candidates):
            by[candidate.direction].add(c)
        for selected, _ in chosen.groups:
            for one, other in product(sorted(by), repeat=2):
                if (one == other) != (self.form == "same"):
                    about = chosen.about(selected, f"what is cut {other} does not directly follow what is cut {one}")
                    yield Move(selected, selected, about, None, frozenset(by[one]), frozenset(by[other]))

    def _sides(self, chosen: Chosen) -> Iterator[tuple[tuple[int, ...], tuple[int, ...], str]]:
        """Contours, those that may not directly follow them, and what may in words."""
        for selected, group in chosen.groups:
            if self.other is not None:
                wanted = set(self.other.chosen(chosen.known))
                reach = tuple(k for k in group if (k in wanted) == (self.form == "never"))
                if reach:
                    yield selected, reach, self._words(", ".join(chosen.ids(*selected[:MOST_SHOWN])))
                continue
            values = chosen.known.values(self.fact)
            known = [k for k in selected if values[k] is not None]
            alike: dict[object, list[int]] = defaultdict(list)
            for k in known:
                alike[values[k]].append(k)
            for value, members in alike.items():
                near = {k for k in known if self._alike(value, values[k])}
                reach = tuple(k for k in known if (k in near) == (self.form == "differs"))
                if set(reach) - set(members) or len(members) > len(reach) > 0 or len(reach) > 1:
                    yield tuple(members), reach, self._words(f"{self.fact} {value}")

    def _words(self, leave: str) -> str:
        near = f" to {self.within_mm:g} mm" if self.within_mm else ""
        if self.other is None:
            return f"what directly follows {leave} has {'the same' if self.form == 'same' else 'another'}{near}"
        words = " and ".join(f"{name} {value}" for name, value in self.other.plain().items()) or "any contour"
        return f"what directly follows {leave} is {'not ' if self.form == 'never' else ''}of {words}"

    def _alike(self, one: Any, other: Any) -> bool:
        first, second = number_of(one), number_of(other)
        if self.within_mm and first is not None and second is not None:
            return abs(first - second) <= self.within_mm + ROUNDING_MM
        return bool(one == other)

    def broken(self, cuts: CutSequence, chosen: Chosen) -> Iterator[Breach]:
        index, at = chosen.nest.index, cuts.positions()
        refused: dict[int, set[int]] = defaultdict(set)
        group_of = {k: g for g, (selected, _) in enumerate(chosen.groups) for k in selected}
        for leave, reach, _ in () if self.fact == DIRECTION else self._sides(chosen):
            for k in leave:
                refused[k].update(reach)
        for one, other in _steps(cuts):
            i, j = index.get(one.contour, -1), index.get(other.contour, -1)
            if self.fact == DIRECTION:
                together = i in group_of and group_of[i] == group_of.get(j)
                wrong = together and (one.direction == other.direction) != (self.form == "same")
            else:
                wrong = i != j and j in refused.get(i, ())
            if wrong:
                first, then = at[one.contour], at[other.contour]
                what = f", {one.direction} and then {other.direction}" if self.fact == DIRECTION else ""
                text = f"{other.contour} (cut {then}) must not directly follow {one.contour} (cut {first}){what}"
                yield (one.contour, other.contour), text, (first, then)


def _steps(cuts: CutSequence) -> Iterator[tuple[Cut, Cut]]:
    """Cuts that directly follow each other, what several torches cut together each with each; not over a stop."""
    moments = cuts.moments()
    cut_names = {cut.contour for cut in cuts[: cuts.made]}
    of_moment: dict[int, list[Cut]] = defaultdict(list)
    for cut in cuts:
        of_moment[moments[cut.contour]].append(cut)
    for moment in sorted(of_moment):
        for one in of_moment[moment]:
            for other in of_moment.get(moment + 1, ()):
                if (one.contour in cut_names) == (other.contour in cut_names):
                    yield one, other


def _fact(node: yaml.Node, problems: Problems, what: str) -> str:
    try:
        name = str(Text().read(node))
    except Unfit as error:
        problems.add(node, f"{what}: {error}")
        return ""
    if name != DIRECTION and named_fact(name) is None:
        problems.add(node, f"{what}: {unknown('fact', name, [DIRECTION, *NAMED_FACTS, f'{ATTRIBUTE}<name>'])}")
        return ""
    return name


def _is_length(name: str) -> bool:
    return name.startswith(ATTRIBUTE) or (name in NAMED_FACTS and NAMED_FACTS[name].kind is LENGTHS)
