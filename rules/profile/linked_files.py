"""What a profile takes from other files: values of a material chart, rules in MiniZinc and Python."""

from __future__ import annotations

import dataclasses
import glob
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import expect_readable, is_file
from kerfwise.rules.charts import Found, LookedUp, NoRow, look_up, read_chart, shipped_charts
from kerfwise.rules.charts.chart import COLUMNS, Column, column_of, family_of, same_value, value_text
from kerfwise.rules.options.kind import Text, noting
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.yaml_positions import Place, Problems, deepest, items, wrong_at
from kerfwise.rules.outside import PythonFile, is_trusted, refusal, rules_in_file
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule, RuleSetting

from .plant_sections import Material, is_own_dialect

if TYPE_CHECKING:
    from kerfwise.rules.flat.model_rule import ModelRule

# Files of rules that a profile names, as its keys `models` and `python` do.

GivenFiles = dict[str, Any]
"""Fields of a profile that such files fill: the files themselves, `further_rules` and `rules`."""


def names_of_files(node: yaml.Node, key: str, problems: Problems) -> Iterator[tuple[str, yaml.Node]]:
    """Every name under a key, one alone or a list of them, and where it stands."""
    for entry in [node] if isinstance(node, yaml.ScalarNode) and node.value else items(node, problems, key):
        with noting(problems, entry, key):
            yield Text().read(entry), entry


WHAT = "rules in MiniZinc files beside the profile, such as plant/*.mzn; one named as a shipped rule takes its place"


@dataclass(frozen=True, slots=True)
class ModelSource:
    """A model file that a profile names, alone or by a pattern."""

    path: Path
    place: Place | None = field(default=None, compare=False)


def with_model_files(node: yaml.Node, files: GivenFiles, problems: Problems) -> GivenFiles:
    """The fields `models`, `further_rules` and `rules` of a profile, with the rules of the files that a node names.

    A new rule is hard until `rules` says otherwise; one in the place of a shipped rule has that one's strength. Files
    of a profile that this one is based on stay; a file of the same name takes their place.
    """
    from kerfwise.rules.flat.model_rule import ModelRule, read_model_rule

    sources = {source.path.name: source for source in files["models"]}
    rules: dict[str, Rule[Any]] = dict(files["further_rules"])
    settings: dict[str, RuleSetting] = dict(files["rules"])
    taken: dict[str, ModelRule] = {}
    for path, entry in _paths(node, problems):
        place = problems.place(entry)
        try:
            rule = read_model_rule(path)
        except InputError as error:
            if error.file is None:
                raise wrong_at(place, f"models: {error.message}") from None
            raise
        if rule.id in taken:
            other = taken[rule.id].file.path
            problems.add(entry, f"models: two files state the rule {rule.id}: {other} and {path}")
            continue
        before = rules.get(rule.id)
        if before is not None and not isinstance(before, ModelRule):
            problems.add(entry, f"models: the name {rule.id!r} is taken by a rule of {before.brought}; rename the file")
            continue
        taken[rule.id] = rule
        rules[rule.id] = rule
        sources[path.name] = ModelSource(path, place)
        settings[rule.id] = _setting(rule, settings.get(rule.id))
    return {"models": tuple(sources.values()), "further_rules": rules, "rules": settings}


def _setting(rule: ModelRule, before: RuleSetting | None) -> RuleSetting:
    """The setting of a rule that a file brings: that of the rule whose place it takes, with its options."""
    if before is None:
        return RuleSetting(rule.default, None, rule.Options())
    names = (o.name for o in options_of(rule.Options))
    options = {name: getattr(before.options, name) for name in names if hasattr(before.options, name)}
    return dataclasses.replace(before, options=rule.Options(**options))


def _paths(node: yaml.Node, problems: Problems) -> Iterator[tuple[Path, yaml.Node]]:
    """Every file that is named, in order; patterns give theirs by name."""
    folder = Path(problems.file).parent
    for name, entry in names_of_files(node, "models", problems):
        expect_readable(folder / name)  # whether anything is there or not
        if glob.has_magic(name):
            try:
                found = sorted(path for path in folder.glob(name) if path.suffix == ".mzn" and is_file(path))
            except (OSError, ValueError, NotImplementedError):  # not relative to the folder, or no name at all
                found = []
            if not found:
                problems.add(entry, f"models: no MiniZinc file matches {str(folder / name)!r}")
            yield from ((path, entry) for path in found)
        elif (folder / name).is_dir():
            problems.add(entry, f"models: {str(folder / name)!r} is a folder: name the files in it, as in {name}/*.mzn")
        elif not is_file(folder / name):
            problems.add(entry, f"models: there is no file {str(folder / name)!r}")
        else:
            yield folder / name, entry


