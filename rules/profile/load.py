"""Profiles read from their files: shipped ones by name, a plant's own by path, with every mistake found and placed."""

from __future__ import annotations

import dataclasses
import hashlib
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import yaml

from kerfwise.encoder.errors import InputError, rule_hook
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, is_file, is_there, read_limited, utf8_text
from kerfwise.encoder.nearest_name import nearest, unknown
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.kind import Choice, OptionKind, Text, noting
from kerfwise.rules.options.option import Members, options_of
from kerfwise.rules.options.quantities import WEIGHT
from kerfwise.rules.options.yaml_positions import Problems, compose, entries, is_empty, items
from kerfwise.rules.outside import installed_rules
from kerfwise.rules.own import OwnFile, read_own_rules
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule

from .active_rules import own_model_rule
from .contradictions import check_together
from .linked_files import with_chart, with_dialect_beside, with_model_files, with_python_files
from .plant_sections import is_own_dialect, kept_of_thickness
from .profile import Profile
from .profile_yaml import where_it_belongs
from .sections import SECTIONS, RuleSetting, default_settings, named_in_group
from .time_section import LawLeft, Time

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


DEFAULT = "plasma-carbon-steel"
"""The shipped profile that is used where none is named."""
SHIPPED = "kerfwise/rules/profile/shipped/"
"""What the names of shipped profiles' files begin with in messages."""
LONGEST_CHAIN = 20


def load_profile(name_or_path: str | Path = DEFAULT, *, trust: bool = False) -> Profile:
    """The shipped profile of that name, or the one in that file.

    `trust` lets it run the Python files that it names; without it only those run that the machine's configuration
    allows, see `rules/outside/__init__.py`.

    Raises InputError if there is none, or it has a wrong key, type or value: with file, line, column, what was
    expected, and the nearest valid name. All mistakes of a file are reported at once. Also if a rule that a package or
    a Python file brings cannot be used, or the profile names a Python file that is not trusted.
    """
    return _load(str(name_or_path), Path(), (), trust)


def _load(name: str, folder: Path, chain: tuple[str, ...], trust: bool) -> Profile:
    file, place, content = content_of(name, folder)
    if file in chain:
        raise InputError(f"it goes in a circle: {' → '.join((*chain, file))}")
    if len(chain) >= LONGEST_CHAIN:
        raise InputError(f"more than {LONGEST_CHAIN} profiles are based on each other in a row")
    text = utf8_text(content, "a profile", file)
    bases: list[str] = []

    def base(of: str) -> ProfileValues:
        values = _load(of, Path(file).parent, (*chain, file), trust)
        bases.append(values.sha256)
        return _fields(values)

    read_values = read_profile_values(text, file, _fields(_silent(escape_text(Path(file).stem))), base, trust)
    read_from = (*read_values.get("read_from", ()), place)
    profile = Profile(**read_values | {"file": file, "read_from": read_from})
    return dataclasses.replace(profile, sha256=digest_of(content, profile, bases))


def _silent(name: str) -> Profile:
    """A profile that says nothing: the rules of installed packages are known, and off."""
    installed = installed_rules()
    off = {name: RuleSetting("off", None, rule.Options()) for name, rule in installed.items()}
    return Profile(name, rules=default_settings() | off, further_rules=installed)


def _fields(profile: Profile) -> ProfileValues:
    return {f.name: getattr(profile, f.name) for f in dataclasses.fields(profile)}


# Where profiles stand: those that come with kerfwise, by name, and others in files; their bytes and their text.


def shipped_profiles() -> dict[str, Traversable]:
    """Name → file of the profiles that come with kerfwise, sorted."""
    folder = resources.files(__package__) / "shipped"
    found = {f.name.removesuffix(".yaml"): f for f in folder.iterdir() if f.name.endswith(".yaml")}
    return dict(sorted(found.items()))


def profile_text(name_or_path: str | Path) -> str:
    """The text of the shipped profile of that name, or of the one in that file, comments and all.

    Raises InputError if there is none, or it is not UTF-8.
    """
    file, _, content = content_of(str(name_or_path), Path())
    return utf8_text(content, "a profile", file)


def _meant(path: Path) -> str:
    """A hint at the file beside it that is called nearly so; "" where there is none."""
    try:
        beside = [file.name for file in path.parent.iterdir() if file.suffix in (".yaml", ".yml")]
    except OSError:
        return ""
    stems = {Path(name).stem: name for name in sorted(beside, reverse=True)}  # endings are alike whatever was meant
    guess = None if path.name in beside else nearest(path.stem, stems)
    return f"; did you mean {stems[guess]!r}?" if guess else ""


