"""A profile as YAML: every value with its unit, place and source, two of them compared, values set in place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from typing import Any

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nearest_name import nearest
from kerfwise.rules.charts.chart import column_of
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.kind import Text
from kerfwise.rules.options.option import Members, options_of
from kerfwise.rules.options.quantities import LENGTH
from kerfwise.rules.options.yaml_positions import (
    Place,
    compose,
    deepest,
    is_empty,
    place_in,
    plain,
    with_value,
    without_value,
)
from kerfwise.rules.rule import Rule

from .linked_files import ChartValue
from .profile import Profile
from .sections import SECTIONS, RuleSetting
from .values import ProfileValues

# A profile as YAML with nothing left implicit: every value, its unit, and a comment of one line.

COMMENT_COLUMN = 44


def profile_yaml(profile: Profile, sources: bool = False) -> str:
    """The whole profile; loading this text gives the same profile. With `sources` each value says where it is from."""
    provenance = Provenance(profile) if sources else None
    lines = [_line(0, f"name: {Text().write(profile.name)}", "what plans and programs call this profile")]
    for section in SECTIONS:
        lines += ["", f"{section}:", *_options(getattr(profile, section), 2, provenance, section)]
    lines += ["", *_python(profile), "", *_models(profile)]
    known = profile.known_rules()
    lines += ["", "rules:"]
    for name in sorted(profile.rules):
        lines += _rule(known[name], profile.rules[name], provenance)
    lines += ["", *_locks(profile.locks, sources)]
    own = [rule.plain() for rule in profile.own_rules]
    lines += ["", yaml.safe_dump({"own_rules": own}, allow_unicode=True, sort_keys=False).rstrip()]
    return "\n".join(lines) + "\n"


def _python(profile: Profile) -> Iterator[str]:
    written = ", ".join(Text().write(str(file.path)) for file in profile.python)
    yield _line(0, f"python: [{written}]", "files of rules in Python; they run only where they are trusted")


def _models(profile: Profile) -> Iterator[str]:
    written = ", ".join(Text().write(str(source.path)) for source in profile.models)
    yield _line(0, f"models: [{written}]", "files of rules in MiniZinc")


def _rule(rule: Rule[Any], setting: RuleSetting, provenance: Provenance | None = None) -> Iterator[str]:
    note = f" ({provenance.of(f'rules.{rule.id}')})" if provenance is not None else ""
    yield f"  # {rule.sentence}" + (f" From {rule.brought}." if rule.brought else "") + note
    yield f"  {rule.id}:"
    yield _line(4, f"strength: {setting.strength}", " | ".join(rule.strengths))
    if setting.weight is not None:
        yield _line(4, f"weight: {LENGTH.write(setting.weight)}", "cost of breaking it once, in idle travel")
    yield from _options(setting.options, 4, provenance, f"rules.{rule.id}", said_only=True)


def _options(
    owner: Any, indent: int, provenance: Provenance | None = None, path: str = "", said_only: bool = False
) -> Iterator[str]:
    """The options of a section, or of a rule or a group, which name their place only if somebody said them."""
    for option in options_of(owner):
        if isinstance(option.kind, Members):
            yield _line(indent, f"{option.key}:", option.help)
            yield from _options(getattr(owner, option.name), indent + 2, provenance, f"{path}.{option.key}", True)
            continue
        value = option.kind.write(getattr(owner, option.name))
        key = f"{path}.{option.key}"
        note = f"; {provenance.of(key)}" if provenance is not None and (provenance.says(key) or not said_only) else ""
        yield _line(indent, f"{option.key}: {value}", f"{option.help}{note}")


def _locks(locks: tuple[Lock, ...], sources: bool) -> Iterator[str]:
    yield "locks:" if locks else "locks: []"
    for lock in locks:
        yield _line(2, f"- {lock_text(lock)}", str(lock.place or "--lock")) if sources else f"  - {lock_text(lock)}"


def lock_text(lock: Lock) -> str:
    """A lock as a profile has it."""
    options = [(o.key, o.kind, getattr(lock, o.name)) for o in options_of(lock)]
    return f"{{{', '.join(f'{key}: {kind.write(value)}' for key, kind, value in options if value is not None)}}}"


def _line(indent: int, text: str, comment: str) -> str:
    return f"{' ' * indent + text:<{COMMENT_COLUMN}}  # {comment}"


# What two profiles say differently, key by key.

ABSENT = "-"
"""Where one of them has no such key."""


@dataclass(frozen=True, slots=True)
class Difference:
    """One key, such as `material.kerf`, its value in both as YAML, and where each has it from."""

    key: str
    a: str
    b: str
    a_from: str
    b_from: str


def differences(a: Profile, b: Profile) -> tuple[Difference, ...]:
    """Every key whose value differs, in the order of `profile show`; names and comments do not count.

    Examples
    --------
    >>> from kerfwise.rules.profile.load import load_profile
    >>> found = differences(load_profile("laser-wood"), load_profile("water-jet"))
    >>> next((one.a, one.b) for one in found if one.key == "machine.process")
    ('laser', 'water-jet')
    """
    first, second = dict(flat(a)), dict(flat(b))
    one, other = Provenance(a), Provenance(b)
    return tuple(
        Difference(key, first.get(key, ABSENT), second.get(key, ABSENT), _said(one, key), _said(other, key))
        for key in dict.fromkeys([*first, *second])
        if first.get(key) != second.get(key)
    )


def flat(profile: Profile) -> Iterator[tuple[str, str]]:
    """Every key of a profile with its value as YAML, nested keys joined by dots."""
    for section in SECTIONS:
        yield from _differing_options(getattr(profile, section), section)
    for name in sorted(profile.rules):
        setting = profile.rules[name]
        yield f"rules.{name}", setting.strength
        if setting.weight is not None:
            yield f"rules.{name}.weight", LENGTH.write(setting.weight)
        yield from _differing_options(setting.options, f"rules.{name}")
    for file in profile.python:
        yield f"python {file.path.name}", "named"
    for source in profile.models:
        yield f"models {source.path.name}", "named"
    for rule in profile.own_rules:
        yield f"own_rules {rule.name}", yaml.safe_dump(rule.plain(), width=1e9, default_flow_style=True).strip()
    for lock in profile.locks:
        yield f"locks {lock_text(lock)}", "locked"


def _differing_options(owner: Any, path: str) -> Iterator[tuple[str, str]]:
    for option in options_of(owner):
        value, key = getattr(owner, option.name), f"{path}.{option.key}"
        if isinstance(option.kind, Members):
            yield from _differing_options(value, key)
        else:
            yield key, option.kind.write(value)


def _said(sources: Provenance, key: str) -> str:
    """Where a key is from; what stands in lists has no place of its own."""
    return sources.of(key) if key.split(".")[0] in (*SECTIONS, "rules") else ABSENT


# Where each value of a profile comes from: a line of a file, a row of a material chart, or nobody has said it.


class Provenance:
    """Where the values of a profile come from, by such as `machine.home` and `rules.pierce`."""

    def __init__(self, profile: Profile) -> None:
        self._profile = profile
        taken = profile.chart.taken if profile.chart is not None else ()
        self._charted = {".".join(column_of(one.column).key): one for one in taken}

    def of(self, key: str) -> str:
        """Where a key has its value from, as a person reads it."""
        if key in self._charted:
            return self._row(self._charted[key])
        return self._profile.said_at.get(key, "default")

    def says(self, key: str) -> bool:
        """Whether a chart or a file, or the command line, gives a key."""
        return key in self._charted or key in self._profile.said_at

    def charted(self) -> Iterator[str]:
        """A sentence for each value that the chart has given."""
        for one in self._profile.chart.taken if self._profile.chart is not None else ():
            column = column_of(one.column)
            at = "" if column.angle_deg is None else f" at {column.angle_deg:g}°"
            yield f"{'.'.join(column.key)}{at}: {one.text}, {self._row(one)}"

    def _row(self, one: ChartValue) -> str:
        assert self._profile.chart is not None
        lines = " and ".join(map(str, one.lines))
        between = f", between {' and '.join(one.between)}" if one.between else ""
        return f"{self._profile.chart.file}:{lines}{between}"


# The text of a profile with other values of its rules: comments, order and spacing stay as they are written.

STRENGTH, WEIGHT = "strength", "weight"
RuleValue = tuple[str, str, str]
"""A rule, a key of it (`strength`, `weight` or an option), and the value as a profile has it."""
_BOM = "\ufeff"


def with_rule_values(text: str, values: Sequence[RuleValue]) -> str:
    """The text with values of rules set; a weight goes where its rule is no longer soft.

    Whether a profile may have these values is not looked at: see `expect_usable` in `apps/authoring/profile_check.py`.

    Raises InputError if the text is not YAML, a value is not, or the text is written so that a value cannot be set
    without changing another one, such as with an alias.

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
    before = _stated(text, *place)
    mapping = dict(before) if isinstance(before, dict) else {} if before is None else {STRENGTH: before}
    changed = text
    if isinstance(before, dict) or (before is None and key != STRENGTH):
        changed = with_value(changed, (*place, key), value.strip())
    elif key == STRENGTH:
        changed = with_value(changed, place, value.strip())
    else:
        changed = with_value(changed, place, f"{{{STRENGTH}: {_word(before)}, {key}: {value.strip()}}}")
    mapping[key] = wanted
    if key == STRENGTH and wanted != "soft" and WEIGHT in mapping:
        changed = without_value(changed, (*place, WEIGHT))
        del mapping[WEIGHT]
    _expect_only(text, changed, rule, mapping if isinstance(before, dict) or key != STRENGTH else wanted, what)
    return changed


