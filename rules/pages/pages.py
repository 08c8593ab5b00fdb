"""The pages of the rules, made from the rules themselves: `python -m kerfwise.rules.pages > docs/rules.md`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule, Strength

from .texts import place_of_file, texts_page

if TYPE_CHECKING:
    from kerfwise.rules.profile.profile import Profile


def _first_to_give_way() -> str:
    softest, *others = sorted((rule for rule in RULES.values() if rule.gives_way), key=lambda rule: -rule.gives_way)
    return ", then ".join([f"`{softest.id}` gives way first", *(f"`{rule.id}`" for rule in others)])


INTRODUCTION = f"""\
# Rules

Made from the rules' own docstrings by `python -m kerfwise.rules.pages > docs/rules.md`.

A profile makes each rule `hard`, `soft` (breaking it once costs its weight, in idle travel) or `off`, and sets its
options. Where hard order rules contradict each other or a lock, {_first_to_give_way()};
every order that is dropped is listed in the plan with the cycle it closes, or with the locked position that leaves no
room for it. All others must hold, or there is no plan.
"""


@dataclass(frozen=True, slots=True)
class RuleRow:
    """One rule as a profile has it."""

    id: str
    strength: Strength
    weight: float | None
    sentence: str
    source: str
    from_where: str = ""


def rule_table(profile: Profile) -> list[RuleRow]:
    """Every rule with the strength that the profile gives it: the catalogue by id, then those from outside and its own.

    `from_where` names the file or the package that has brought a rule.
    """
    own = {rule.id: rule for rule in profile.own_rules}
    return [
        RuleRow(name, given.strength, given.weight, rule.sentence, rule.source, _from_where(rule))
        for name, rule in profile.rulebook().items()
        for given in (own[name] if name in own else profile.rules[name],)
    ]


def _from_where(rule: Rule[Any]) -> str:
    if not rule.brought:
        return ""
    replaces = rule.stands_in is not None and rule.stands_in.in_place_of_shipped
    return f" ({rule.brought}{', in place of the shipped rule' if replaces else ''})"


def rule_page(id: str, known: Mapping[str, Rule[Any]] = RULES) -> str:
    """The page of one rule, in Markdown; `known` are the rules that there are.

    Raises
    ------
    InputError
        If there is no rule of that id, with the nearest.

    Examples
    --------
    >>> print(rule_page("hull-before").splitlines()[0])
    # hull-before
    """
    if id not in known:
        raise InputError(unknown("rule", id, known))
    rule = known[id]
    default = f"soft, {LENGTH.write(rule.default_weight)}" if rule.default == "soft" else rule.default
    lines = [
        f"# {rule.id}",
        "",
        rule.page(),
        "",
        "## Settings",
        "",
        f"Strength: {' or '.join(rule.strengths)} (default {default}). Source: {rule.source.rstrip('.')}.",
    ]
    if rule.brought:
        lines[-1] += f" Brought by {rule.brought}."
    else:
        lines += ["", place_of_file(rule)]
    return "\n".join([*lines, *_options(rule)]) + "\n"


def _options(rule: Rule[Any]) -> list[str]:
    options = options_of(rule.Options)
    if not options:
        return []
    rows = [f"| `{o.key}` | `{o.kind.write(o.default)}` | {o.help} | {o.kind.expected()} |" for o in options]
    return ["", "| option | default | what | values |", "|---|---|---|---|", *rows]


def all_pages() -> str:
    """The whole catalogue as one Markdown document: a table, then every page."""
    rows = [f"| [{name}](#{name}) | {rule.default} | {rule.sentence} |" for name, rule in RULES.items()]
    table = "\n".join(["| rule | default | what it asks |", "|---|---|---|", *rows])
    pages = [_with_picture(name, re.sub("^#", "##", rule_page(name), flags=re.MULTILINE)) for name in RULES]
    return "\n".join([INTRODUCTION, table, "", *pages, texts_page()])


def _with_picture(name: str, page: str) -> str:
    """The page with its picture above the settings."""
    return page.replace(
        "\n### Settings\n", f"\n![{name}, wrong and right](rule-pictures/{name}.svg)\n\n### Settings\n", 1
    )
