"""Profiles read from their files: shipped ones by name, a plant's own by path, with those that they are based on."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.shown import shown
from kerfwise.rules.outside import installed_rules

from .files import content_of, decoded
from .made_of import digest_of
from .profile import Profile
from .reader import GivenValues, read_given
from .sections import RuleSetting, default_settings

DEFAULT = "plasma-carbon-steel"
"""The shipped profile that is used where none is named."""
LONGEST_CHAIN = 20


def load_profile(name_or_path: str | Path = DEFAULT, *, trust: bool = False) -> Profile:
    """The shipped profile of that name, or the one in that file.

    `trust` lets it run the Python files that it names; without it only those run that the machine's configuration
    allows, see `rules/outside/trust.py`.

    Raises
    ------
    InputError
        If there is none, or it has a wrong key, type or value: with file, line, column, what was expected, and the
        nearest valid name. All mistakes of a file are reported at once. Also if a rule that a package or a Python file
        brings cannot be used, or the profile names a Python file that is not trusted.
    """
    return _load(str(name_or_path), Path(), (), trust)


def _load(name: str, folder: Path, chain: tuple[str, ...], trust: bool) -> Profile:
    file, place, content = content_of(name, folder)
    if file in chain:
        raise InputError(f"it goes in a circle: {' → '.join((*chain, file))}")
    if len(chain) >= LONGEST_CHAIN:
        raise InputError(f"more than {LONGEST_CHAIN} profiles are based on each other in a row")
    text = decoded(content, file)
    bases: list[str] = []

    def base(of: str) -> GivenValues:
        made = _load(of, Path(file).parent, (*chain, file), trust)
        bases.append(made.sha256)
        return _fields(made)

    given = read_given(text, file, _fields(_silent(shown(Path(file).stem))), base, trust)
    read_from = (*given.get("read_from", ()), place)
    made = Profile(**given | {"file": file, "read_from": read_from})
    return dataclasses.replace(made, sha256=digest_of(content, made, bases))


def _silent(name: str) -> Profile:
    """A profile that says nothing: the rules of installed packages are known, and off."""
    installed = installed_rules()
    off = {name: RuleSetting("off", None, rule.Options()) for name, rule in installed.items()}
    return Profile(name, rules=default_settings() | off, further_rules=installed)


def _fields(profile: Profile) -> GivenValues:
    return {f.name: getattr(profile, f.name) for f in dataclasses.fields(profile)}
