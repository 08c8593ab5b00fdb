"""A rule whose text is a model file in MiniZinc, as a rule like any other."""

from __future__ import annotations

import dataclasses
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field, make_dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.minizinc_data import Fields, assignments
from kerfwise.encoder.nearest_name import nearest
from kerfwise.encoder.nest import Ids, Nest
from kerfwise.rules.expression.node import MOST_TOLD, Lit, Node, contours_of, orders
from kerfwise.rules.expression.over_cuts import sums_of_ids
from kerfwise.rules.minizinc.twin import Further, TwinCase, twin_of
from kerfwise.rules.options.kind import Flag, Number, OptionKind, Text
from kerfwise.rules.options.option import NoOptions, option
from kerfwise.rules.own.known_nest import attributes
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import USUAL, Rule, RuleFile, Strength, SumOfIds, Violation
from kerfwise.rules.statements import Statement

from .model_file import ModelFile, Parameter, files_read, read_model_file, states, whole_text, without_comments
from .nest_data import Limits, further_words, measured_data, missing, order_data, orders_data, unknown_words

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import FactOptions, Facts

    from .flatten import Flattened, JudgedOrder


_MARKS = (
    *("strengths", "default", "default_weight", "gives_way"),
    *("excusable", "relaxable", "relaxed_last", "hard_with_head_down", "of_whole_nest", "minds_what_is_out"),
    *("of_fallen_metal", "shares"),
    *("together", "excuse", "exempt", "allowances", "lead_options", "check_with"),
)
"""What a rule takes over from the one whose place it takes: marks, and hooks that its file says nothing of."""


OF_CUTS = frozenset({"zone", "level_ahead", "start_side", "picked", "pick", "ways", "CANDIDATE", "HEAD", "TAIL"})
"""Words that mean nothing before there are cuts."""
MOST_CONTOURS = 2000
"""Relations between contours are square tables in MiniZinc's data."""