def content_of(name: str, folder: Path) -> tuple[str, str, bytes]:
    """File name, place and bytes of a profile given by shipped name or path."""
    shipped = shipped_profiles()
    if name in shipped:
        return f"{SHIPPED}{name}.yaml", str(shipped[name]), shipped[name].read_bytes()
    path = folder / name
    try:
        return str(path), str(path), read_limited(path, MOST_BYTES_OF_YAML)
    except ValueError as error:  # a NUL, or half a character
        raise InputError(f"cannot read the profile: no file can have this name ({error})", file=path) from None
    except OSError as error:
        if path.suffix or len(Path(name).parts) > 1:
            raise InputError(f"cannot read the profile: {error.strerror}{_meant(path)}", file=path) from None
        beside = Path(f"{path}.yaml")
        hint = f"; there is a file {beside.name}: give its ending too" if is_there(beside) else ""
        raise InputError(unknown("profile", name, shipped) + hint) from None


def files_of(profile: Profile) -> tuple[Path, ...]:
    """Every file that a profile is made of: its own, those it is based on, its dialect's, its chart, its rules'.

    A job file that is laid over it is one of them.
    """
    dialect = (profile.machine.dialect,) if is_own_dialect(profile.machine.dialect) else ()
    chart = (profile.chart.file,) if profile.chart is not None else ()
    rules = (rule.path for rule in profile.own_rules if isinstance(rule, OwnFile))
    python = (file.path for file in profile.python)
    models = (source.path for source in profile.models)
    return (*map(Path, profile.read_from), *map(Path, (*dialect, *chart)), *rules, *python, *models)


def digest_of(content: bytes, profile: Profile, bases: Sequence[str]) -> str:
    """The sha256 of a profile's text and of all files that it is made of.

    These are the profiles that it is based on, its chart, its dialect, and rules of its own that stand in files, on or
    off. A profile that names none of them has that of its text.
    """
    rules = [
        *profile.known_rules().values(),
        *(own_model_rule(own) for own in profile.own_rules if isinstance(own, OwnFile)),
    ]
    of_files = [rule.stands_in.sha256 for rule in rules if rule.stands_in is not None]
    of_files += [f"based on {sha256}" for sha256 in bases]
    if profile.chart is not None:
        of_files.append(f"chart {profile.chart.sha256}")
    if is_own_dialect(profile.machine.dialect) and is_file(profile.machine.dialect):
        of_files.append(f"dialect {hashlib.sha256(read_limited(profile.machine.dialect)).hexdigest()}")
    text = hashlib.sha256(content).hexdigest()
    return hashlib.sha256("\n".join([text, *of_files]).encode()).hexdigest() if of_files else text


def parameters_of(path: Path) -> dict[str, OptionKind]:
    """The parameters that the rule in a model file declares, by key.

    Raises InputError if the file is no rule.
    """
    from kerfwise.rules.flat.model_file import read_model_file
    from kerfwise.rules.flat.model_rule import options_class

    return {o.key: o.kind for o in options_of(options_class(read_model_file(path).parameters))}


# A profile's YAML read into values, with every mistake found and placed.

ProfileValues = dict[str, Any]
T = TypeVar("T", bound="DataclassInstance")
_LAW_KEYS = ("time.model", "time.feed_by_blocks")
KEYS = ("name", "based_on", *SECTIONS, "python", "models", "rules", "own_rules", "locks")


def read_profile_values(
    text: str, file: str, start: ProfileValues, load_base: Callable[[str], ProfileValues], trust: bool = False
) -> ProfileValues:
    """The fields of a profile: those of `start`, or of the one it is based on, with what the text gives in their place.

    `trust` lets Python files run that the text names.

    Raises InputError if the text is not YAML, or has a wrong key, type or value anywhere.
    """
    return profile_values(compose(text, file), Problems(file), start, load_base, trust)


def profile_values(
    root: yaml.Node | None,
    problems: Problems,
    start: ProfileValues,
    load_base: Callable[[str], ProfileValues],
    trust: bool = False,
) -> ProfileValues:
    """The same of YAML that is read already."""
    known = RULES | start["further_rules"]
    found = _top_level(root, problems, known)
    values = dict(start)
    if "based_on" in found:
        values |= _base(found["based_on"], problems, load_base) | {"name": start["name"]}
    measured_mm_s, start_mm = values["machine"].cut_feed_mm_s, values["material"].thickness_mm
    if "name" in found:
        values["name"] = escape_text(Text().read_or_note(found["name"], problems, "name") or "")
    for section in SECTIONS:
        if section in found:
            members = with_new_names(section, list(entries(found[section], problems, section)), problems)
            stand = partial(where_it_belongs, rules=known, section=section)
            values[section] = read_fields(members, values[section], problems, section, elsewhere=stand)
    values = with_dialect_beside(found.get("machine"), values, problems)
    if not problems.found:
        values = with_chart({section: found[section] for section in SECTIONS if section in found}, values, problems)
    for key, with_files in (("python", partial(with_python_files, trust=trust)), ("models", with_model_files)):
        try:
            values |= with_files(found[key], values, problems) if key in found else {}
        except InputError as error:
            problems.elsewhere.append(error)
    if "rules" in found and not problems.elsewhere:  # else nobody knows all rules
        values["rules"] = read_rules(found["rules"], values["rules"], problems, RULES | values["further_rules"])
    if "locks" in found:
        values["locks"] = read_locks(found["locks"], problems)
    if "own_rules" in found:
        values["own_rules"] = read_own_rules(found["own_rules"], problems, parameters_of)
    places = _places(found, problems.file)
    values["said_at"] = {**values["said_at"], **places}
    values |= _timed_at(measured_mm_s, values, places)
    values["kept"] = kept_of_thickness(start_mm, values, places)
    if root is not None and not problems.elsewhere:
        check_together(values, root, problems)
    problems.raise_any()
    return values


