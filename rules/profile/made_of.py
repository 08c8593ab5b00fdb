"""The files that a profile is made of: itself, those it is based on, its chart, its dialect, rules of its own."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

from kerfwise.encoder.contents import contents, is_file
from kerfwise.rules.flat.model_file import read_model_file
from kerfwise.rules.flat.model_rule import options_class
from kerfwise.rules.options.kind import OptionKind
from kerfwise.rules.options.option import options_of
from kerfwise.rules.own import OwnFile

from .dialect_kind import is_own_dialect
from .profile import Profile
from .profile_sections import of_own


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
    rules = [*profile.known_rules().values(), *(of_own(own) for own in profile.own_rules if isinstance(own, OwnFile))]
    of_files = [rule.stands_in.sha256 for rule in rules if rule.stands_in is not None]
    of_files += [f"based on {sha256}" for sha256 in bases]
    if profile.chart is not None:
        of_files.append(f"chart {profile.chart.sha256}")
    if is_own_dialect(profile.machine.dialect) and is_file(profile.machine.dialect):
        of_files.append(f"dialect {hashlib.sha256(contents(profile.machine.dialect)).hexdigest()}")
    text = hashlib.sha256(content).hexdigest()
    return hashlib.sha256("\n".join([text, *of_files]).encode()).hexdigest() if of_files else text


def parameters_of(path: Path) -> dict[str, OptionKind]:
    """The parameters that the rule in a model file declares, by key.

    Raises
    ------
    InputError
        If the file is no rule.
    """
    return {o.key: o.kind for o in options_of(options_class(read_model_file(path).parameters))}
