"""What is set and locked for one nest only, and a profile with it, or with one rule switched on or off."""

from __future__ import annotations

import dataclasses
import hashlib
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nearest_name import nearest, unknown
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.yaml_positions import Place, Problems, compose, entries, is_empty
from kerfwise.rules.own import is_own, with_own_values
from kerfwise.rules.rule import Rule, RuleSetting, Strength

from .contradictions import rule_option_problems
from .load import parameters_of, profile_values, read_locks
from .profile import Profile
from .profile_yaml import where_it_belongs
from .sections import SECTIONS

SETTABLE = (*SECTIONS, "rules", "own_rules")
"""What a key that is set can begin with."""
COMMAND_LINE = "--set"
BOTH = "--set (in Python: settings)"
"""The option as the command line and as Python have it."""
_MAP, _STR = "tag:yaml.org,2002:map", "tag:yaml.org,2002:str"


@dataclass(frozen=True, slots=True)
class Setting:
    """A value of the profile that one nest has otherwise: its key, such as `rules.pierce.clearance`, and the value.

    `place` is where a job file says so; None for one of the command line.
    """

    key: str
    text: str
    node: yaml.Node = field(compare=False, repr=False)
    key_node: yaml.Node = field(compare=False, repr=False)
    place: Place | None = field(default=None, compare=False)

    def __str__(self) -> str:
        return f"{self.key}={self.text}"


def read_setting(text: str) -> Setting:
    """The setting of `KEY=VALUE`, the value as a profile has it.

    Raises InputError if it is not of this form.

    Examples
    --------
    >>> setting = read_setting("rules.pierce.clearance=1.48 mm")
    >>> setting.key, setting.text
    ('rules.pierce.clearance', '1.48 mm')
    """
    key, sign, value = (part.strip() for part in text.partition("="))
    if not sign or not key or not value:
        raise InputError(f"{BOTH} {text!r}: expected KEY=VALUE, such as leads.lead_in=4mm")
    try:
        node = compose(value, COMMAND_LINE)
    except InputError as error:
        raise InputError(f"{BOTH} {text!r}: {error.message}") from None
    if node is None:
        raise InputError(f"{BOTH} {text!r}: expected a value after =")
    return Setting(key, value, node, yaml.ScalarNode(_STR, key, node.start_mark, node.end_mark))


def read_settings(node: yaml.Node, problems: Problems) -> tuple[Setting, ...]:
    """The settings of a mapping of keys with dots, or of one as deep as a profile."""
    found = []
    for key, key_node, value in entries(node, problems, "set"):
        if is_empty(value):
            problems.add(key_node, f"set: expected a value for {key!r}, such as leads.lead_in: 4 mm")
        else:
            found.append(Setting(key, _one_line(value), value, key_node, problems.place(key_node)))
    return tuple(found)


def with_settings(profile: Profile, settings: Sequence[Setting], file: str = COMMAND_LINE) -> Profile:
    """The profile with what is set in the place of its own values; all is checked as if the profile said it.

    Raises InputError if a key or a value is wrong: with its place in `file`.
    """
    if not settings:
        return profile
    problems = Problems(file)
    own = [(setting.key, setting.key_node, setting.node) for setting in settings if is_own(setting.key)]
    nested = [setting for setting in settings if not is_own(setting.key)]
    root = _nested(nested, settings[0].key_node, problems, profile.known_rules())
    start = {f.name: getattr(profile, f.name) for f in dataclasses.fields(profile)}
    start["own_rules"] = with_own_values(profile.own_rules, own, problems, parameters_of)
    try:
        problems.raise_any()
        values = profile_values(root, problems, start, _no_base)
    except InputError as error:
        if file != COMMAND_LINE:
            raise
        others = (text.split(": ", 1)[-1] for text in error.details)
        message = "; ".join(text.removeprefix("set: ") for text in (error.message, *others))
        raise InputError(f"{BOTH}: {message}") from None
    if file == COMMAND_LINE:
        values["said_at"] = {key: _without_line(at) for key, at in values["said_at"].items()}
    return dataclasses.replace(profile, **values)


def _no_base(name: str) -> dict[str, Any]:
    raise AssertionError(name)  # `based_on` is no key that can be set


def _without_line(at: str) -> str:
    return COMMAND_LINE if at.startswith(f"{COMMAND_LINE}:") else at