def _word(value: Any) -> str:
    return "off" if value is False else str(value)


def _plain(value: str, what: str) -> Any:
    """The value as YAML has it."""
    node = compose(value, what) if value and "\n" not in value else None
    if node is None or is_empty(node):
        raise InputError(f"{what}: expected a value in one line, got {value!r}")
    return plain(node)


def _stated(text: str, *path: str) -> Any:
    root = compose(text, "")
    if root is None:
        return None
    holder = deepest(root, *path[:-1])
    node = deepest(root, *path)
    return None if node is holder or node is root else plain(node)


def _expect_only(before: str, after: str, rule: str, value: Any, what: str) -> None:
    """Make sure that what a profile says of one rule has changed, and nothing else."""
    wanted = _whole(before)
    rules = wanted.get("rules") or {}
    try:
        same = isinstance(rules, dict) and _whole(after) == {**wanted, "rules": {**rules, rule: value}}
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


_MOST_PLACES = 4
"""Places that a message names for a key."""
_ALIKE = 0.85
"""So much like a valid key of its section a key is a misspelling of that, whatever others there are."""
_LIKE_ELSEWHERE = 0.7
"""A key of another section is named only where it is as much like what stands there."""
_TOP = ("based_on", "locks", "models", "own_rules", "python", "rules")
"""Keys of a profile that are no sections."""


