"""A plant's own profile, begun as a copy of another: comments stay, and what comes of it can be used at once."""

from __future__ import annotations

import contextlib
import os
import re
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.dialects import load_dialect
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect
from kerfwise.rules.options.kind import OptionKind, Text, Unfit
from kerfwise.rules.options.option import options_of
from kerfwise.rules.options.yaml_positions import compose, with_value
from kerfwise.rules.profile.load import load_profile, profile_text, shipped_profiles
from kerfwise.rules.profile.sections import SECTIONS
from kerfwise.rules.profile.values import ProfileValues

_NAME = re.compile(r"[^\W_][\w.-]{0,60}")
_EDITOR = re.compile(r"^# yaml-language-server:.*\n", re.MULTILINE)
_ASKED = (
    ("machine", "dialect"),
    ("machine", "cut_feed"),
    ("machine", "travel"),
    ("machine", "pierce_time"),
    ("machine", "home"),
    ("material", "name"),
    ("material", "thickness"),
    ("material", "kerf"),
)
"""What differs from plant to plant, and cannot be guessed."""

Key = tuple[str, str]


@dataclass(frozen=True, slots=True)
class Question:
    """One key of a profile that a person is asked for: what it is, and the answer that stands if none is given."""

    key: Key
    text: str
    default: str
    kind: OptionKind
    process: str

    def answered(self, text: str) -> str:
        """The answer as it is written. Raises InputError if the key cannot have it: with what was expected."""
        node = compose(text, "")
        if node is None:
            raise InputError(f"expected {self.kind.expected()}")
        try:
            value = self.kind.read(node)
        except Unfit as error:
            raise InputError(str(error)) from None
        if self.key == ("machine", "dialect"):
            dialect = load_dialect(str(value))
            if self.process not in dialect.processes:
                raise InputError(
                    f"{value} is for {', '.join(dialect.processes)}, and this machine cuts by {self.process}"
                )
        return text.strip()


def questions(like: ProfileValues) -> Iterator[Question]:
    """What is asked of a new profile, with the answers of the one that it is like."""
    for section, key in _ASKED:
        option = next(o for o in options_of(SECTIONS[section]) if o.key == key)
        value = getattr(getattr(like, section), option.name)
        yield Question((section, key), option.help, option.kind.write(value), option.kind, like.machine.process)


def new_profile_text(name: str, like: str, answers: Mapping[Key, str] | None = None, folder: Path | None = None) -> str:
    """The text of the profile `like` under another name, with other values where there are answers.

    What it is based on is named as seen from `folder`, where the text will stand; without one it stands beside `like`.
    Raises InputError for a name that no profile can have or a shipped one has, and where `like` cannot be read.

    Examples
    --------
    >>> text = new_profile_text("shop", "water-jet", {("material", "kerf"): "0.9 mm"})
    >>> [row.split("#")[0].strip() for row in text.splitlines() if row.strip().startswith(("name: shop", "kerf"))]
    ['name: shop', 'kerf: 0.9 mm']
    """
    if not _NAME.fullmatch(name):
        raise InputError(f"{name!r} cannot be a profile's name: expected letters, digits, dots and dashes")
    if name in shipped_profiles():
        raise InputError(f"{name} is the name of a profile that comes with kerfwise: choose another")
    text = with_value(_EDITOR.sub("", profile_text(like)), ["name"], name)
    if folder is not None and like not in shipped_profiles():
        text = _based_as_before(text, Path(like), folder)
    for key, value in (answers or {}).items():
        text = with_value(text, key, value)
    return f"# Begun as a copy of {Path(like).name}. Change what differs; `kerfwise profile check` reads it.\n{text}"


def _based_as_before(text: str, like: Path, folder: Path) -> str:
    """The text of a profile from another folder, based on the same file; who reads it finds what is wrong with that."""
    root = compose(text, "")
    entries = root.value if isinstance(root, yaml.MappingNode) else ()
    base = next((value.value for key, value in entries if key.value == "based_on"), None)
    if not isinstance(base, str) or not base or base in shipped_profiles() or Path(base).is_absolute():
        return text
    there, here = os.path.realpath((like.parent / base).parent), os.path.realpath(folder)
    if here == os.path.realpath(like.parent):
        return text
    with contextlib.suppress(ValueError):  # no way from one drive to another
        there = os.path.relpath(there, here)
    return with_value(text, ["based_on"], Text().write((Path(there) / Path(base).name).as_posix()))


def expect_usable(text: str, path: Path, trust: bool = False) -> ProfileValues:
    """The profile that a text will be at a path; files that it names are looked for from there.

    Raises InputError if it cannot be used there: with what is wrong.
    """
    handle, name = tempfile.mkstemp(prefix=".kerfwise-", suffix=".yaml", dir=path.parent)
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
        profile = load_profile(name, trust=trust)
        trusted_dialect(profile)
    except InputError as error:
        there = error.file is not None and Path(error.file) == Path(name)
        place = {"line": error.line, "column": error.column} if there else {}
        shown_file = path if there or error.file is None else error.file
        details = tuple(line.replace(name, str(path)) for line in error.details)
        message = f"nothing is written, for this profile could not be used: {error.message}"
        raise InputError(message, file=shown_file, details=details, **place) from error
    finally:
        os.unlink(name)
    return profile