def _one_line(node: yaml.Node) -> str:
    return str(node.value) if isinstance(node, yaml.ScalarNode) else " ".join(yaml.serialize(node).split())


class _Tree(dict[str, "tuple[yaml.Node, _Tree | yaml.Node]"]):
    """Key → where it stands, and what stands under it."""


def _nested(
    settings: Iterable[Setting], at: yaml.Node, problems: Problems, known: Mapping[str, Rule[Any]]
) -> yaml.Node:
    """Settings as the YAML of a profile."""
    tree = _Tree()
    for setting in settings:
        path = setting.key.split(".")
        if path[0] not in SETTABLE:
            wrong = where_it_belongs(path[0], SETTABLE, known) or unknown("key", path[0], SETTABLE)
            problems.add(setting.key_node, f"set: {wrong}")
        else:
            _put(tree, path, setting.key_node, setting.node, setting.key, problems)
    return _mapping(tree, at)


def _put(
    tree: _Tree,
    path: Sequence[str],
    key_node: yaml.Node,
    value: yaml.Node,
    text: str,
    problems: Problems,
    depth: int = 1,
) -> None:
    """Put a value where its path leads to; mappings are put key by key, as deep as profiles have keys."""
    name, rest = path[0], path[1:]
    members = value.value if isinstance(value, yaml.MappingNode) and not rest and depth < _DEEPEST else ()
    if not rest and not (members and all(isinstance(key, yaml.ScalarNode) for key, _ in members)):
        if name in tree:
            problems.add(key_node, f"set: {text} is set twice")
        tree[name] = (key_node, value)
        return
    _, under = tree.setdefault(name, (key_node, _Tree()))
    if not isinstance(under, _Tree):
        problems.add(key_node, f"set: {text} is set twice: once with all that is under {name!r}")
        return
    for steps, at, node in [(rest, key_node, value)] if rest else [([k.value], k, v) for k, v in members]:
        _put(under, steps, at, node, text if rest else f"{text}.{steps[0]}", problems, depth + 1)


_DEEPEST = 3
"""Keys in a row, as in `drawing.layers.cut`."""


def _mapping(tree: _Tree, at: yaml.Node) -> yaml.Node:
    members = []
    for name, (key_node, under) in tree.items():
        key = yaml.ScalarNode(_STR, name, key_node.start_mark, key_node.end_mark)
        members.append((key, _mapping(under, key_node) if isinstance(under, _Tree) else under))
    return yaml.MappingNode(_MAP, members, at.start_mark, at.end_mark)


# A profile with one rule switched on or off: what that rule costs is seen by planning with it and without.


def with_rule(profile: Profile, name: str, strength: Strength | None = None) -> Profile:
    """The profile with a rule on: as strong as is said, else as it was, else as it is by default, else hard.

    Its sha256 is another, for it is not the profile of the file any more.

    Raises InputError for a rule that there is not, with the nearest name, a strength that it cannot have, or options of
    the rule that contradict the rest of the profile.

    Examples
    --------
    >>> from kerfwise.rules.profile.load import load_profile
    >>> without_rule(load_profile(), "level-ahead").rules["level-ahead"].strength
    'off'
    """
    book = profile.rulebook()
    _expect_known(profile, name)
    rule = book[name]
    now = profile.settings()[name].strength if name in profile.settings() else "off"
    chosen = strength or (now if now != "off" else _usual(rule))
    if chosen not in rule.strengths:
        raise InputError(f"rule {name} cannot be {chosen}: it can be {', '.join(rule.strengths)}")
    changed = _with_strength(profile, name, chosen)
    found = rule_option_problems(changed.plant, changed.rules, changed.known_rules())
    wrong = [f"rules.{name}.{key}: {text}" for of, key, text in found if of == name]
    if wrong:
        raise InputError("; ".join(wrong))
    return changed


def without_rule(profile: Profile, name: str) -> Profile:
    """The profile with a rule off; see `with_rule`."""
    return with_rule(profile, name, "off")


def _expect_known(profile: Profile, name: str) -> None:
    known = profile.rulebook()
    if name not in known:
        raise InputError(unknown("rule", name, known))


def _usual(rule: Rule[Any]) -> Strength:
    if rule.default != "off":
        return rule.default
    return "hard" if "hard" in rule.strengths else "soft"


