"""The page of what rules in Python import, from the docstrings.

`python -m kerfwise.tests.docs.rule_kit_page > docs/rule-kit.md` writes it anew.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterator

from kerfwise import rule_kit
from kerfwise.rules.options.kind import OptionKind

HEAD = """\
# What a rule in Python imports

This page is made from the docstrings by `python -m kerfwise.tests.docs.rule_kit_page > docs/rule-kit.md`. How to write
a rule: [a rule in Python](writing-a-rule.md).

A plant's rule imports from `kerfwise.rule_kit` and from no other module of kerfwise:

```python
from kerfwise.rule_kit import Nest, OrderRule, Precede
```

What stands there stays; other modules may move, and what they hold may change its name.
"""
GROUPS = {
    "The rule": (
        "Rule", "OrderRule", "Violation", "NoGoodIds", "Ids", "Strength", "Forced", "RuleSetting", "Plant",
        "FactOptions", "LeadOptions", "TemperatureLimit", "InputError",
    ),
    "What it states": (
        "Precede", "Forbid", "AtLeast", "Contiguous", "Lag", "Move", "NoGood", "Crossing", "Statement", "Before",
        "Steps", "Pick", "Enough", "About",
    ),
    "What it may read": (
        "Nest", "Sheet", "Part", "Contour", "Kind", "Curve", "Point", "Facts", "Column", "Candidate", "Cut",
        "CutSequence", "Direction", "Side", "places", "host_holes",
    ),
    "Its options": (
        "option", "NoOptions", "Number", "Flag", "Choice", "Text", "OrWord", "LENGTH", "LENGTH_BY_THICKNESS", "SPEED",
        "DURATION", "TEMPERATURE", "ENERGY",
    ),
    "Its cases": ("Case", "in_order", "cut", "nest", "part", "rect", "circle"),
}  # fmt: skip
ALIASES = {
    "Ids": "two contour ids, (before, after)",
    "Strength": "`hard`, `soft` or `off`",
    "Forced": "contour id → the contours that the hard order rules put before it in every plan",
    "Statement": "any of the statements above",
    "Kind": "`outer`, `hole`, `mark` or `slit`",
    "Point": "x and y, mm",
    "Direction": "`cw` or `ccw`",
    "Side": "`left`, `right`, `bottom` or `top`",
}
"""Names of types that have no docstring."""


def page() -> str:
    """The whole page."""
    missing = {*rule_kit.__all__} ^ {name for names in GROUPS.values() for name in names}
    assert not missing, f"not on the page, or not in the kit: {', '.join(sorted(missing))}"
    lines = [HEAD]
    for heading, names in GROUPS.items():
        lines += [f"## {heading}", "", "| name | what it is |", "|---|---|", *map(_row, names), ""]
    lines += ["## All of Rule", "", *_members(rule_kit.Rule)]
    return "\n".join(lines).rstrip() + "\n"


def _row(name: str) -> str:
    found = getattr(rule_kit, name)
    if name in ALIASES:
        return f"| `{name}` | {ALIASES[name]} |"
    if isinstance(found, OptionKind):
        return f"| `{name}` | a kind of value: {found.expected()} |"
    said = (inspect.getdoc(found) or "").split("\n\n")[0]
    return f"| `{name}` | {' '.join(said.split())} |"


def _members(cls: type) -> Iterator[str]:
    yield "What a rule may define beside its `id`, `sentence`, `source` and `Options`. There must be `statements` and"
    yield "`violations`; an `OrderRule` has `violations`, and needs `pairs` and `reason(before, after, start_side)`."
    yield ""
    for name, member in vars(cls).items():
        if inspect.isfunction(member) and not name.startswith("_"):
            said = " ".join((inspect.getdoc(member) or "").split("\n\n")[0].split())
            signature = str(inspect.signature(inspect.unwrap(member))).replace("'", "").replace("(self, ", "(")
            yield f"- `{name}{signature}`: {said}"


if __name__ == "__main__":
    print(page(), end="")