class ModelRule(Rule[Any]):
    """The rule in `file`. Where it is named as a rule of the catalogue, it takes that rule's place: `replaces` is it.

    `strength` is the one that the profile gives it: what a breach of a soft rule costs must not be split.
    """

    Options = NoOptions
    must_be_judged = True

    def __init__(self, file: ModelFile, rule_id: str = "", strength: Strength = "hard") -> None:
        self.file, self.strength = file, strength
        self.id = rule_id or file.name
        self.replaces: Rule[Any] | None = RULES.get(self.id)
        self.sentence, self.source = file.sentence, file.source
        self.brought = f"file {file.path}"
        self.stands_in = RuleFile(file.path, file.sha256, self.replaces is not None)
        setattr(self, "Options", options_class(file.parameters))  # noqa: B010
        for mark in _MARKS if self.replaces is not None else ():
            setattr(self, mark, getattr(self.replaces, mark))
        if self.replaces is not None:
            setattr(self, "Options", options_in_place(self.replaces.Options, file.parameters))  # noqa: B010
        else:
            setattr(self, "of_whole_nest", True)  # noqa: B010
            setattr(self, "minds_zones", re.search(r"\bzone\b", whole_text(file)) is not None)  # noqa: B010

    def __eq__(self, other: object) -> bool:
        mine = (self.file, self.id, self.strength)
        return isinstance(other, ModelRule) and mine == (other.file, other.id, other.strength)

    def __hash__(self) -> int:
        return hash((self.file, self.id, self.strength))

    def page(self) -> str:
        """The sentence, where the rule stands, and the file's text without its cases."""
        place = f"It stands in `{self.file.path}`"
        if self.replaces is not None:
            place += f", in the place of the shipped rule `{self.replaces.id}`"
        text = re.split(r"^%\s*cases:\s*$", self.file.text, maxsplit=1, flags=re.M)[0].strip()
        return f"{self.sentence}\n\n{place}.\n\n```\n{text}\n```"

    def with_strength(self, strength: Strength) -> ModelRule:
        """The same rule with the strength that a profile gives it."""
        return ModelRule(self.file, self.id, strength)

    def expect_small(self, nest: Nest) -> None:
        """Refuse a nest whose square tables would be too large for MiniZinc.

        Raises InputError if it has more than `MOST_CONTOURS`.
        """
        if len(nest.contours) > MOST_CONTOURS:
            raise InputError(
                f"rule {self.id}: {nest.file or 'the nest'} has {len(nest.contours):,} contours, and rules in model "
                f"files bear {MOST_CONTOURS:,} at the most: set rules: {{{self.id}: off}}, or write the rule under "
                "own_rules or in Python",
                file=self.file.path,
            )

    def statements(self, facts: Facts, options: Any) -> Iterator[Statement]:
        """What the file says of the facts, kept as long as these live; by other zones it is the same.

        That is where the file does not name zones.
        """
        kept, key = _stated.setdefault(facts, {}), (self, options)
        if key not in kept and not self.minds_zones:
            alike = (of[key] for other, of in [*_stated.items()] if key in of and _same_but_for_zones(other, facts))
            kept.update((key, stated) for stated in alike)
        if key not in kept:
            kept[key] = self._read_anew(facts, options)
        yield from kept[key]

    def _expressed(self, statements: Iterator[Statement]) -> Iterator[Statement]:
        """The statements, asking after each whether there is time for more."""
        from kerfwise.rules.expression.to_statements import NotExpressible

        from .compiler import expect_in_time

        try:
            for statement in statements:
                expect_in_time(self.file.path)
                yield statement
        except NotExpressible as error:
            element = f"element {error.element} of {self.file.array}: " if error.element else ""
            raise InputError(f"rule {self.id}: {element}{error}", file=self.file.path, line=self.file.line) from None

    def _read_anew(self, facts: Facts, options: Any) -> tuple[Statement, ...]:
        from kerfwise.rules.expression.to_statements import Way, Writer

        from .flatten import flatten  # most runs have no rule in a file: they do without the reading of such

        self.expect_small(facts.nest)
        further = self.further(options)
        data = facts_data(facts) + assignments(self.data(facts, options)) + self.words(facts.nest, options)
        flat = flatten(
            self.file, data, facts.n, [c.contour for c in facts.candidates], tuple(array.name for array in further)
        )
        ways = [Way(c.contour, _way_words(c.entry, c.direction)) for c in facts.candidates]
        why = f"{self.sentence.rstrip('.')} ({self.file.place})"
        in_parts = self.strength != "soft" and not self.excusable
        writer = Writer(self.id, facts.nest, ways, why, in_parts, flat.about)
        says = [f"{text} ({self.file.place})" for text in flat.says]
        if flat.further and not in_parts:
            raise InputError(
                f"rule {self.id}: a constraint is always hard, and the rule is not: write it as an element of "
                f"{self.file.stem}_holds",
                file=self.file.path,
                line=self.file.bare or self.file.line,
            )
        stated = [*self._expressed(writer.written(flat.elements, says, flat.further))]
        for array, nodes in zip(further, flat.others, strict=True):
            one_by_one = dataclasses.replace(writer, in_parts=array.weight_mm is None and in_parts)
            for statement in self._expressed(one_by_one.written(nodes, (), ())):
                stated.append(dataclasses.replace(statement, weight=array.weight_mm))  # type: ignore[arg-type]
        return tuple(stated)

    def words(self, nest: Nest, options: Any) -> str:
        """MiniZinc text of the words beside the facts that the file names."""
        return further_words(nest, whole_text(self.file), getattr(options, "plate", USUAL))

    def data(self, facts: Facts, options: Any) -> Fields:
        """What the file reads beside the facts: that of the rule whose place it takes, or its parameters."""
        own = parameters_data(self.file, options)
        if self.replaces is None:
            return own
        return [*twin_of(self.replaces.id).data(TwinCase(facts, (0.0, 0.0)), options), *own]

    def further(self, options: Any) -> list[Further]:
        """Arrays of the rule whose place it takes that the file states beside its first, each at its own price.

        Raises InputError if that rule is asked for seconds, which stand in another file.
        """
        if self.replaces is None:
            return []
        from_twin = list(twin_of(self.replaces.id).further(options, None))
        if any(array.most_ms for array in from_twin):
            raise InputError(
                f"rule {self.id}: the profile asks for seconds, and its file cannot state them: ask for none in the "
                "profile, and for pause_ms(i, j) >= so many ms in the file",
                file=self.file.path,
                line=self.file.line,
            )
        return [array for array in from_twin if states(self.file, array.name)]

    def violations(self, nest: Nest, cuts: CutSequence, options: Any) -> list[Violation]:
        if self.unjudged(nest, cuts, options) is not None:
            return []
        from .flatten import judge_order

        data = self._measured_data(nest, cuts, options)
        order = judge_order(self.file, data + assignments(order_data(nest, cuts)))
        return self._blamed(nest, cuts, order, None if all(order.holds) else self._flat(nest, data))

    def violations_of_each(
        self, nest: Nest, orders: Sequence[CutSequence], options: Any
    ) -> list[tuple[Violation, ...]]:
        """What each of many orders breaks; those of the same cuts are judged in one run of MiniZinc's solver.

        Sentences are kerfwise's own.
        """
        from .flatten import judge_orders

        alike: dict[frozenset[tuple[object, ...]], list[int]] = {}
        for k, cuts in enumerate(orders):
            alike.setdefault(frozenset((c.contour, c.entry, c.direction, c.zone) for c in cuts), []).append(k)
        found: list[tuple[Violation, ...]] = [()] * len(orders)
        for numbers in alike.values():
            own = [orders[k] for k in numbers]
            if self.unjudged(nest, own[0], options) is not None:
                continue
            data = self._measured_data(nest, own[0], options)
            judged = judge_orders(self.file, data + assignments(orders_data(nest, own)), len(own))
            flat = None if all(all(order.holds) for order in judged) else self._flat(nest, data)
            for k, order in zip(numbers, judged, strict=True):
                found[k] = tuple(self._blamed(nest, orders[k], order, flat))
        return found

    def _blamed(self, nest: Nest, cuts: CutSequence, order: JudgedOrder, flat: Flattened | None) -> list[Violation]:
        """What an order breaks, as violations; what is about contours alone that are not cut is none."""
        at = cuts.positions()
        found = []
        for k, held in enumerate(order.holds):
            if not held:
                node = flat.elements[k] if flat is not None and k < len(flat.elements) else False
                if not isinstance(node, Lit) and (pairs := self._pairs_broken(nest, node, at)):
                    sentence = order.says[k] if k < len(order.says) else self.sentence
                    for pair in pairs:
                        text = f"{sentence}: {pair[0]} before {pair[1]} ({self.file.place})"
                        found.append(Violation(self.id, pair, text, tuple(sorted(at[name] for name in pair))))
                    continue
                numbers = tuple(contours_of(node))
                if flat is not None and flat.about_of(k) and not 0 < len(numbers) <= MOST_TOLD:
                    numbers = flat.about_of(k)
                ids = tuple(nest.contours[number].id for number in numbers)
                if ids and not any(name in at for name in ids):
                    continue
                sentence = order.says[k] if k < len(order.says) else self._told(nest, node)
                positions = tuple(sorted(at[name] for name in ids if name in at)) if len(ids) <= MOST_TOLD else ()
                found.append(Violation(self.id, ids[:MOST_TOLD], f"{sentence} ({self.file.place})", positions))
        if not order.possible:
            text = f"a constraint of the file does not hold: {self.sentence} ({self.file.path.name}:{self.file.bare})"
            found.append(Violation(self.id, (), text))
        return found

    def _pairs_broken(self, nest: Nest, node: Node, at: Mapping[str, int]) -> list[tuple[str, str]]:
        """The orders that cuts break, where a hard element asks for nothing but orders: one of them may be relaxed."""
        if self.strength == "soft" or self.excusable:
            return []
        asked = orders(node)
        ids = [(nest.contours[pair[0]].id, nest.contours[pair[1]].id) for pair in asked if pair is not None]
        whole = ids if len(ids) == len(asked) else []
        return [(one, other) for one, other in whole if one in at and other in at and at[one] > at[other]]

    def _told(self, nest: Nest, node: Node) -> str:
        """What does not hold, where the file has no sentence for it."""
        if isinstance(node, Lit) and (pair := orders(node)[0]) is not None:
            first, then = (nest.contours[k].id for k in pair)
            return f"{first} must be cut before {then}: {self.sentence}"
        ids = [nest.contours[number].id for number in contours_of(node)]
        return f"{', '.join(ids[:MOST_TOLD])}: {self.sentence}" if ids else self.sentence

    def pairs(self, nest: Nest, cuts: CutSequence, options: Any) -> list[Ids]:
        """Every order that the file states by itself, over facts that the check has measured."""
        if not cuts or self.unjudged(nest, cuts, options) is not None:
            return []
        return self._orders(nest, self._measured(nest, cuts, options))

    def sums(self, nest: Nest, cuts: CutSequence, options: Any) -> list[SumOfIds]:
        if not cuts or self.unjudged(nest, cuts, options) is not None:
            return []
        flat = self._measured(nest, cuts, options)
        return sums_of_ids(nest, (*flat.elements, *flat.further))

    def pairs_of_nest(self, nest: Nest, options: Any) -> list[Ids]:
        """The same before there are cuts; none of a file that looks at zones, at the start side or at ways to cut."""
        named = set(re.findall(r"[A-Za-z_]\w*", whole_text(self.file)))
        if named & OF_CUTS or any(name.startswith(("cand_", "head_", "tail_")) for name in named):
            return []
        return self._orders(nest, self._measured(nest, CutSequence(()), options))

    def _orders(self, nest: Nest, flat: Flattened) -> list[Ids]:
        asked = (pair for node in (*flat.elements, *flat.further) for pair in orders(node) if pair is not None)
        return list(dict.fromkeys((nest.contours[i].id, nest.contours[j].id) for i, j in asked))

    def selects_nothing(self, nest: Nest, cuts: CutSequence, options: Any) -> str | None:
        """Attributes that the file reads and no part has, or words that a drawing says of no contour; what there is."""
        text = whole_text(self.file)
        words = sorted({w for w in re.findall(r"\battribute_(\w+)", text) if f"has_attribute_{w}" not in text})
        lacking = [name for name in words if all(value is None for value in attributes(nest, name))]
        if not lacking:
            return unknown_words(nest, "".join(map(without_comments, files_read(self.file).values())))
        there = {name for part in nest.parts for name in part.attributes}
        line = next((k for k, of in enumerate(self.file.text.splitlines(), 1) if f"attribute_{lacking[0]}" in of), 0)
        known = join_names(sorted(there), MOST_TOLD) or "none"
        near = nearest(lacking[0], there)
        meant = f"; did you mean {near}?" if near else ""
        return (
            f"no part of this nest has the attribute {', '.join(lacking)} ({self.file.path.name}:{line}), "
            f"its parts have {known}{meant}"
        )

    def unjudged(self, nest: Nest, cuts: CutSequence, options: Any) -> str | None:
        return missing(cuts, whole_text(self.file))

    def still_counts(self, violation: Violation, made: int) -> bool:
        """A pair in the wrong order counts where both are new cuts, any other violation where the last of them is."""
        decides = min if len(violation.cuts) == 2 else max
        return not violation.cuts or decides(violation.cuts) > made

    def _measured(self, nest: Nest, cuts: CutSequence, options: Any) -> Flattened:
        """The file's flat form over facts that the check has measured, each cut being a candidate."""
        return self._flat(nest, self._measured_data(nest, cuts, options))

    def _flat(self, nest: Nest, data: str) -> Flattened:
        from .flatten import flatten

        n = len(nest.contours)
        return flatten(self.file, data, n, range(n))

    def _measured_data(self, nest: Nest, cuts: CutSequence, options: Any) -> str:
        self.expect_small(nest)
        text = whole_text(self.file)
        limits = Limits(
            **{f.name: getattr(options, f.name) for f in dataclasses.fields(Limits) if hasattr(options, f.name)}
        )
        own = parameters_data(self.file, options)
        if self.replaces is not None:
            own = [*twin_of(self.replaces.id).measured(nest, cuts, options), *own]
        return assignments(measured_data(nest, cuts, limits, text) + own) + further_words(nest, text, limits.plate)

    def fact_options(self, given: FactOptions, options: Any, strength: Strength) -> FactOptions:
        """As the rule whose place it takes, but that zones need not respect the facts of its orders."""
        if self.replaces is None:
            return given
        made = self.replaces.fact_options(given, options, strength)
        return dataclasses.replace(made, zone_respects=given.zone_respects)


