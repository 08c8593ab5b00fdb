"""What a planner writes down about one nest, where its job file stands, and how it is read."""

from __future__ import annotations

import datetime
import hashlib
import json
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, is_file, read_named, utf8_text
from kerfwise.encoder.questions import Answers
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.kind import AnswerPairs, Number, OptionKind, Text, Unfit, noting, scalar_text
from kerfwise.rules.options.option import options_of, setting
from kerfwise.rules.options.quantities import OrWord, PointOrOff, PointXY
from kerfwise.rules.options.yaml_positions import Place, Problems, compose, entries, is_empty, items, with_value
from kerfwise.rules.profile.load import read_fields, read_locks, shipped_profiles
from kerfwise.rules.profile.overrides import Setting, read_lock, read_settings
from kerfwise.rules.profile.profile_yaml import where_it_belongs
from kerfwise.rules.registry import RULES

_WRITTEN = r"\d{4}-\d{2}-\d{2}"


@dataclass(frozen=True, slots=True)
class Day(OptionKind):
    """A day of the calendar: year, month and day, as in ISO 8601."""

    def read(self, node: yaml.Node) -> datetime.date:
        text = scalar_text(node, self).strip()
        if not re.fullmatch(_WRITTEN, text, re.ASCII):
            raise self.refuse(node)
        try:
            return datetime.date.fromisoformat(text)
        except ValueError as error:
            raise Unfit(f"there is no such day as {text}: {error}", node) from None

    def write(self, value: datetime.date) -> str:
        return value.isoformat()

    def schema(self) -> dict[str, Any]:
        return {"type": "string", "format": "date", "pattern": f"^{_WRITTEN}$"}

    def expected(self) -> str:
        return "a day such as 2026-12-24 (year-month-day)"


def day_of(text: str) -> str:
    """A day of the calendar as programs say it, year first; "" for none.

    Raises InputError for anything else.
    """
    try:
        return datetime.date.fromisoformat(text).isoformat() if text else ""
    except (TypeError, ValueError):
        raise InputError(f"date: expected a day such as 2026-12-24 (year-month-day), got {text!r}") from None


# What a planner writes down about one nest: its profile, locks and settings, how many sheets, for whom and when.

MOST_SHEETS = 100_000


@dataclass(frozen=True, slots=True)
class Job:
    """A job file, read: `NEST.job.yaml`.

    `profile` and `machine` are as they are written, None where the file does not say; `profile_path` is what
    `load_profile` takes. `quantity` is how many sheets are cut, `due` the day on which they have to be ready.

    `locks` are with the names as they are written (contours, parts, `#7`), those of `tabs` among them; which contours
    these are, depends on the nest (see `names.py`). `settings` take the place of values of the profile.

    `file` is the path that it was read from, `sha256` that of its bytes, `said_at` where each key stands.

    Examples
    --------
    >>> job = Job(profile="laser-wood", quantity=4, file="nests/plate.job.yaml")
    >>> job.name, job.profile_path, job.due is None
    ('plate.job.yaml', 'laser-wood', True)
    >>> Job(profile="plant.yaml", file="nests/plate.job.yaml").profile_path
    'nests/plant.yaml'
    """

    profile: str | None = setting(None, Text(), "name of a shipped profile, or path of one, from this file's folder")
    machine: str | None = setting(None, Text(), "name of the machine that the nest is for")
    quantity: int = setting(1, Number(1, MOST_SHEETS, whole=True), "how many sheets of the nest are cut")
    order: str | None = setting(None, Text(), "the order that the nest is cut for")
    due: datetime.date | None = setting(None, Day(), "day on which the sheets have to be ready")
    date: datetime.date | None = setting(None, Day(), "day that the program's top says")
    number: int | None = setting(
        None, OrWord(Number(1, 99_999_999, whole=True), none="none"), "number of the program on its control"
    )
    answers: Answers = setting((), AnswerPairs(), "answers to questions that the drawing raises, as in {frame: sheet}")
    locks: tuple[Lock, ...] = ()
    settings: tuple[Setting, ...] = ()
    file: str = ""
    sha256: str = ""
    said_at: Mapping[str, Place] = field(default_factory=dict, compare=False)

    @property
    def said(self) -> dict[str, str]:
        """What stands at the program's top and changes no plan."""
        told = {"order": self.order, "due": self.due, "date": self.date, "number": self.number}
        return {key: str(value) for key, value in told.items() if value is not None}

    @property
    def name(self) -> str:
        """The file's name."""
        return Path(self.file).name

    @property
    def profile_path(self) -> str | None:
        """The profile as `load_profile` takes it: a shipped one's name, or a path; None where the file names none."""
        if self.profile is None or self.profile in shipped_profiles():
            return self.profile
        return str(Path(self.file).parent / self.profile)