def _timed_at(measured_mm_s: float, values: Mapping[str, Any], places: Mapping[str, str]) -> ProfileValues:
    """How times are told: a feed law that is inherited holds for the feed that it was measured for.

    With another feed the torch moves at that one, and speeds up and slows down, unless the file says itself by which
    model or law; `places` are of what it says.
    """
    time: Time = values["time"]
    if any(key in places for key in _LAW_KEYS):
        return {"law_left": None}
    if time.model != "blocks" or math.isclose(values["machine"].cut_feed_mm_s, measured_mm_s, rel_tol=1e-6):
        return {}
    law = time.feed_by_blocks
    left = LawLeft("" if law is None else law.name, measured_mm_s)
    said_at = {key: at for key, at in values["said_at"].items() if key not in _LAW_KEYS}
    if by := said_at.get("machine.cut_feed"):
        said_at |= dict.fromkeys(_LAW_KEYS, by)
    timed = dataclasses.replace(time, model="acceleration", feed_by_blocks=None)
    return {"time": timed, "law_left": left, "said_at": said_at}


def _top_level(root: yaml.Node | None, problems: Problems, known: Mapping[str, Rule[Any]]) -> dict[str, yaml.Node]:
    found = {}
    for key, key_node, value in entries(root, problems, "profile") if root is not None else ():
        if key in KEYS:
            found[key] = value
        else:
            problems.add(key_node, where_it_belongs(key, KEYS, known) or unknown("key", key, KEYS))
    return found


def _places(found: Mapping[str, yaml.Node], file: str) -> dict[str, str]:
    """Where each key of a section stands, each rule, and what is under it, by such as `rules.pierce.clearance`."""
    places: dict[str, str] = {}
    nodes = [(section, node) for section, node in found.items() if section in (*SECTIONS, "rules")]
    while nodes:
        path, node = nodes.pop()
        for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
            places[f"{path}.{key.value}"] = f"{file}:{key.start_mark.line + 1}"
            if "." not in path:  # no deeper: an alias may lead back
                nodes.append((f"{path}.{key.value}", value))
    return places


def _base(node: yaml.Node, problems: Problems, load_base: Callable[[str], ProfileValues]) -> ProfileValues:
    name = Text().read_or_note(node, problems, "based_on")
    if name is None:
        return {}
    try:
        return load_base(name)
    except InputError as error:
        if error.line is not None:
            problems.elsewhere.append(error)
        else:
            problems.add(node, f"based_on: {error}")
        return {}


def read_fields(
    members: Iterable[tuple[str, yaml.Node, yaml.Node]],
    base: T,
    problems: Problems,
    what: str,
    other: Iterable[str] = (),
    elsewhere: Callable[[str, Sequence[str]], str] = lambda key, valid: "",
) -> T:
    """The dataclass `base` with the options that a mapping gives; `other` are valid keys that are read elsewhere.

    `elsewhere` says where else a profile has a key that is none of these.
    """
    options = {option.key: option for option in options_of(base)}
    values: ProfileValues = {}
    for key, key_node, value in members:
        if key not in options:
            valid = [*options, *other]
            comma = "; decimals are written with a point" if key[:1].isdigit() and is_empty(value) else ""
            problems.add(key_node, f"{what}: {elsewhere(key, valid) or unknown('key', key, valid)}{comma}")
            continue
        if isinstance(options[key].kind, Members):
            inner = list(entries(value, problems, f"{what}.{key}"))
            old = getattr(base, options[key].name)
            group = read_fields(inner, old, problems, f"{what}.{key}", elsewhere=elsewhere)
            values[options[key].name] = named_in_group(group, [name for name, _, _ in inner])
            continue
        with noting(problems, value, f"{what}.{key}"):
            values[options[key].name] = options[key].kind.read(value)
    return dataclasses.replace(base, **values)