def where_it_belongs(key: str, valid: Sequence[str], rules: Mapping[str, Rule[Any]], section: str = "") -> str:
    """Where a profile has a key that is not valid where it stands, or one that is called nearly so; "" where nowhere.

    `section` is the one in which it stands: a key of a group of another section, as `colour` of `drawing.layers`, says
    too little by its name alone to be what was meant there.

    Examples
    --------
    >>> from kerfwise.rules.registry import RULES
    >>> where_it_belongs("kerf", ["travel"], RULES)
    "there is no key 'kerf' here, it belongs under material: {kerf: …}"
    """
    guess = nearest(key, valid)
    if guess is not None and (key in SECTIONS or SequenceMatcher(None, key, guess).ratio() > _ALIKE):
        return ""  # `machine` in prices is a beginning of machine_hour, not that section
    if places := where_keys_stand(key, rules, section):
        return f"there is no key {key!r} here, it belongs under {_either(places)}"
    guess = nearest(key, _every_key(rules)) if guess is None else None
    if guess is not None and SequenceMatcher(None, key, guess).ratio() < _LIKE_ELSEWHERE:
        return ""
    places = where_keys_stand(guess, rules, section) if guess is not None else ()
    return f"there is no key {key!r} here; did you mean {_either(places)}?" if places else ""


def _either(places: Sequence[str]) -> str:
    shown = places[:_MOST_PLACES]
    listed = " or ".join((", ".join(shown[:-1]), shown[-1])) if shown[1:] else shown[0]
    return listed + (", …" if len(places) > len(shown) else "")


def _every_key(rules: Mapping[str, Rule[Any]]) -> Iterator[str]:
    yield from rules
    owners = [*SECTIONS.values(), *(rule.Options for rule in rules.values())]
    for owner in owners:
        yield from (one.key for one in options_of(owner))
        owners += [one.kind.owner for one in options_of(owner) if isinstance(one.kind, Members)]


def where_keys_stand(key: str, rules: Mapping[str, Rule[Any]], section: str = "") -> tuple[str, ...]:
    """Every place where a profile has a key of this name, a section, an option or a rule, as YAML that leads there.

    With a `section`, of groups only those in it.

    Examples
    --------
    >>> from kerfwise.rules.registry import RULES
    >>> where_keys_stand("kerf", RULES), where_keys_stand("level-ahead", RULES), where_keys_stand("longest", RULES)
    (('material: {kerf: …}',), ('rules: {level-ahead: …}',), ('cuts: {links: {longest: …}}',))
    """
    found = [f"{key}: {{…}}" if key in SECTIONS else f"{key}: …"] if key in (*SECTIONS, *_TOP) else []
    found += [text for name, owner in SECTIONS.items() for text in _groups(name, owner, key, section in ("", name))]
    found += [f"rules: {{{key}: …}}"] if key in rules else []
    found += [f"rules: {{{name}: {{{key}: …}}}}" for name, rule in rules.items() if _has(rule.Options, key)]
    return tuple(found)


def _groups(name: str, owner: Any, key: str, deep: bool) -> Iterator[str]:
    for one in options_of(owner):
        if one.key == key:
            yield f"{name}: {{{key}: {'{…}' if isinstance(one.kind, Members) else '…'}}}"
        if deep and isinstance(one.kind, Members):
            yield from (f"{name}: {{{inner}}}" for inner in _groups(one.key, one.kind.owner, key, deep))


def _has(owner: Any, key: str) -> bool:
    return any(one.key == key for one in options_of(owner))


def where_said(profile: ProfileValues, *paths: tuple[str, ...]) -> Place | None:
    """Where the profile's file has the first of these keys that it has, else where one that it is based on has."""
    files = (profile.file, *reversed(profile.read_from))
    return next((place for file in files if file and (place := place_in(file, *paths)) is not None), None)