# Job files read: every mistake with its line and column.

LOCKS, TABS, SET = "locks", "tabs", "set"


def read_job(path: str | Path) -> Job:
    """Read a job file.

    What it names (a profile, contours, keys of the profile) is looked up where the job is used: see `jobs/inputs.py`.

    Raises InputError if the file cannot be read, or is wrong anywhere, with line and column: all mistakes at once.
    """
    data = read_named(path, "the job file", MOST_BYTES_OF_YAML)
    return replace(job_of(utf8_text(data, "a job file", path), str(path)), sha256=hashlib.sha256(data).hexdigest())


def job_of(text: str, file: str) -> Job:
    """The job that a text describes.

    Raises InputError as `read_job` does.

    Examples
    --------
    >>> job = job_of("quantity: 4\\ndue: 2026-12-24\\nlocks: [P2 first]\\n", "plate.job.yaml")
    >>> job.quantity, job.due.day, job.locks[0].contour, str(job.locks[0].place)
    (4, 24, 'P2', 'plate.job.yaml:3:9')
    """
    problems, root = Problems(file), compose(text, file)
    members = list(entries(root, problems, "job file")) if root is not None else []
    own = {key: value for key, _, value in members if key in (LOCKS, TABS, SET)}
    rest = [member for member in members if member[0] not in own]
    said_at = {key: problems.place(key_node) for key, key_node, _ in members}
    own_keys = (LOCKS, TABS, SET)
    job = read_fields(
        rest, Job(file=file, said_at=said_at), problems, "job file", other=own_keys, elsewhere=_of_profile
    )
    locks = [*_locks(own[LOCKS], problems)] if LOCKS in own else []
    locks += _tabs(own[TABS], problems) if TABS in own else []
    settings = read_settings(own[SET], problems) if SET in own else ()
    problems.raise_any()
    return replace(job, locks=tuple(locks), settings=settings)


def _of_profile(key: str, valid: Sequence[str]) -> str:
    """That a key is one of a profile, which a job file has under `set`; "" for others."""
    text = where_it_belongs(key, valid, RULES)
    return f"{text} of a profile: in a job file that stands under set" if text and "it belongs" in text else ""


def _locks(node: yaml.Node, problems: Problems) -> Iterator[Lock]:
    """Each entry is a line in words, or a mapping as in a profile."""
    for number, entry in enumerate(items(node, problems, LOCKS), 1):
        if is_empty(entry):
            problems.add(
                entry,
                f"{LOCKS}[{number}]: expected a lock, got nothing; write '#7 first' in quotes: # begins a comment",
            )
        elif isinstance(entry, yaml.ScalarNode):
            try:
                yield replace(read_lock(str(entry.value)), place=problems.place(entry))
            except InputError as error:
                problems.add(entry, f"{LOCKS}[{number}]: {error.message}")
        else:
            own = Problems(problems.file)
            yield from read_locks(yaml.SequenceNode("tag:yaml.org,2002:seq", [entry], entry.start_mark), own)
            for line, column, said in own.found:
                problems.found.append((line, column, said.replace(f"{LOCKS}[1]", f"{LOCKS}[{number}]", 1)))


