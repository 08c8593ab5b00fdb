"""Dialects by name: those that come with kerfwise, and a plant's own files."""

from __future__ import annotations

import dataclasses
from importlib import resources

import yaml

from kerfwise.encoder.contents import MOST_BYTES_OF_YAML, contents
from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import Problems, compose, deepest, entries, wrong_at
from kerfwise.rules.profile.machine_section import PierceDwell
from kerfwise.rules.profile.profile import Profile

from .dialect import Dialect
from .kinds import POWERS

_COARSEST_MM = 0.1


def pierce_dwell_of(profile: Profile, dialect: Dialect | None = None) -> PierceDwell:
    """Who waits at a pierce: what the profile says, else the dialect of its machine."""
    return profile.machine.pierce_dwell or (dialect or load_dialect(profile.machine.dialect)).pierce_dwell


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

    Raises
    ------
    InputError
        For a name that is not there, and for a file that cannot be read.
    """
    if name.endswith((".yaml", ".yml")):
        try:
            return contents(name, MOST_BYTES_OF_YAML).decode("utf-8")
        except OSError as error:
            raise InputError(f"cannot read the dialect: {error.strerror}", file=name) from None
        except UnicodeDecodeError:
            raise InputError("not a dialect: the file is not UTF-8 text", file=name) from None
        except ValueError as error:  # a NUL, or half a character
            raise InputError(f"cannot read the dialect: no file can have this name ({error})", file=name) from None
    if name not in dialect_names():
        raise InputError(f"{unknown('dialect', name, dialect_names())}; the file of a plant's own ends in .yaml")
    return resources.files(__package__).joinpath(f"{name}.yaml").read_text(encoding="utf-8")


def load_dialect(name: str) -> Dialect:
    """The dialect of that name, or of a plant's own file when `name` ends in .yaml.

    Raises
    ------
    InputError
        For a name that is not there, and for a file that lacks a key, has one too many or one of the wrong type.

    Examples
    --------
    >>> load_dialect("linuxcnc-qtplasmac").torch_on
    ('M3 $0 S1',)
    """
    text = dialect_text(name)
    return parse_dialect(text, name if name.endswith((".yaml", ".yml")) else f"{name}.yaml")


def parse_dialect(text: str, file: str) -> Dialect:
    """Read a dialect from YAML text; `file` is the name for messages (see `load_dialect`)."""
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
        try:
            values[known[key].name] = known[key].kind.read(node)
        except Unfit as error:
            problems.add(error.node or node, f"{key}: {error}")
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
