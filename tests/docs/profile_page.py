"""The page of every key of a profile: `python -m kerfwise.tests.docs.profile_page > docs/profile.md`.

It is made from the declarations that profiles are read with, as the schema is.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from typing import Any

from kerfwise.rules.lock import Lock
from kerfwise.rules.options.option import Members, Option, options_of
from kerfwise.rules.own import own_rules_schema
from kerfwise.rules.profile.load import MOVED
from kerfwise.rules.profile.schema import profile_schema
from kerfwise.rules.profile.sections import SECTIONS
from kerfwise.rules.registry import RULES

INTRODUCTION = """\
# Every key of a profile

Made from what profiles are read with, by `python -m kerfwise.tests.docs.profile_page > docs/profile.md`.

A profile is one YAML file. A key that it does not give has the value of the profile that it is `based_on`, else the
default below. `kerfwise profile show PROFILE --sources` prints all of them with the line that each is from,
`kerfwise profile diff A B` what two profiles say differently, `kerfwise profile new NAME` begins one, and `kerfwise
profile check PROFILE` finds what is wrong: all that `solve` would refuse of any nest, and options that have no
effect. The shipped profiles give many keys another value than the default here.

Numbers that no plant has are refused, with the unit in which they would do. A group that is there and says nothing
of what switches it on has its defaults: `cuts: {common: {}}` is `shortest: 20 mm`, `links: {}` is `longest: 30 mm`,
`scrap: {}` is `grid: 500 mm`. A rule that is off needs a strength.
"""
PAGES = {
    "machine": "[the machine](machine.md), [several torches](torches.md)",
    "material": "[material charts](materials.md)",
    "leads": "[leads by thickness](machine.md#leads-and-clearance-by-thickness)",
    "small_holes": "[small holes](small-holes.md)",
    "corners": "[slower corners](materials.md#feeds-by-contour)",
    "cuts": "[chains](links.md), [common cuts](common.md), [narrow slots](narrow-slots.md), "
    "[tabs](tabs.md), [cutting up the skeleton](scrap.md), [pierce pass](pierce-pass.md)",
    "nesting": "[nesting](nesting.md)",
    "drawing": "[how drawings are read](drawings.md)",
    "time": "[how long a program takes](time.md)",
    "prices": "[what a sheet costs](prices.md)",
    "heat": "[how hot the sheet gets](heat.md)",
}
"""Section → the pages that say more."""
_LONG = 80
"""Characters of the longest default that is shown."""
_HEAD = ("| key | default | what | values |", "|---|---|---|---|")


def profile_page() -> str:
    """The whole page, in Markdown."""
    lines = [INTRODUCTION, *_top(), *(line for name, owner in SECTIONS.items() for line in _section(name, owner))]
    return "\n".join([*lines, *_rules(), *_own_rules(), *_locks(), *_older()]) + "\n"


def _top() -> Iterator[str]:
    sections = profile_schema()["properties"]
    yield from ("## At the top", "", "| key | what |", "|---|---|")
    for key in ("name", "based_on", "python", "models"):
        yield f"| `{key}` | {_cell(sections[key]['description'])} |"
    yield from (f"| `{key}` | [below](#{key}): {_first_line(owner)} |" for key, owner in SECTIONS.items())
    yield "| `rules` | [below](#rules): which rules hold, how strongly, and their options |"
    yield "| `own_rules` | [below](#own_rules): rules of the plant's own |"
    yield from ("| `locks` | [below](#locks): decisions of the operator |", "")


def _section(name: str, owner: type) -> Iterator[str]:
    yield from (f"## {name}", "", _first_line(owner))
    if name in PAGES:
        yield from ("", f"More: {PAGES[name]}.")
    yield from ("", *_HEAD, *_rows(owner), "")


def _rules() -> Iterator[str]:
    yield from (
        "## rules",
        "",
        "Under the name of a rule stands its strength, `hard`, `soft` or `off`, or a mapping with `strength`, its "
        "options and, where it is soft, `weight`: what breaking it once costs, in idle travel. [The rules](rules.md) "
        "say what each asks.",
        "",
        *_HEAD,
    )
    for name, rule in RULES.items():
        strengths = ", ".join(rule.strengths)
        yield f"| `{name}.strength` | `{rule.default}` | {_cell(rule.sentence)} [More](rules.md#{name}) | {strengths} |"
        if "soft" in rule.strengths:
            cost = "cost of breaking it once, where it is soft"
            yield f"| `{name}.weight` | `{rule.default_weight:g} mm` | {cost} | a length |"
        yield from _rows(rule.Options, f"{name}.")
    yield ""


def _own_rules() -> Iterator[str]:
    yaml_rule, file = own_rules_schema()["items"]["oneOf"]
    yield from (
        "## own_rules",
        "",
        "A list of rules. Each gives `name`, one of the demands, and what it is about. "
        "[Own rules](own-rules.md) has the language.",
        "",
        "| key | what |",
        "|---|---|",
    )
    keys = file["properties"] | yaml_rule["properties"]
    yield from (f"| `{key}` | {_cell(schema['description'])} |" for key, schema in keys.items())
    yield ""


def _locks() -> Iterator[str]:
    yield from (
        "## locks",
        "",
        "A list of decisions, each about one contour or one part. [The rule](rules.md#locks) keeps them.",
        "",
        "| key | what | values |",
        "|---|---|---|",
    )
    yield from (f"| `{o.key}` | {_cell(o.help)} | {_cell(o.kind.expected())} |" for o in options_of(Lock))
    yield ""


def _older() -> Iterator[str]:
    yield from ("## Older names", "", "Still read:", "", "| older | now |", "|---|---|")
    for section, moved in MOVED.items():
        yield from (f"| `{section}.{key}` | `{section}.{group}.{name}` |" for key, (group, name) in moved.items())


def _rows(owner: Any, before: str = "") -> Iterator[str]:
    """A row for each option; those of a group have its key before theirs."""
    for option in options_of(owner):
        if isinstance(option.kind, Members):
            yield from _rows(option.kind.owner, f"{before}{option.key}.")
        else:
            cells = (f"`{before}{option.key}`", _default(option), _cell(option.help), _cell(option.kind.expected()))
            yield _row(cells)


def _default(option: Option) -> str:
    text = option.kind.write(option.default)
    return f"`{_cell(text)}`" if len(text) <= _LONG else "too long for here: `kerfwise profile show`"


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _first_line(owner: type) -> str:
    return (owner.__doc__ or "").strip().splitlines()[0]


if __name__ == "__main__":
    sys.stdout.write(profile_page())
