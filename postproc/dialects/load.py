"""Dialects by name: those that come with kerfwise, a plant's own, and whether one fits a profile."""

from __future__ import annotations

import dataclasses
import json
import re
import sys
from collections.abc import Iterator, Mapping
from functools import cache, lru_cache, partial
from importlib import resources

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, read_limited, utf8_text
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import Nest
from kerfwise.rules.options.kind import noting
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.yaml_positions import (
    Problems,
    compose,
    deepest,
    entries,
    raise_together,
    with_value,
    wrong_at,
)
from kerfwise.rules.profile.plant_sections import MACHINE_WAITS, PierceDwell
from kerfwise.rules.profile.profile_yaml import where_said
from kerfwise.rules.profile.technique import Technique

from .blocks import POWERS, Powers
from .dialect import INCH_MM, PLANT, Dialect

_COARSEST_MM = 0.1
_NOT_SHIFTED = {
    ("absolute", "absolute"), ("incremental", "absolute"), ("incremental", "relative"), ("incremental", "radius"),
    ("incremental", "none"),
}  # fmt: skip


def pierce_dwell_of(profile: Technique, dialect: Dialect | None = None) -> PierceDwell:
    """Who waits at a pierce: what the profile says, else the dialect of its machine."""
    return profile.machine.pierce_dwell or (dialect or load_dialect(profile.machine.dialect)).pierce_dwell


@cache
def dialect_names() -> tuple[str, ...]:
    """The dialects that come with kerfwise.

    Examples
    --------
    >>> "linuxcnc-qtplasmac" in dialect_names()
    True
    """
    files = resources.files(__package__).iterdir()
    return tuple(sorted(f.name.removesuffix(".yaml") for f in files if f.name.endswith(".yaml")))


def dialect_text(name: str) -> str:
    """The file of a dialect, as text: one that comes with kerfwise, or a plant's own when `name` ends in .yaml.

    Raises InputError for a name that is not there, and for a file that cannot be read.
    """
    if name.endswith((".yaml", ".yml")):
        try:
            return utf8_text(read_limited(name, MOST_BYTES_OF_YAML), "a dialect", name)
        except OSError as error:
            raise InputError(f"cannot read the dialect: {error.strerror}", file=name) from None
        except ValueError as error:  # a NUL, or half a character
            raise InputError(f"cannot read the dialect: no file can have this name ({error})", file=name) from None
    if name not in dialect_names():
        raise InputError(f"{unknown('dialect', name, dialect_names())}; the file of a plant's own ends in .yaml")
    return resources.files(__package__).joinpath(f"{name}.yaml").read_text(encoding="utf-8")


def load_dialect(name: str) -> Dialect:
    """The dialect of that name, or of a plant's own file when `name` ends in .yaml.

    Raises InputError for a name that is not there, and for a file that lacks a key, has one too many or one of the
    wrong type.

    Examples
    --------
    >>> load_dialect("linuxcnc-qtplasmac").torch_on
    ('M3 $0 S1',)
    """
    text = dialect_text(name)
    return parse_dialect(text, name if name.endswith((".yaml", ".yml")) else f"{name}.yaml")