def _with_strength(profile: Profile, name: str, strength: Strength) -> Profile:
    sha256 = hashlib.sha256(f"{profile.sha256}\n{name} {strength}".encode()).hexdigest()
    if name not in profile.rules:
        own = tuple(_own(rule, strength) if rule.id == name else rule for rule in profile.own_rules)
        return replace(profile, own_rules=own, sha256=sha256)
    before = profile.rules[name]
    weight = None
    if strength == "soft":
        weight = profile.known_rules()[name].default_weight if before.weight is None else before.weight
    rules = {**profile.rules, name: RuleSetting(strength, weight, before.options)}
    return replace(profile, rules=rules, sha256=sha256)


def _own(rule: Any, strength: Strength) -> Any:
    weight = None
    if strength == "soft":
        weight = Rule.default_weight if rule.weight is None else rule.weight
    return replace(rule, strength=strength, weight=weight)


_QUOTED = r'"(?:[^"]|"")*"'
_WORD = re.compile(_QUOTED + r'|[(\[][^)\]]*[)\]]|[^\s"(\[]\S*|\S')
_NTH = re.compile(r"([1-9]\d{0,8})(?:st|nd|rd|th)")
_NUMBERED = re.compile(r"^locks\[1\](\.|: )")
_BY_ITSELF = {"first": "position", "last": "position", "cw": "direction", "ccw": "direction"}
"""Words that say all by themselves, and the key of a lock that they stand for."""
_WITH_VALUE = {
    "position": "first, last or a position counted from 1",
    "direction": "cw or ccw",
    "linked": "false",
    "zone": "a number",
    "entry": "a point such as (10, 20)",
    "tab": "a point such as (10, 20), or off",
}
"""Keys that a value follows, and what that is."""
_WITH_NAME = ("before", "after")
_DECISIONS = (*_BY_ITSELF, *_WITH_VALUE, *_WITH_NAME)
_RULED_OUT = {"link": ("linked", "false"), "tab": ("tab", "off")}
"""What can follow `no`, and the key and value that it stands for."""
EXPECTED = (
    "expected ID before ID, ID after ID, ID first, ID last, ID 5th, ID entry (X, Y), ID cw, ID ccw, no link ID, "
    "ID tab (X, Y), no tab ID or PART in zone N, where ID is a contour, a part, or #7 for cut 7 of the last plan; or a "
    "mapping such as {contour: P1.outer, before: P2.outer}"
)


def read_lock(text: str) -> Lock:
    """The lock that a line of text stands for, with the names as they are written; or that of a YAML mapping.

    Names that hold blanks and a word of the language stand in double quotes; in them a double quote is written twice.

    Raises InputError with the text, the word that is wrong, and what was expected.

    Examples
    --------
    >>> read_lock("P1.outer before P2.outer") == Lock(contour="P1.outer", before="P2.outer")
    True
    >>> read_lock("P1.outer last").position, read_lock("P1.outer 5th").position, read_lock("no link P1").linked
    ('last', 5, False)
    >>> read_lock("P1.outer entry (10, 20.5)").entry, read_lock('"last one" tab off').contour
    ((10.0, 20.5), 'last one')
    >>> read_lock('"3"" pipe" first').contour
    '3" pipe'
    >>> read_lock("P1 in zone 2") == read_lock("{part: P1, zone: 2}")
    True
    """
    problems = Problems("")
    try:
        node = compose(text, "") if text.lstrip().startswith("{") else _lock_mapping(*_said(_WORD.findall(text)))
        if not isinstance(node, yaml.MappingNode):
            raise InputError(EXPECTED)
        locks = read_locks(yaml.SequenceNode("tag:yaml.org,2002:seq", [node], node.start_mark), problems)
        problems.raise_any()
    except InputError as error:
        raise InputError(f"lock {text!r}: {_NUMBERED.sub('', error.message)}") from None
    return replace(locks[0], place=None)


