"""The text of a profile with other values of its rules: comments, order and spacing stay as they are written."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.yaml_edit import with_value, without_value
from kerfwise.rules.options.yaml_positions import compose, deepest, is_empty, plain

STRENGTH, WEIGHT = "strength", "weight"
RuleValue = tuple[str, str, str]
"""A rule, a key of it (`strength`, `weight` or an option), and the value as a profile has it."""
_BOM = "\ufeff"


def with_rule_values(text: str, values: Sequence[RuleValue]) -> str:
    """The text with values of rules set; a weight goes where its rule is no longer soft.

    Whether a profile may have these values is not looked at: see `expect_usable` in `jobs/new_profile.py`.

    Raises
    ------
    InputError
        If the text is not YAML, a value is not, or the text is written so that a value cannot be set without changing
        another one, such as with an alias.

    Examples
    --------
    >>> text = "rules:\\n  pierce: hard   # the hole\\n  heat-lag: {strength: soft, weight: 50 mm}  # a pause\\n"
    >>> print(with_rule_values(text, [("pierce", "clearance", "2 mm"), ("heat-lag", "strength", "hard")]), end="")
    rules:
      pierce: {strength: hard, clearance: 2 mm}   # the hole
      heat-lag: {strength: hard}  # a pause
    """
    mark, body = (_BOM, text[1:]) if text.startswith(_BOM) else ("", text)
    ends = "\r\n" if "\r\n" in body and body.count("\r\n") == body.count("\n") else "\n"
    body = body.replace(ends, "\n")
    for value in values:
        body = _with_one(body, *value)
    return mark + body.replace("\n", ends)


def _with_one(text: str, rule: str, key: str, value: str) -> str:
    what = f"rules.{rule}.{key}"
    wanted = _plain(value.strip(), what)
    place = ("rules", rule)
    before = _said(text, *place)
    said = dict(before) if isinstance(before, dict) else {} if before is None else {STRENGTH: before}
    made = text
    if isinstance(before, dict) or (before is None and key != STRENGTH):
        made = with_value(made, (*place, key), value.strip())
    elif key == STRENGTH:
        made = with_value(made, place, value.strip())
    else:
        made = with_value(made, place, f"{{{STRENGTH}: {_word(before)}, {key}: {value.strip()}}}")
    said[key] = wanted
    if key == STRENGTH and wanted != "soft" and WEIGHT in said:
        made = without_value(made, (*place, WEIGHT))
        del said[WEIGHT]
    _expect_only(text, made, rule, said if isinstance(before, dict) or key != STRENGTH else wanted, what)
    return made


def _word(said: Any) -> str:
    return "off" if said is False else str(said)


def _plain(value: str, what: str) -> Any:
    """The value as YAML has it."""
    node = compose(value, what) if value and "\n" not in value else None
    if node is None or is_empty(node):
        raise InputError(f"{what}: expected a value in one line, got {value!r}")
    return plain(node)


def _said(text: str, *path: str) -> Any:
    root = compose(text, "")
    if root is None:
        return None
    holder = deepest(root, *path[:-1])
    node = deepest(root, *path)
    return None if node is holder or node is root else plain(node)


def _expect_only(before: str, after: str, rule: str, said: Any, what: str) -> None:
    """Make sure that what a profile says of one rule has changed, and nothing else."""
    wanted = _whole(before)
    rules = wanted.get("rules") or {}
    try:
        same = isinstance(rules, dict) and _whole(after) == {**wanted, "rules": {**rules, rule: said}}
    except InputError:
        same = False
    if not same:
        raise InputError(
            f"{what}: the profile is written so that this cannot be changed here without changing more: change it in "
            "the file"
        )


def _whole(text: str) -> dict[str, Any]:
    root = compose(text, "")
    found = {} if root is None else plain(root)
    if not isinstance(found, dict):
        raise InputError("not a profile: expected a mapping (key: value)")
    return found