@lru_cache(maxsize=64)
def parse_dialect(text: str, file: str) -> Dialect:
    """Read a dialect from YAML text; `file` is the name for messages (see `load_dialect`).

    A planning asks for its dialect some twenty times: what has been read is kept by its text.
    """
    root = compose(text, file)
    if not isinstance(root, yaml.MappingNode):
        raise InputError("not a dialect: expected keys such as torch_on and line", file=file)
    problems = Problems(file)
    known = {one.key: one for one in options_of(Dialect)}
    values: dict[str, object] = {}
    for key, key_node, node in entries(root, problems, "dialect"):
        if key not in known:
            problems.add(key_node, unknown("key", key, known))
            continue
        with noting(problems, node, key):
            values[known[key].name] = known[key].kind.read(node)
    problems.raise_any()
    needed = [one for one in known.values() if one.default is dataclasses.MISSING]
    if missing := [one.key for one in needed if one.name not in values]:
        raise InputError(f"the dialect lacks {', '.join(missing)}", file=file)
    dialect = Dialect(**values)  # type: ignore[arg-type]
    if bool(dialect.mark_on) != bool(dialect.mark_off):
        raise InputError("mark_on and mark_off: expected blocks for both, or null for both", file=file)
    if dialect.marks and bool(dialect.torch_station) != bool(dialect.mark_station):
        at = problems.place(deepest(root, "torch_station" if dialect.torch_station else "mark_station"))
        raise wrong_at(at, "torch_station and mark_station: expected blocks for both, or for neither")
    if bool(dialect.torch_select) != bool(dialect.torch_deselect):
        at = problems.place(deepest(root, "torch_select" if dialect.torch_select else "torch_deselect"))
        raise wrong_at(at, "torch_select and torch_deselect: expected blocks for both, or for neither")
    if dialect.subprogram is not None and (dialect.positions, dialect.arc_centre) in _NOT_SHIFTED:
        at = problems.place(deepest(root, "subprogram"))
        raise wrong_at(
            at,
            "subprogram: a path that is called at several places counts from where it begins: expected positions: "
            "absolute, and arc_centre: relative, radius or none",
        )
    if dialect.kerf is not None and (why := _adds_no_kerf(dialect)):
        at = problems.place(deepest(root, "kerf"))
        raise wrong_at(at, f"kerf: the control cannot add it here: {why}; leave kerf out, so that it is in the path")
    if dialect.step_mm > _COARSEST_MM * (1 + 1e-9):
        at = problems.place(deepest(root, "decimals"))
        raise wrong_at(
            at, f"decimals: they make steps of {dialect.step_mm:g} mm; expected {_COARSEST_MM:g} mm or less (see scale)"
        )
    times = [hole for block in dialect.dwell for hole in ("{seconds}", "{milliseconds}") if hole in block]
    if len(times) != 1:
        at = problems.place(deepest(root, "dwell"))
        raise wrong_at(at, "dwell: expected one {seconds} or {milliseconds} in all its blocks")
    for key in ("torch_on", "mark_on"):
        hole = next((h for h in POWERS for block in getattr(dialect, key) if f"{{{h}}}" in block), None)
        if hole is not None and dialect.powers is None:
            raise wrong_at(
                problems.place(deepest(root, key)), f"{key}: {{{hole}}} needs the key powers, with the S words"
            )
    return dialect


def _adds_no_kerf(dialect: Dialect) -> str:
    """Why the control of a dialect cannot add the kerf; "" where it can."""
    if dialect.control not in ("linuxcnc", "linuxcnc-qtplasmac", "eia", "burny"):
        return f"programs for '{dialect.control}' have no such words that are known here"
    if dialect.positions != "absolute":
        return "behind it positions that count from the last one would not count from where the torch is"
    if dialect.subprogram is not None:
        return "subprograms are called with the torch on its path"
    return ""


# A plant's own dialect, begun as a copy of another.

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,60}")


def new_dialect_text(name: str, like: str) -> str:
    """The file of the dialect `like` under another name, with nothing that verified it: what is changed nobody read.

    Raises InputError for a name that no dialect can have, and where `like` cannot be read.

    Examples
    --------
    >>> [row for row in new_dialect_text("shop", "grbl").splitlines() if row.startswith(("name", "verified"))]
    ['name: shop', 'verified_by: []']
    """
    if not _NAME.fullmatch(name):
        raise InputError(f"{name!r} cannot be a dialect's name: expected letters, digits, dots and dashes")
    text = dialect_text(like)
    parse_dialect(text, like)
    text = with_value(text, ["name"], name)
    if "verified_by" in yaml.safe_load(text):
        text = with_value(text, ["verified_by"], "[]")
    return f"# Begun as a copy of {like}. Change what differs; `kerfwise profile check` reads it back.\n{text}"


# Whether a profile and the dialect that it names belong together.


def fitting_dialect(profile: Technique) -> Dialect:
    """The dialect of the profile's machine.

    Raises InputError if there is none of that name, or for all that `dialect_misfits` finds: with the places in the
    profile's file.
    """
    raise_together(dialect_misfits(profile))
    return load_dialect(profile.machine.dialect)


