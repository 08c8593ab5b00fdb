"""Style sheets of SVG files, put so that the library's patterns read them in one go: on others they try for hours."""

from __future__ import annotations

LONGEST_ATTRIBUTE = 20_000
"""Characters of an attribute other than a path's; real ones have some hundreds."""
LONG_BY_NATURE = frozenset({"d", "points", "href", "data"})
"""Attributes that may be longer: coordinates and pictures."""


def plain_rules(text: str) -> str:
    """The rules of a style sheet, each as `selector{what holds}`, without comments and whatever is no whole rule.

    Examples
    --------
    >>> plain_rules("/* a */ .a { fill: red } .b {} #c{display:none} .d {")
    '.a{fill: red}#c{display:none}'
    """
    bare = _without_comments(text)
    rules, at = [], 0
    while (opens := bare.find("{", at)) >= 0 and (closes := bare.find("}", opens)) >= 0:
        selector, says = bare[at:opens].strip(), bare[opens + 1 : closes].strip()
        if selector and says:
            rules.append(f"{selector}{{{says}}}")
        at = closes + 1
    return "".join(rules)


def too_long(name: str, value: str) -> str:
    """What is wrong with an attribute that is too long to be read; "" if it is not.

    Examples
    --------
    >>> too_long("transform", "rotate(1) " * 9000)
    'its transform has 90000 characters, at most 20000 are read'
    """
    if len(value) <= LONGEST_ATTRIBUTE or name.rpartition("}")[2] in LONG_BY_NATURE:
        return ""
    return f"its {name.rpartition('}')[2]} has {len(value)} characters, at most {LONGEST_ATTRIBUTE} are read"


def _without_comments(text: str) -> str:
    """Each comment as a blank: from /* to */ or to the end, and, as the library has it, from // to the line's end."""
    kept, at = [], 0
    block, line = text.find("/*"), text.find("//")
    while block >= 0 or line >= 0:
        if line < 0 or 0 <= block < line:
            ends = text.find("*/", block + 2)
            kept.append(text[at:block])
            at = len(text) if ends < 0 else ends + 2
        else:
            ends = text.find("\n", line)
            kept.append(text[at:line])
            at = len(text) if ends < 0 else ends
        block = text.find("/*", at) if 0 <= block < at else block
        line = text.find("//", at) if 0 <= line < at else line
    return " ".join([*kept, text[at:]])