def read_model_rule(path: Path, rule_id: str = "", sentence: str = "") -> ModelRule:
    """The rule in a model file, under another id or with another sentence than its own if given.

    Raises InputError if the file cannot be read or states nothing; MiniZinc is not asked yet.
    """
    file = read_model_file(Path(path))
    shipped = RULES.get(rule_id or file.name)
    if shipped is not None and shipped.takes_no_file:
        raise InputError(
            f"rule {shipped.id} takes no file in its place: {shipped.takes_no_file}; give the file another name, so "
            "that it is a rule beside it",
            file=file.path,
        )
    return ModelRule(dataclasses.replace(file, sentence=sentence) if sentence else file, rule_id)


_KINDS: Mapping[str, OptionKind] = {"int": Number(whole=True), "bool": Flag(), "string": Text()}


@lru_cache(maxsize=256)
def options_class(parameters: tuple[Parameter, ...]) -> type:
    """The options of a rule with these parameters: a frozen dataclass, a field each."""
    return make_dataclass("ModelOptions", [*_fields(parameters), *_unset(NoOptions)], frozen=True)


@lru_cache(maxsize=256)
def options_in_place(base: type, parameters: tuple[Parameter, ...] = ()) -> type:
    """The options of a rule whose place a file takes, and the file's own parameters.

    The limits that facts hang on are filled in by the profile.
    """
    taken = {f.name for f in dataclasses.fields(base)}
    own = _fields(tuple(p for p in parameters if p.key not in taken))
    return make_dataclass(base.__name__, [*own, *_unset(base)], bases=(base,), frozen=True)