def lines_of(lock: Lock) -> Iterator[str]:
    """A lock in lines that read back as it, one for each thing that it decides.

    Examples
    --------
    >>> list(lines_of(Lock(contour="P1.outer", position="first", direction="cw", entry=(1.0, 2.5))))
    ['P1.outer first', 'P1.outer entry (1, 2.5)', 'P1.outer cw']
    """
    name = _written(lock.contour or lock.part or "")
    if lock.before is not None:
        yield f"{name} before {_written(lock.before)}"
    if lock.position is not None:
        yield f"{name} {lock.position}" if isinstance(lock.position, str) else f"{name} position {lock.position}"
    if lock.entry is not None:
        yield f"{name} entry {_point(lock.entry)}"
    if lock.direction is not None:
        yield f"{name} {lock.direction}"
    if lock.linked is not None:
        yield f"no link {name}"
    if lock.tab is not None:
        yield f"no tab {name}" if lock.tab == "off" else f"{name} tab {_point(lock.tab)}"
    if lock.zone is not None:
        yield f"{name} in zone {lock.zone}"


def _said(words: Sequence[str]) -> tuple[str, str, str]:
    """Name, key of a lock, and its value, of a line in words."""
    if len(words) > 2 and words[0] == "no" and words[1] in _RULED_OUT:
        return _name(words[2:]), *_RULED_OUT[words[1]]
    for at in range(1, len(words)):
        word, name, rest = words[at], _name(words[:at]), words[at + 1 :]
        if word in _BY_ITSELF or _NTH.fullmatch(word):
            if rest:
                raise InputError(f"nothing more was expected after {word!r}, got {' '.join(rest)!r}")
            nth = _NTH.fullmatch(word)
            return name, ("position" if nth else _BY_ITSELF[word]), (nth[1] if nth else word)
        if word in _WITH_NAME:
            if not rest:
                raise InputError(f"expected a contour, a part or #7 after {word!r}")
            return (name, "before", _name(rest)) if word == "before" else (_name(rest), "before", name)
        if word == "in" and rest[:1] == ["zone"]:
            word, rest = "zone", rest[1:]
        if word in _WITH_VALUE:
            return name, word, _value(word, rest)
    raise InputError(_says_nothing(words))


def _value(word: str, rest: Sequence[str]) -> str:
    if rest[:1] == ["at"] and word in ("entry", "tab"):
        rest = rest[1:]
    if not rest:
        raise InputError(f"expected {_WITH_VALUE[word]} after {word!r}")
    if len(rest) > 1:
        raise InputError(f"expected {_WITH_VALUE[word]} after {word!r}, got {' '.join(rest)!r}")
    return rest[0]


def _says_nothing(words: Sequence[str]) -> str:
    """A message for a line without any word that decides something; a name alone is answered with all there are."""
    if len(words) < 2:
        return EXPECTED
    guesses = ((word, nearest(word, _DECISIONS)) for word in words[1:])
    word, guess = next((found for found in guesses if found[1] is not None), (words[-1], None))
    hint = f"{word!r}: did you mean {guess!r}? " if guess else f"{word!r} decides nothing: "
    return hint + EXPECTED


def _name(words: Sequence[str]) -> str:
    """The name that words are: one in double quotes stands for what is between them."""
    name = " ".join(words)
    return name[1:-1].replace('""', '"') if re.fullmatch(_QUOTED, name) else name


def _written(name: str) -> str:
    """A name so that it is read as one."""
    words = _WORD.findall(name)
    plain = " ".join(words) == name and not any(word in (*_DECISIONS, "no", "in") for word in words)
    plain = plain and not any(_NTH.fullmatch(word) for word in words) and not name.startswith(("{", '"', "(", "["))
    doubled = name.replace('"', '""')
    return name if plain and name else f'"{doubled}"'


def _point(point: Point) -> str:
    return "(" + ", ".join(repr(int(v) if v == int(v) else v) for v in point) + ")"


def _lock_mapping(name: str, key: str, value: str) -> yaml.Node:
    """The YAML of a line; a name may hold what YAML would want quoted."""
    start = yaml.Mark("", 0, 0, 0, "", 0)

    def scalar(text: str) -> yaml.Node:
        return yaml.ScalarNode("tag:yaml.org,2002:str", text, start, start)

    point = key in ("entry", "tab") and value.startswith(("(", "["))
    node = compose(f"[{value[1:-1]}]", "") if point else scalar(value)
    members = [(scalar("part" if key == "zone" else "contour"), scalar(name)), (scalar(key), node)]
    return yaml.MappingNode("tag:yaml.org,2002:map", members, start, start)
