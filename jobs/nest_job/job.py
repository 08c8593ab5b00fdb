"""What a planner writes down about one nest: its profile, locks and settings, how many sheets, for whom and when."""

from __future__ import annotations

import datetime
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from kerfwise.encoder.questions import Answers
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Number, Pairs, Text
from kerfwise.rules.options.yaml_positions import Place
from kerfwise.rules.profile.files import shipped_profiles
from kerfwise.rules.profile.one_nest import Setting

from .day import Day

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

    profile: str | None = field(
        default=None, metadata=option(Text(), "name of a shipped profile, or path of one, from this file's folder")
    )
    machine: str | None = field(default=None, metadata=option(Text(), "name of the machine that the nest is for"))
    quantity: int = field(
        default=1, metadata=option(Number(1, MOST_SHEETS, whole=True), "how many sheets of the nest are cut")
    )
    order: str | None = field(default=None, metadata=option(Text(), "the order that the nest is cut for"))
    due: datetime.date | None = field(default=None, metadata=option(Day(), "day on which the sheets have to be ready"))
    answers: Answers = field(
        default=(), metadata=option(Pairs(), "answers to questions that the drawing raises, as in {frame: sheet}")
    )
    locks: tuple[Lock, ...] = ()
    settings: tuple[Setting, ...] = ()
    file: str = ""
    sha256: str = ""
    said_at: Mapping[str, Place] = field(default_factory=dict, compare=False)

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