def dialect_misfits(profile: Technique) -> Iterator[InputError]:
    """What a profile asks for that its dialect cannot say, or that its control does otherwise.

    The dialect may be for another process, and the profile does not accept that; words may be the choice of whoever
    built the machine; techniques may need words that it does not have. Raises InputError if there is no such dialect.
    """
    machine = profile.machine
    dialect = load_dialect(machine.dialect)
    if machine.process not in dialect.processes and not machine.accept_dialect:
        others = [name for name in dialect_names() if machine.process in load_dialect(name).processes]
        yield wrong_at(
            where_said(profile, ("machine", "dialect"), ("machine", "process")),
            f"machine.dialect: '{machine.dialect}' is for {' and '.join(dialect.processes)}, the machine's process is "
            f"{machine.process}: its programs would not run, or would run wrong. Say dialect: {' or '.join(others)}, "
            "correct machine.process, or say accept_dialect: true to have it all the same",
        )
        return  # of another process's words, what they cannot do says nothing
    waits = pierce_dwell_of(profile, dialect) == "program"
    chosen = [key for key in dialect.builders_choice if key != "dwell" or waits]
    if chosen and not machine.accept_dialect:
        words = "; ".join(f"{key}: {', '.join(getattr(dialect, key))}" for key in chosen)
        new = f"write a copy (kerfwise dialects new mine --like {machine.dialect}), state yours there"
        where = "state yours in it" if machine.dialect.endswith((".yaml", ".yml")) else new
        yield wrong_at(
            where_said(profile, ("machine", "dialect")),
            f"machine.dialect: these words are the choice of whoever built the machine, and '{dialect.name}' can "
            f"only guess ({words}): {where} and delete builders_choice, or say accept_dialect: true if your machine "
            "has just these",
        )
    yield from _misfit_starts(profile, dialect)
    yield from _misfit_techniques(profile, dialect)


def _misfit_starts(profile: Technique, dialect: Dialect) -> Iterator[InputError]:
    """Starts of cuts that are not as the control, or the torch, makes them."""
    if profile.cuts.pierce_pass and pierce_dwell_of(profile, dialect) == "machine":
        yield wrong_at(
            where_said(profile, ("cuts", "pierce_pass")),
            f"cuts.pierce_pass: under the dialect '{dialect.name}' the machine waits at every start, also where a cut "
            "begins at a hole: say machine: {pierce_dwell: program} and set the machine's own delay to 0",
        )
    if profile.cuts.pierce_pass and (limit := profile.temperature_limit()) is not None and limit.dwells:
        yield wrong_at(
            where_said(profile, ("cuts", "pierce_pass")),
            "cuts.pierce_pass: where the torch waits for metal to cool (dwells) holes are pierced one by one: say "
            "pierce_pass: off, or dwells: false",
        )
    pierce_s, own_s = profile.machine.pierce_time_s, own_wait_s(dialect)
    if own_s > pierce_s:
        yield wrong_at(
            where_said(profile, ("machine", "pierce_time"), ("machine", "dialect"), ("name",)),
            f"machine.pierce_time: it is {pierce_s:g} s, and the dialect '{dialect.name}' waits {own_s:g} "
            "s by itself where the torch starts (torch_on): give the whole time from where the torch stands to where "
            "it moves",
        )
    if profile.leads.edge_start and pierce_dwell_of(profile, dialect) == "machine":
        yield wrong_at(where_said(profile, ("leads", "edge_start")), f"leads.edge_start: {MACHINE_WAITS}")
    if profile.kerf_starts and pierce_dwell_of(profile, dialect) == "machine":
        place = where_said(profile, ("machine", "kerf_start"), ("cuts", "common"), ("cuts", "snake"), ("cuts", "split"))
        yield wrong_at(place, f"machine.kerf_start: {MACHINE_WAITS}")