def models_schema() -> dict[str, Any]:
    """JSON Schema of `models`."""
    file = Text().schema()
    return {"description": WHAT, "anyOf": [file, {"type": ["array", "null"], "items": file}]}


# The key `python` of a profile: files of rules in Python, run where they are trusted.


def with_python_files(node: yaml.Node, profile_files: GivenFiles, problems: Problems, trust: bool) -> GivenFiles:
    """The fields `python`, `further_rules` and `rules` of a profile, with the rules of the files that a node names.

    A file's rules have the strength that they give themselves. Files of a profile that this one is based on stay.

    Raises InputError if a file is not trusted, or its rules cannot be used: nothing after it would mean anything.
    """
    files = list(profile_files["python"])
    rules: dict[str, Rule[Any]] = dict(profile_files["further_rules"])
    settings: dict[str, RuleSetting] = dict(profile_files["rules"])
    for name, entry in names_of_files(node, "python", problems):
        file = PythonFile(name, Path(problems.file).parent / name, problems.place(entry))
        for rule in _rules(file, trust):
            if rules.get(rule.id) is rule:
                continue
            if rule.id in RULES or rule.id in rules:
                other = rules[rule.id].brought if rule.id in rules else "kerfwise itself"
                raise wrong_at(
                    file.place, f"python: two rules are called {rule.id!r}: one of {rule.brought}, one of {other}; "
                    "choose another name"
                )  # fmt: skip
            rules[rule.id] = rule
            weight = rule.default_weight if rule.default == "soft" else None
            settings[rule.id] = RuleSetting(rule.default, weight, rule.Options())
        if file.path.resolve() not in {other.path.resolve() for other in files}:
            files.append(file)
    return {"python": tuple(files), "further_rules": rules, "rules": settings}


def _rules(file: PythonFile, trust: bool) -> tuple[Rule[Any], ...]:
    if file.path.suffix != ".py":
        raise wrong_at(file.place, f"python: expected a Python file such as my_rule.py, got {file.file!r}")
    if not is_file(file.path):
        raise wrong_at(file.place, f"python: there is no file {str(file.path)!r}")
    if not trust and not is_trusted(file.path):
        raise wrong_at(file.place, f"python: {refusal(file.path)}")
    try:
        return rules_in_file(file.path)
    except InputError as error:
        if error.file is not None:
            raise
        raise wrong_at(file.place, f"python: {error.message}") from error


# What a profile takes from a material chart: looked up where a profile chooses a row, beaten by what that says.

SELECTS = ("chart", "row", "name", "thickness", "interpolate", "chart_units")
"""Keys of `material` that choose a row: a profile that says one has the chart looked up again."""
_TOLD = ("kerf", "feed", "pierce_delay")
_SAME = 1e-6
_KERFS = ("cuts", "bevel.kerfs")
Key = tuple[str, str]
"""A section of a profile, and a key in it."""