def read_rules(
    node: yaml.Node, base: Mapping[str, RuleSetting], problems: Problems, known: Mapping[str, Rule[Any]]
) -> dict[str, RuleSetting]:
    """Every rule's setting: that of `base`, with what the mapping under `rules` gives in its place."""
    settings = dict(base)
    for name, key_node, value in entries(node, problems, "rules"):
        if name in known:
            with rule_hook(known[name], "its options"):
                settings[name] = _read_rule(value, known[name], settings[name], problems)
        else:
            wrong = where_it_belongs(name, list(known), known, "rules") or unknown("rule", name, known)
            problems.add(key_node, f"rules: {wrong}")
    return settings


def _read_rule(node: yaml.Node, rule: Rule[Any], base: RuleSetting, problems: Problems) -> RuleSetting:
    what = f"rules.{rule.id}"
    if not isinstance(node, yaml.MappingNode):
        strength = Choice(rule.strengths).read_or_note(node, problems, what) or base.strength
        return RuleSetting(strength, _weight(rule, strength, base.weight), base.options)
    members = list(entries(node, problems, what))
    values = {key: value for key, _, value in members if key in ("strength", "weight")}
    strength, weight = base.strength, base.weight
    if "strength" in values:
        strength = Choice(rule.strengths).read_or_note(values["strength"], problems, f"{what}.strength") or strength
    if "weight" in values:
        weight = WEIGHT.read_or_note(values["weight"], problems, f"{what}.weight")
        if strength != "soft":
            problems.add(values["weight"], f"{what}.weight: only a soft rule has a weight, this one is {strength}")
    if not members and strength == "off":
        problems.add(node, f"{what}: the rule is off, and nothing is said of it: {_say_strength(rule)}")
    rest = [member for member in members if member[0] not in values]
    others = {name: other for name, other in RULES.items() if name != rule.id}
    stand = partial(where_it_belongs, rules=others, section="rules")
    options = read_fields(rest, base.options, problems, what, other=("strength", "weight"), elsewhere=stand)
    if rule.brought and rest and strength == "off" and "strength" not in values:
        problems.add(node, f"{what}: rules from outside are off unless a profile says otherwise: {_say_strength(rule)}")
    return RuleSetting(strength, _weight(rule, strength, weight), options)


def _say_strength(rule: Rule[Any]) -> str:
    return f"give its strength too, one of {', '.join(rule.strengths)}"


def _weight(rule: Rule[Any], strength: str, weight: float | None) -> float | None:
    if strength != "soft":
        return None
    return rule.default_weight if weight is None else weight


def read_locks(node: yaml.Node, problems: Problems) -> tuple[Lock, ...]:
    """The locks of a profile, each a mapping of a contour or part and what is decided of it."""
    locks = []
    for number, entry in enumerate(items(node, problems, "locks"), 1):
        what = f"locks[{number}]"
        so_far = len(problems.found)
        lock = read_fields(entries(entry, problems, what), Lock(place=problems.place(entry)), problems, what)
        if len(problems.found) == so_far and (wrong := lock.wrong()):
            problems.add(entry, f"{what}: {wrong}")
        locks.append(lock)
    return tuple(locks)


# Keys that have moved: a profile written before still reads the same.

MOVED: Mapping[str, Mapping[str, tuple[str, str]]] = {
    "drawing": {"sheet_layer": ("layers", "sheet"), "mark_layer": ("layers", "mark")},
}
"""Section → its older key → the group it is in now, and its key there."""

KeyedNode = tuple[str, yaml.Node, yaml.Node]


def with_new_names(section: str, members: Sequence[KeyedNode], problems: Problems) -> list[KeyedNode]:
    """The keys and values of a section with each older key where it belongs now; a value given twice is a problem."""
    moved = MOVED.get(section, {})
    kept = [member for member in members if member[0] not in moved]
    for key, key_node, value in members:
        if key not in moved:
            continue
        group, name = moved[key]
        if not any(k == group for k, _, _ in kept):
            start, end = key_node.start_mark, value.end_mark
            kept.append((group, key_node, yaml.MappingNode("tag:yaml.org,2002:map", [], start, end)))
        [(at, group_key, inner)] = [(at, at_key, node) for at, (k, at_key, node) in enumerate(kept) if k == group]
        if not isinstance(inner, yaml.MappingNode):
            continue  # `read_fields` reports it
        if any(k.value == name for k, _ in inner.value):
            problems.add(
                key_node, f"{section}.{key}: this is {section}.{group}.{name} now, which is given too; keep one"
            )
            continue
        node = yaml.ScalarNode("tag:yaml.org,2002:str", name, key_node.start_mark, key_node.end_mark)
        both = [*inner.value, (node, value)]  # in a node of its own: a text that is read again has the same nodes
        kept[at] = (group, group_key, yaml.MappingNode(inner.tag, both, inner.start_mark, inner.end_mark))
    return kept