def _misfit_techniques(profile: Technique, dialect: Dialect) -> Iterator[InputError]:
    """Torches, links, bevels, tabs and powers that the dialect has no words for."""
    if profile.machine.torches.several and not (dialect.torch_select and dialect.torch_deselect):
        others = [name for name in dialect_names() if load_dialect(name).torch_select]
        yield wrong_at(
            where_said(profile, ("machine", "torches"), ("machine", "dialect")),
            f"machine.torches: the dialect '{dialect.name}' has no words for a second torch (torch_select, "
            f"torch_deselect): take {' or '.join(others)}, give a copy of it these words, or say count: 1",
        )
    if dialect.kerf is not None and profile.cuts.links.longest_mm > 0:
        yield wrong_at(
            where_said(profile, ("cuts", "links"), ("machine", "dialect")),
            f"cuts.links: the dialect '{dialect.name}' has the control add the kerf to each contour, and a link leads "
            "from one to the next with the torch on: say links: off, or leave kerf out of the dialect",
        )
    bevel = profile.cuts.bevel
    if bevel.head == "block" and not (dialect.torch_select and dialect.torch_deselect):
        yield wrong_at(
            where_said(profile, ("cuts", "bevel"), ("machine", "dialect")),
            f"cuts.bevel.head: the dialect '{dialect.name}' has no words for several torches (torch_select, "
            "torch_deselect), as a block has: take linuxcnc, give a copy of it these words, or say head: tilting",
        )
    if bevel.head is not None and not {bevel.tilt, bevel.turn} <= {*dialect.rotary}:
        others = [name for name in dialect_names() if {bevel.tilt, bevel.turn} <= {*load_dialect(name).rotary}]
        yield wrong_at(
            where_said(profile, ("cuts", "bevel"), ("machine", "dialect")),
            f"cuts.bevel: the dialect '{dialect.name}' has no words for axes that tilt ({bevel.tilt}) and turn "
            f"({bevel.turn}) a torch: take {' or '.join(others)}, or say head: off",
        )
    tabs = profile.tabs()
    if tabs is not None and not tabs.at_end and dialect.rapid == dialect.line:
        yield wrong_at(
            where_said(profile, ("machine", "dialect")),
            f"machine.dialect: over a tab the torch goes off and moves on at its feed, and '{dialect.name}' has the "
            "same words for that as for travel, so that nobody could tell tabs from ends of cuts: take another "
            "dialect, or no tabs",
        )
    if profile.material.power is not None and dialect.powers is None and dialect.control == "grbl":
        yield wrong_at(
            where_said(profile, ("material", "power"), ("material", "chart"), ("machine", "dialect")),
            f"material.power: the dialect '{dialect.name}' has S words of its own: write {{power}}, {{pierce_power}} "
            "and {mark_power} in their place and give it the key powers, as the dialect grbl has them",
        )


def _marks_too(dialect: Dialect, profile: Technique) -> bool:
    """Whether a shipped dialect is for the profile's process, and can mark."""
    return dialect.marks and profile.machine.process in dialect.processes


def expect_words(nest: Nest, profile: Technique, dialect: Dialect, resumes: bool = False) -> None:
    """Refuse a nest whose program a dialect has no words for; `resumes` says that it goes on after a stop.

    Raises InputError for marks where it cannot mark, and for a program that must tell what is cut where it knows no
    comments.
    """
    marks = [contour.id for contour in profile.as_cut(nest).contours if contour.kind == "mark"]
    place = partial(where_said, profile, ("machine", "dialect"))
    edged = next((contour.id for contour in (nest.drawn or nest).contours if contour.edge_bevels), None)
    if edged is not None and dialect.turning is not None:
        others = [name for name in dialect_names() if (d := load_dialect(name)).rotary and d.turning is None]
        raise wrong_at(
            place(),
            f"machine.dialect: '{dialect.name}' does not tilt a torch while it turns, and {edged} has bevels on single "
            f"edges: take {' or '.join(others)}, or bevel the whole contour",
        )
    if marks and not dialect.marks:
        shown = ", ".join(marks[:3]) + (", …" if len(marks) > 3 else "")
        writings = () if nest.reading is None else nest.reading.writings
        layers = sorted({f'"{"text" if one.text else "point"}:{one.layer}=ignore"' for one in writings})
        without = f"; --answer {' --answer '.join(layers)} leaves out what is written" if layers else ""
        others = [name for name in dialect_names() if _marks_too(load_dialect(name), profile)]
        why = f"; {dialect.no_marking}" if dialect.no_marking else ""
        raise wrong_at(
            place(),
            f"machine.dialect: '{dialect.name}' has no words for marking, and the nest has {len(marks)} ({shown}): "
            f"take another dialect ({', '.join(others)}), give a copy of it the words (kerfwise dialects new mine "
            f"--like {dialect.name}; mark_on, mark_off{why}), or take a nest without them{without}",
        )
    powers = powers_of(dialect, profile)
    if (
        marks
        and dialect.says_power
        and profile.material.power is not None
        and powers["mark_power"] * 2 > powers["power"]
    ):
        raise wrong_at(
            where_said(profile, ("material", "mark_power"), ("material", "power"), ("material", "chart")),
            f"material.mark_power: S{powers['mark_power']} is more than half of S{powers['power']}, which cuts, and "
            "might cut too: give material.mark_power, a smaller share of full power",
        )
    if resumes and profile.cuts.pierce_pass:
        raise wrong_at(
            where_said(profile, ("cuts", "pierce_pass")),
            "cuts.pierce_pass: a program that goes on after a stop cannot have a pierce pass, for nobody knows which "
            "holes are there: say pierce_pass: off for the rest",
        )
    if resumes and dialect.comment is None:
        raise wrong_at(
            place(),
            f"machine.dialect: '{dialect.name}' knows no comments, in which a program that goes on after a stop tells "
            "what is cut: take another dialect",
        )