@dataclass(frozen=True, slots=True)
class ChartValue:
    """A value of the chart that stands in the profile: its column, as it is written, and the lines it comes from.

    `between` are the thicknesses of the two rows that it lies between, as they are written.
    """

    column: str
    text: str
    lines: tuple[int, ...]
    between: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ChartUse:
    """A chart, the row that was chosen, what was taken of it, and what the profile says otherwise.

    `beaten` are, by column, what the chart says and what the profile says itself; `silent` are columns of which
    neither says anything, so that what the profile is based on, or the default, holds: with that value. `source` is who
    has published the row, where the chart says it.
    """

    file: str
    sha256: str
    row: str
    line: int
    taken: tuple[ChartValue, ...] = ()
    beaten: tuple[tuple[str, str, str], ...] = ()
    silent: tuple[tuple[str, str], ...] = ()
    source: str = ""

    @property
    def name(self) -> str:
        """The file's name."""
        return PurePath(self.file).name

    @property
    def interpolated(self) -> tuple[ChartValue, ...]:
        """What lies between two rows."""
        return tuple(one for one in self.taken if one.between)

    def notes(self) -> Iterable[str]:
        """What a planner would want to know: what is interpolated, what the profile says otherwise, what nobody says.

        Examples
        --------
        >>> use = ChartUse("shop.csv", "", "S235, 8 mm", 0, (ChartValue("kerf", "1.7 mm", (2, 3), ("6 mm", "10 mm")),))
        >>> list(use.notes())
        ['material chart shop.csv: kerf 1.7 mm is interpolated between 6 mm (line 2) and 10 mm (line 3)']
        """
        if self.source:
            yield f"material chart {self.name}: starting values of {self.source}, to be tried on your machine"
        for ends in dict.fromkeys((one.lines, one.between) for one in self.interpolated):
            alike = [one for one in self.interpolated if (one.lines, one.between) == ends]
            text = ", ".join(f"{one.column} {one.text}" for one in alike)
            sides = " and ".join(f"{mm} (line {line})" for line, mm in zip(*ends, strict=True))
            verb = "is" if len(alike) == 1 else "are"
            yield f"material chart {self.name}: {text} {verb} interpolated between {sides}"
        for column, chart_says, profile_says in self.beaten:
            yield (
                f"material chart {self.name}: the profile says {column} {profile_says} itself, the chart says "
                f"{chart_says} for {self.row}"
            )
        for column, value in self.silent:
            yield f"material chart {self.name} says nothing of {column} for {self.row}: {value} holds"


def with_chart(found: Mapping[str, yaml.Node], values: dict[str, Any], problems: Problems) -> dict[str, Any]:
    """The sections of a profile with what its chart has for them; `found` are the nodes that this file gives.

    Raises InputError if the chart cannot be read, or is wrong anywhere: with its own lines.
    """
    material: Material = values["material"]
    own = _said(found)
    chooses = any(("material", key) in own for key in SELECTS)
    if ("material", "chart") in own and material.chart is not None:
        values = _put(values, "material", "chart", _chart_path(problems.file, material.chart))
        material = values["material"]
    if material.chart is None:
        for key in ("row", "interpolate", "chart_units"):
            if ("material", key) in own and ("material", "chart") not in own:
                problems.add(own["material", key], f"material.{key}: there is no chart: give material.chart, its file")
        return values | {"chart": None}
    if not chooses:
        return values | {"chart": _beaten_too(values["chart"], own, values)}
    looked_up = _looked_up(material, own, found, problems)
    return values if looked_up is None else _filled(values, looked_up, own, problems)


def with_dialect_beside(node: yaml.Node | None, values: dict[str, Any], problems: Problems) -> dict[str, Any]:
    """The sections of a profile with the dialect that stands beside its file, where none is there as seen from here."""
    keys = {key.value for key, _ in node.value} if isinstance(node, yaml.MappingNode) else set()
    name: str = values["machine"].dialect
    if "dialect" not in keys or not is_own_dialect(name) or is_file(name):
        return values
    beside = _beside(problems.file, name)
    return _put(values, "machine", "dialect", beside) if is_file(beside) else values


def _chart_path(profile: str, chart: str) -> str:
    """A chart that comes with kerfwise, by its name, or one beside the profile."""
    shipped = shipped_charts().get(chart)
    return _beside(profile, chart) if shipped is None else str(shipped)


def _beside(profile: str, chart: str) -> str:
    """The path of a file as seen from the profile's file, without `..` where that leads to the same file."""
    path = str(Path(profile).parent / chart)
    shorter = os.path.normpath(path)
    try:
        return shorter if os.path.realpath(shorter) == os.path.realpath(path) else path
    except ValueError:  # a NUL, or half a character: no file can have this name, and whoever reads it says so
        return path


def _said(found: Mapping[str, yaml.Node]) -> dict[Key, yaml.Node]:
    """Every section and key that this file gives a value, with the value; a key of a group as `bevel.kerfs`."""
    said: dict[Key, yaml.Node] = {}
    for section, node in found.items():
        for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
            said[section, key.value] = value
            inner = value.value if isinstance(value, yaml.MappingNode) else ()
            said |= {(section, f"{key.value}.{one.value}"): of for one, of in inner}
    return said


def _looked_up(
    material: Material, own: Mapping[Key, yaml.Node], found: Mapping[str, yaml.Node], problems: Problems
) -> tuple[str, str, LookedUp] | None:
    node = next(
        (own["material", key] for key in ("row", "thickness", "name", "chart") if ("material", key) in own), None
    )
    try:
        chart = read_chart(str(material.chart), material.chart_units)
    except InputError as error:
        if error.line is not None or ("material", "chart") not in own:
            raise
        problems.add(own["material", "chart"], f"material.chart: {error}")
        return None
    try:
        looked_up = look_up(chart, material.row, material.name, material.thickness_mm, material.interpolate)
    except NoRow as error:
        problems.add(node or deepest(found["material"]), f"material.row: {error}")
        return None
    return chart.file, chart.sha256, looked_up