def _tabs(node: yaml.Node, problems: Problems) -> Iterator[Lock]:
    """A contour or part, and where tabs hold it: a point, several, or off."""
    for name, key_node, value in entries(node, problems, TABS):
        several = isinstance(value, yaml.SequenceNode) and any(isinstance(v, yaml.SequenceNode) for v in value.value)
        for one in value.value if several else (value,):
            with noting(problems, one, f"{TABS}.{name}"):
                yield Lock(contour=name, tab=PointOrOff().read(one), place=problems.place(key_node))  # type: ignore[arg-type]


# Where the job file of a nest is looked for: beside it, under its name.

ENDING = ".job.yaml"


def job_beside(nest: str | Path) -> Path | None:
    """The job file beside a nest's file, `plate.job.yaml` for `plate.dxf`; None where there is none.

    Examples
    --------
    >>> job_beside("examples/nests/e1x_6.dxf") is None
    True
    """
    path = Path(nest)
    beside = path.with_name(beside_name(path)) if path.stem else None
    return beside if beside is not None and is_file(beside) else None


def beside_name(nest: str | Path) -> str:
    """What the job file of a nest is called."""
    return f"{Path(nest).stem}{ENDING}"


def misnamed(nest: str | Path) -> Path | None:
    """A file beside a nest that is nearly called as its job file would be; None where there is none."""
    path = Path(nest)
    nearly = (f"{path.name}{ENDING}", f"{path.stem}.job.yml", f"{path.stem}.job.json", f"{path.stem}.job")
    return next((file for name in nearly if path.stem and is_file(file := path.with_name(name))), None)


# The JSON Schema of a job file: `python -m kerfwise.jobs.nest_job.job > jobs/nest_job/job.schema.json`.

Json = dict[str, Any]


def job_schema() -> Json:
    """The schema, made from the declarations that job files are read with."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "kerfwise job",
        "description": "What belongs to one nest: written beside it, in NEST.job.yaml.",
        "type": ["object", "null"],
        "additionalProperties": False,
        "properties": {
            **{o.key: {"description": o.help, **value_schema(o.kind)} for o in options_of(Job)},
            "locks": {
                "description": "decisions of the planner: lines such as P2 first, or mappings as in a profile",
                "type": ["array", "null"],
                "items": {"anyOf": [{"type": "string", "minLength": 1}, _lock()]},
            },
            "tabs": {
                "description": "contour or part: a point where a tab holds it, several points, or off",
                "type": ["object", "null"],
                "additionalProperties": _tab(),
            },
            "set": {
                "description": "values of the profile that this nest has otherwise, such as leads.lead_in: 4 mm",
                "type": ["object", "null"],
            },
        },
    }


def value_schema(kind: OptionKind) -> Json:
    """A text may be a number to readers of YAML, such as that of an order."""
    return kind.schema() | ({"type": ["string", "number"]} if isinstance(kind, Text) else {})


def _lock() -> Json:
    keys = {o.key: {"description": o.help, **o.kind.schema()} for o in options_of(Lock)}
    one = [{"required": ["contour"]}, {"required": ["part", "zone"]}]
    return {"type": "object", "properties": keys, "additionalProperties": False, "oneOf": one}


def _tab() -> Json:
    return {"anyOf": [PointOrOff().schema(), {"type": "array", "items": PointXY().schema(), "minItems": 1}]}


def schema_text() -> str:
    """The schema as the text of its file."""
    return json.dumps(job_schema(), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    sys.stdout.write(schema_text())


def with_kept(text: str, answers: Answers, file: str) -> str:
    """The text of a job file with these answers in it, all else as it is.

    Raises InputError if the text is no job file.

    Examples
    --------
    >>> print(with_kept("quantity: 4  # sheets\\n", (("frame", "sheet"),), "plate.job.yaml"), end="")
    quantity: 4  # sheets
    answers: {"frame": "sheet"}
    """
    job = job_of(text, file) if text.strip() else Job()
    told = json.dumps(dict(job.answers) | dict(answers), ensure_ascii=False)
    made = with_value(text, ["answers"], told)
    job_of(made, file)
    return made
