"""The main model: the sequence, what is asked of it, and what a plan costs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, assert_never

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.export import facts_dzn
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import UM_PER_MM, cost_um, points_um
from kerfwise.encoder.minizinc_data import Fields, assignments, include, numbers, table_from_0
from kerfwise.models.problem.problem import Durations
from kerfwise.rules.flat.model_rule import ModelRule
from kerfwise.rules.minizinc.twin import MODELS, TwinCase, rule_file, twin_of
from kerfwise.rules.profile.active_rules import ActiveRules
from kerfwise.rules.profile.sections import RuleSetting
from kerfwise.rules.rule import Rule
from kerfwise.rules.statements import (
    EXEMPTION_MM,
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Enough,
    Forbid,
    IdleTravel,
    Lag,
    Link,
    Literal,
    Move,
    NoGood,
    Pick,
    Precede,
    Statement,
    Steps,
    by_kind,
)
from kerfwise.rules.stating.state_rules import Stated

from .solution import SolveOptions

GOAL = "solve :: tightest_first :: restart_luby(250) minimize besides + excuse * excuses;"


def model_text(conditions: Sequence[ConditionArray], goal: str = GOAL) -> str:
    """MiniZinc text that states what is asked, hard or at its price.

    Examples
    --------
    >>> asked = [
    ...     ConditionArray('include "a.mzn";', "a_holds", None),
    ...     ConditionArray('include "b.mzn";', "b_holds", 0.5),
    ... ]
    >>> print(model_text(asked).partition("sequence.mzn")[2])  # doctest: +ELLIPSIS
    ";
    include "a.mzn";
    include "b.mzn";
    <BLANKLINE>
    % Hard: every statement holds.
    constraint forall(a_holds);
    <BLANKLINE>
    % Soft: what each breach costs, in µm of idle travel.
    var int: besides :: add_to_output;
    constraint besides = idle_travel + 500 * breaches(b_holds);
    ...
    """
    hard = [a for a in conditions if a.weight_mm is None]
    excused = [a for a in conditions if a.weight_mm == EXEMPTION_MM and not a.most_ms]
    soft = [a for a in conditions if a not in hard and a not in excused]
    return "\n".join(
        [
            include(MODELS / "sequence.mzn"),
            *dict.fromkeys(a.source for a in conditions),
            "",
            "% Hard: every statement holds.",
            *(_constraint(a) for a in hard if a.name),
            "",
            "% Soft: what each breach costs, in µm of idle travel.",
            "var int: besides :: add_to_output;",
            _sum("constraint besides", "idle_travel", [_cost(a) for a in soft]),
            "",
            "% Hard, but excused where nothing else is left; an excuse costs more than any plan does besides.",
            "var int: excuses :: add_to_output;",
            _sum("constraint excuses", "0", [f"breaches({a.name})" for a in excused]),
            _sum("int: excuse", "1 + longest_travel", [_most(a) for a in soft]),
            "",
            goal,
            "",
        ]
    )


def _constraint(a: ConditionArray) -> str:
    return f"constraint forall(ms in {a.name})(ms = 0);" if a.most_ms else f"constraint forall({a.name});"


def _cost(a: ConditionArray) -> str:
    """What an array of a soft rule costs: a price for each breach, or for each millisecond that is missing."""
    return f"{_price(a)} * {'sum' if a.most_ms else 'breaches'}({a.name})"


def _most(a: ConditionArray) -> str:
    """What it can cost at most."""
    return f"{_price(a) * (a.most_ms or 1)} * length({a.name})"


def _price(a: ConditionArray) -> int:
    weight_mm = a.weight_mm or 0.0
    return round(weight_mm) if a.most_ms else round(weight_mm * UM_PER_MM)


def _sum(declared: str, first: str, terms: Sequence[str]) -> str:
    return f"{declared} = {' + '.join([first, *terms])};"


@dataclass(frozen=True, slots=True)
class ConditionArray:
    """One array of `var bool`, false where a plan breaks what is asked.

    `source` defines it; `name` may be empty for a file that states constraints itself. `weight_mm` is None where it is
    hard, else the price of each breach in idle travel; `EXEMPTION_MM` stands for a hard rule that may be excused. With
    `most_ms` the array is of `var int`, milliseconds that are missing, at most so many each, and the price is that of a
    second.
    """

    source: str
    name: str
    weight_mm: float | None
    most_ms: int = 0


def condition_arrays(
    profile: ActiveRules, stated: Stated, afterwards: Sequence[Statement] = ()
) -> tuple[ConditionArray, ...]:
    """Everything that the rules of the profile and its own files ask, and the statements of rules without a file.

    `afterwards` are statements that geometry has added since; they are stated whatever rule they come from.
    """
    files = rules_in_files(profile, stated)
    book = profile.rulebook()
    arrays = [array for rule, setting in files.items() for array in arrays_of(book[rule], setting)]
    kinds = by_kind(stated.statements)
    in_data = {id(s) for s in (*kinds.idle_travel, *kinds.link)}  # the table of travel has their price
    others = [s for s in stated.statements if id(s) not in in_data and s.about.rule not in files]
    return (*arrays, *_in_words([*others, *afterwards]))


def rules_in_files(profile: ActiveRules, stated: Stated) -> dict[str, RuleSetting]:
    """The rules that are on and whose files say all that is asked of them.

    Not so where single statements of a rule were relaxed or given a price of their own to resolve a conflict: such a
    rule is stated in words, but for orders dropped of a rule that takes them out of its facts.
    """
    book = profile.rulebook()
    weights: dict[str, set[float | None]] = {}
    for s in stated.statements:
        weights.setdefault(s.about.rule, set()).add(s.weight)
    picked_at = {d.rule for d in stated.dropped if not drops_orders(book[d.rule])}
    return {
        rule: setting
        for rule, setting in profile.settings().items()
        if _file_of(book[rule]).exists()
        and rule not in picked_at
        and weights.get(rule, set()) <= {array.weight_mm for array in arrays_of(book[rule], setting)}
    }


def drops_orders(rule: Rule[Any]) -> bool:
    """Whether orders that are dropped on a cycle are taken out of the fact that the rule states."""
    return rule.gives_way > 0 and rule.pairs_are != ""


def _file_of(rule: Rule[Any]) -> Path:
    return rule.file.path.resolve() if isinstance(rule, ModelRule) else rule_file(rule.id)


def arrays_of(rule: Rule[Any], setting: RuleSetting) -> Iterator[ConditionArray]:
    hard = EXEMPTION_MM if rule.excusable else None
    weight_mm = setting.weight
    array = rule.file.array if isinstance(rule, ModelRule) else f"{rule.id.replace('-', '_')}_holds"
    yield ConditionArray(include(_file_of(rule)), array, hard if weight_mm is None else weight_mm)
    if isinstance(rule, ModelRule):
        for further in rule.further(setting.options):
            yield ConditionArray(include(_file_of(rule)), further.name, further.weight_mm)
        return
    for further in twin_of(rule.id).further(setting.options, weight_mm):
        yield ConditionArray(include(further.file), further.name, further.weight_mm, further.most_ms)


def _in_words(statements: Sequence[Statement]) -> Iterator[ConditionArray]:
    """Statements as text, one array for each rule and weight, and one for those that count seconds."""
    groups: dict[tuple[str, float | None, int], list[str]] = {}
    for s in statements:
        groups.setdefault((s.about.rule, s.weight, 0), []).extend(conditions(s))
        for lag in by_kind([s]).lag:
            if lag.seconds > 0:
                groups.setdefault((s.about.rule, s.weight, lag_ms(lag)), []).append(missing_ms(lag))
    for number, ((rule, weight, most_ms), values) in enumerate(groups.items(), 1):
        name, kind = f"stated_{number}", "int" if most_ms else "bool"
        listed = ",\n   ".join(values)
        text = f"array[int] of var {kind}: {name} =  % {rule}\n  [{listed}];"
        yield ConditionArray(f"{include(MODELS / 'clock.mzn')}\n{text}" if most_ms else text, name, weight, most_ms)


# Single statements as MiniZinc text: for rules that have no file under `rules/`, such as a plant's own in YAML.


def conditions(statement: Statement) -> list[str]:
    """Boolean expressions over the words of `sequence.mzn`; a breach of the statement counts once for each false one.

    Raises InputError if the statement is of a kind that has no words in MiniZinc.

    Examples
    --------
    >>> from kerfwise.rules.statements import About
    >>> conditions(Precede(0, 4, About("level-ahead", (), "")))
    ['before(1, 5)']
    """
    match statement:
        case Precede(before, after):
            return [f"before({before + 1}, {after + 1})"]
        case Forbid(candidate):
            return [f"not picked({candidate + 1})"]
        case AtLeast():
            terms = [
                f"{weight} * bool2int({_literal(literal)})"
                for literal, weight in zip(statement.literals, statement.weights, strict=True)
            ]
            holds = f"{' + '.join(terms) or '0'} >= {statement.bound}"
            return [holds if statement.when is None else f"picked({statement.when + 1}) -> {holds}"]
        case Contiguous(contours):
            return [_follows(i, set(contours) - {i}) for i in contours if len(set(contours)) > 1]
        case Lag(first, second):
            between = f"cuts_between({first + 1}, {second + 1})"
            return [f"{between} >= {k}" for k in range(1, statement.cuts + 1)]
        case NoGood(out, left):
            return [f"exists(i in {_set(left)}, j in {_set(out)})(before(i, j))"]
        case Move(leave, reach):
            return [_not_straight_on(statement, i, j) for i in leave for j in reach if i != j]
        case Crossing() | IdleTravel():
            raise InputError(
                f"rule {statement.about.rule} cannot be stated for MiniZinc: turn it off in the profile, "
                "or take another engine, such as portfolio"
            )
        case Link():
            return []  # a price of moves: the table of travel has it
        case _:
            assert_never(statement)


def _not_straight_on(s: Move, i: int, j: int) -> str:
    """Contour j does not directly follow contour i, cut as the statement has it."""
    sides = ((s.leaving, i), (s.reaching, j))
    by = [f" /\\ pick[{contour + 1}] in {_set(some)}" for some, contour in sides if some is not None]
    return f"not (directly_before({i + 1}, {j + 1}){''.join(by)})"


def _follows(i: int, others: set[int]) -> str:
    """Contour i is cut before all the others, or right after one of them."""
    return (
        f"forall(j in {_set(others)})(before({i + 1}, j)) \\/ exists(j in {_set(others)})(directly_before(j, {i + 1}))"
    )


def lag_ms(lag: Lag) -> int:
    """The time that must lie between the two cuts, ms."""
    return round(lag.seconds * 1000)


def missing_ms(lag: Lag) -> str:
    """The milliseconds that are missing between the two cuts, as an expression over the words of `clock.mzn`."""
    return f"max(0, {lag_ms(lag)} - pause_ms({lag.first + 1}, {lag.second + 1}))"


def _literal(literal: Literal) -> str:
    match literal:
        case Before(i, j):
            return f"before({i + 1}, {j + 1})"
        case Steps(i, j, least, most):
            return f"(position[{j + 1}] - position[{i + 1}] in {least}..{most})"
        case Pick(c):
            return f"picked({c + 1})"
        case Enough(within, weights, bound):
            terms = (f"{w} * bool2int({_literal(lit)})" for lit, w in zip(within, weights, strict=True))
            return f"({' + '.join(terms) or '0'} >= {bound})"
        case _:
            assert_never(literal)


def _set(contours: Iterable[int]) -> str:
    return "{" + ", ".join(str(i + 1) for i in sorted(contours)) + "}"


# The data of the model: the facts as every engine sees them, what moves cost, and what single rules need.


def data_text(facts: Facts, profile: ActiveRules, stated: Stated, options: SolveOptions, *, clock: bool) -> str:
    """MiniZinc data for `sequence.mzn`, for `clock.mzn` if that is included, and for the rules of the profile.

    Raises InputError if a rule counts seconds and `options` have no feeds.
    """
    home_mm = options.home_mm
    kinds = by_kind(stated.statements)
    if clock and kinds.link:
        raise InputError(
            "a rule counts seconds, and links change when cuts begin, which the model for MiniZinc does not know: "
            "set cuts.links.longest to 0 mm, or take another engine, such as portfolio"
        )
    price = sum(s.weight for s in kinds.idle_travel)
    idle = travel_um(facts, price, home_mm)
    travel = _linked(idle, kinds.link)
    fields: Fields = [("travel", table_from_0(travel))]
    if clock:
        fields += _clock(facts, options)
    linked = tuple((a, b) for a, b in np.argwhere(travel < idle).tolist())
    case, book = TwinCase(facts, home_mm, linked), profile.rulebook()
    words: dict[str, None] = {}
    for rule, setting in rules_in_files(profile, stated).items():
        own = book[rule]
        if isinstance(own, ModelRule):
            fields += own.data(facts, setting.options)
            words |= dict.fromkeys(own.words(facts.nest, setting.options).splitlines())
        else:
            fields += twin_of(rule).data(case, setting.options)
    return facts_dzn(without_dropped(facts, stated, book)) + assignments(fields) + "\n".join(words)


def without_dropped(facts: Facts, stated: Stated, book: Mapping[str, Rule[Any]]) -> Facts:
    """The facts without the pairs whose orders were dropped because they closed a cycle."""
    for rule in dict.fromkeys(d.rule for d in stated.dropped):
        if drops_orders(book[rule]):
            orders = by_kind([d.statement for d in stated.dropped if d.rule == rule]).precede
            gone, fact = {(s.before, s.after) for s in orders}, book[rule].pairs_are
            kept = [pair for pair in getattr(facts, fact).tolist() if tuple(pair) not in gone]
            changed: dict[str, Any] = {fact: np.array(kept, dtype=np.int64).reshape(-1, 2)}
            facts = replace(facts, **changed)
    return facts


def travel_um(facts: Facts, price: float, home_mm: Point) -> Ints:
    """Cost of idle travel, µm, from the end of each candidate (row) to the pierce of each (column); home is number 0.

    Rounded as `Problem.travel` rounds, so that every engine finds the same optimum to the digit.
    """
    ends, pierces = _points_um(facts, home_mm)
    gap = ends[:, None, :] - pierces[None, :, :]
    return np.asarray(np.rint(price * np.sqrt((gap**2).sum(axis=2))), dtype=np.int64)


def _linked(idle: Ints, links: Sequence[Link]) -> Ints:
    """The same with links, where they cost less."""
    travel = idle.copy()
    for link in links:
        moves = np.ix_(np.array(link.leave) + 1, np.array(link.reach) + 1)
        travel[moves] = np.minimum(travel[moves], cost_um(link.weight))
    return travel


def _clock(facts: Facts, options: SolveOptions) -> Fields:
    if options.feeds is None:
        raise InputError("a rule counts seconds: the feeds of the machine are needed to solve")
    pace = Durations.of(facts, range(len(facts.candidates)), options.feeds)
    ends, pierces = _points_um(facts, options.home_mm)
    moves = pace.move_ms(ends[:, None, :].astype(np.int64), pierces[None, :, :].astype(np.int64))
    return [("cut_ms", numbers(pace.cut_ms.tolist())), ("move_ms", table_from_0(moves))]


def _points_um(facts: Facts, home_mm: Point) -> tuple[Floats, Floats]:
    """Where idle travel leaves from, and where it arrives: home, then the candidates."""
    ends = points_um([home_mm, *(c.end for c in facts.candidates)], home_mm)
    pierces = points_um([home_mm, *(c.pierce for c in facts.candidates)], home_mm)
    return ends.astype(np.float64), pierces.astype(np.float64)
