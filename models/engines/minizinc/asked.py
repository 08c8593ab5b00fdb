"""What is asked of a plan: arrays of statements, each with the file that defines it and what a breach costs."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.flat.model_rule import ModelRule
from kerfwise.rules.minizinc.twin import MODELS, rule_file, twin_of
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import RuleSetting
from kerfwise.rules.rule import Rule
from kerfwise.rules.statements import EXEMPTION_MM, Statement
from kerfwise.rules.stating.state_rules import Stated

from .statement_text import conditions, lag_ms, missing_ms


@dataclass(frozen=True, slots=True)
class AskedArray:
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


def asked(profile: Profile, stated: Stated, afterwards: Sequence[Statement] = ()) -> tuple[AskedArray, ...]:
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


def rules_in_files(profile: Profile, stated: Stated) -> dict[str, RuleSetting]:
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


def include(path: Path) -> str:
    """The line that includes a file."""
    return f"include {json.dumps(path.as_posix(), ensure_ascii=False)};"


def drops_orders(rule: Rule[Any]) -> bool:
    """Whether orders that are dropped on a cycle are taken out of the facts that the rule's file reads."""
    return not isinstance(rule, ModelRule) and twin_of(rule.id).drops_orders


def _file_of(rule: Rule[Any]) -> Path:
    return rule.file.path.resolve() if isinstance(rule, ModelRule) else rule_file(rule.id)


def arrays_of(rule: Rule[Any], setting: RuleSetting) -> Iterator[AskedArray]:
    hard = EXEMPTION_MM if rule.excusable else None
    weight_mm = setting.weight
    array = rule.file.array if isinstance(rule, ModelRule) else f"{rule.id.replace('-', '_')}_holds"
    yield AskedArray(include(_file_of(rule)), array, hard if weight_mm is None else weight_mm)
    if isinstance(rule, ModelRule):
        for further in rule.further(setting.options):
            yield AskedArray(include(_file_of(rule)), further.name, further.weight_mm)
        return
    for further in twin_of(rule.id).further(setting.options, weight_mm):
        yield AskedArray(include(further.file), further.name, further.weight_mm, further.most_ms)


def _in_words(statements: Sequence[Statement]) -> Iterator[AskedArray]:
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
        yield AskedArray(f"{include(MODELS / 'clock.mzn')}\n{text}" if most_ms else text, name, weight, most_ms)