def _fields(parameters: tuple[Parameter, ...]) -> list[tuple[str, type, Any]]:
    return [
        (p.key, object, field(default=_value(p), metadata=option(_KINDS[p.type], p.help or f"{p.name} of the file")))
        for p in parameters
    ]


def _unset(base: type) -> list[tuple[str, type, Any]]:
    taken = {f.name for f in dataclasses.fields(base)}
    return [(f.name, object, field(default=f.default)) for f in dataclasses.fields(Limits) if f.name not in taken]


def _value(parameter: Parameter) -> object:
    if parameter.type == "int":
        return int(parameter.default)
    return parameter.default == "true" if parameter.type == "bool" else parameter.default.strip('"')


def parameters_data(file: ModelFile, options: Any) -> Fields:
    """The parameters of a file as data."""
    return [(p.name, json.dumps(getattr(options, p.key), ensure_ascii=False)) for p in file.parameters]


_facts: WeakKeyDictionary[Facts, str] = WeakKeyDictionary()
_stated: WeakKeyDictionary[Facts, dict[tuple[ModelRule, Any], tuple[Statement, ...]]] = WeakKeyDictionary()


def facts_data(facts: Facts) -> str:
    """The facts as MiniZinc data, kept as long as the facts live."""
    from kerfwise.encoder.facts.export import facts_dzn

    if facts not in _facts:
        _facts[facts] = facts_dzn(facts)
    return _facts[facts]


def _same_but_for_zones(one: Facts, other: Facts) -> bool:
    names = (f.name for f in dataclasses.fields(one) if f.name != "zone")
    return all(getattr(one, name) is getattr(other, name) for name in names)


def _way_words(entry: tuple[float, float], direction: str) -> str:
    return f"entered at ({entry[0]:.1f}, {entry[1]:.1f}), {direction}"