def _filled(
    values: dict[str, Any], chosen: tuple[str, str, LookedUp], own: Mapping[Key, yaml.Node], problems: Problems
) -> dict[str, Any]:
    file, sha256, looked_up = chosen
    taken, beaten = [], []
    by_angle = [name for name in looked_up.values if column_of(name).angle_deg is not None]
    if by_angle and _KERFS not in own:
        values = _with_kerfs(values, ())
    for name, value in looked_up.values.items():
        column = column_of(name)
        key = column.key
        text = value_text(name, value.value)
        if key not in own:
            if column.angle_deg is None:
                values = _put(values, *key, value.value)
            else:
                values = _with_kerfs(values, (*values["cuts"].bevel.kerfs, (column.angle_deg, float(value.value))))
            if value.lines:
                taken.append(_taken(name, text, value))
            continue
        stated = _value(values, column)
        if same_value(stated, value.value, _SAME, 0.0) or (
            name == "material" and family_of(str(stated)) == value.value
        ):
            continue
        if name == "thickness":
            place = f"{Path(file).name}:{value.lines[0]}"
            problems.add(
                own[key],
                f"material.thickness: {value_text(name, stated)}, but the "
                f"row {looked_up.label!r} of the chart ({place}) is "
                f"for {text}: name a row for this thickness, or leave the thickness out",
            )
            continue
        beaten.append((name, text, value_text(name, stated)))
    silent = [
        (name, value_text(name, _value(values, COLUMNS[name])))
        for name in _TOLD
        if name not in looked_up.values and COLUMNS[name].key not in own
    ]
    if values["cuts"].bevel.head is not None and not by_angle and _KERFS not in own:
        at = ", ".join(f"{mm:g} mm at {angle:g}°" for angle, mm in values["cuts"].bevel.kerfs)
        silent.append(("the kerf of a torch that leans (such as kerf_45)", at or "that of an upright one"))
    line = 0 if looked_up.row is None else looked_up.row.line
    use = ChartUse(file, sha256, looked_up.label, line, tuple(taken), tuple(beaten), tuple(silent), looked_up.source)
    return values | {"chart": use}


def _beaten_too(use: ChartUse, own: Mapping[Key, yaml.Node], values: Mapping[str, Any]) -> ChartUse:
    """The use of a chart by the profile that this one is based on, with what this one says otherwise."""
    kept, beaten = [], list(use.beaten)
    for one in use.taken:
        column = column_of(one.column)
        if column.key in own:
            beaten.append((one.column, one.text, value_text(one.column, _value(values, column))))
        else:
            kept.append(one)
    silent = [
        (name, value) for name, value in use.silent if (COLUMNS[name].key if name in COLUMNS else _KERFS) not in own
    ]
    return replace(use, taken=tuple(kept), beaten=tuple(beaten), silent=tuple(silent))


def _taken(column: str, text: str, value: Found) -> ChartValue:
    return ChartValue(column, text, value.lines, tuple(value_text("thickness", mm) for mm in value.between_mm))


def _field(owner: Any, key: str) -> str:
    return next(option.name for option in options_of(owner) if option.key == key)


def _put(values: dict[str, Any], section: str, key: str, value: Any) -> dict[str, Any]:
    owner = values[section]
    return values | {section: replace(owner, **{_field(owner, key): value})}


def _with_kerfs(values: dict[str, Any], kerfs: Iterable[tuple[float, float]]) -> dict[str, Any]:
    cuts = values["cuts"]
    return values | {"cuts": replace(cuts, bevel=replace(cuts.bevel, kerfs=tuple(sorted(kerfs))))}


def _value(values: Mapping[str, Any], column: Column) -> Any:
    """What the profile has for a column; of a kerf by angle its table, where that has no row for it."""
    if column.angle_deg is None:
        return getattr(values[column.section], _field(values[column.section], column.option))
    kerfs = values["cuts"].bevel.kerfs
    return dict(kerfs).get(column.angle_deg, f"{{{', '.join(f'{angle:g}: {mm:g} mm' for angle, mm in kerfs)}}}")