# The S words of a laser: a profile's, or its chart's, powers as the control spells them.

_NONE = Powers(0, 0, 0, 0)


def powers_of(dialect: Dialect, profile: Technique | None = None) -> Mapping[str, int]:
    """S words by the names that stand for them in a dialect's blocks; where the profile says none, the dialect's own.

    Examples
    --------
    >>> from .load import load_dialect
    >>> powers_of(load_dialect("grbl"))
    {'power': 1000, 'pierce_power': 1000, 'mark_power': 200}
    """
    own = dialect.powers or _NONE
    cut, pierce, mark = own.cut, own.pierce, own.mark
    if profile is not None:
        material = profile.material
        power = material.power if material.pierce_power is None else material.pierce_power
        cut, pierce, mark = (
            otherwise if share is None else round(own.full * share / 100)
            for share, otherwise in ((material.power, cut), (power, pierce), (material.mark_power, mark))
        )
    return {"power": cut, "pierce_power": pierce, "mark_power": mark}


def own_wait_s(dialect: Dialect) -> float:
    """How long the blocks that start the torch wait by themselves, s: as for a preheat, whatever a profile says.

    Examples
    --------
    >>> own_wait_s(dataclasses.replace(load_dialect("eia"), torch_on=("M14", "G04 X30", "M07")))
    30.0
    """
    waited_s = 0.0
    for block in dialect.dwell:
        form = re.escape(block)
        for hole, unit_s in (("seconds", 1.0), ("milliseconds", 0.001)):
            if f"{{{hole}}}" in block:
                form = re.sub(r"\\\{\w+\\\}", r"([0-9]+\\.?[0-9]*)", form).replace(r"\ ", r"\s*")
                found = (re.fullmatch(form, one) for one in dialect.torch_on)
                waited_s += sum(float(one[1]) * unit_s for one in found if one)
    return waited_s


def plant_words(dialect: Dialect, profile: Technique | None = None) -> Mapping[str, str]:
    """What a profile says of the material, by the names that stand for it in a dialect's blocks.

    Without a profile a number stands for each, so that a dialect can be tried. Raises InputError where a block of the
    dialect needs what the profile, and its chart's row, do not say.
    """
    if profile is None:
        return dict.fromkeys(PLANT, "1")
    material = profile.material
    heights = {"pierce_height": material.pierce_height_mm, "cut_height": material.cut_height_mm}
    lengths = {"thickness": material.thickness_mm, "kerf": material.kerf_mm, **heights}
    plain = {"amps": material.amps, "volts": material.volts}
    numbers = {
        **{name: None if mm is None else mm / (INCH_MM if dialect.inch else 1.0) for name, mm in lengths.items()},
        **plain,
    }
    texts = {"material": material.name, "gas": material.gas, "process": material.process}
    words = {name: None if value is None else f"{round(value, 4):g}" for name, value in numbers.items()} | texts
    for key, block in _material_blocks(dialect):
        for name in (name for name in PLANT if f"{{{name}}}" in block and not words[name]):
            raise wrong_at(
                where_said(profile, ("material", "chart"), ("material", "row"), ("machine", "dialect")),
                f"material.{name}: the dialect '{dialect.name}' writes it ({key}: {block}), and neither the profile "
                f"nor its chart's row says it: give material.{name}",
            )
    return {name: value or "" for name, value in words.items()}


def _material_blocks(dialect: Dialect) -> Iterator[tuple[str, str]]:
    """The blocks that may say something of the material, with their keys."""
    for key in ("header", "torch_on", "mark_on"):
        yield from ((key, block) for block in getattr(dialect, key))
    yield from (
        (f"around.{kind}", block) for kind, around in dialect.around for block in (*around.before, *around.after)
    )


# The JSON Schema of a dialect: `python -m kerfwise.postproc.dialects.load > postproc/dialects/dialect.schema.json`.
#
# It gives editors completion and a first check; the reader of dialects checks the same and more, with better words.


def schema_text() -> str:
    """The schema, made from the same declarations that dialects are read with, as the text of its file."""
    keys = options_of(Dialect)
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "kerfwise dialect",
        "description": "How one family of controls wants its program spelt.",
        "type": "object",
        "properties": {key.key: {"description": key.help, **key.kind.schema()} for key in keys},
        "required": [key.key for key in keys if key.default is dataclasses.MISSING],
        "additionalProperties": False,
    }
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    sys.stdout.write(schema_text())
