"""A session: one nest, what is wanted of it, and the plans that were made. All tabs that show the nest share it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.nest_job.beside import beside_name
from kerfwise.jobs.solve_options import WORK
from kerfwise.models.engines.solution import MEMORY_GB

from .alternative import Alternative
from .job_text import JobText
from .news import News
from .wanted import Wanted

MOST_ALTERNATIVES = 60
"""Plans that a session keeps; the oldest that is not shown goes first."""


class Stale(Exception):
    """Something was to be changed that another tab has changed meanwhile."""


@dataclass(eq=False)
class Session:
    """What the server knows of one nest. Whatever changes it counts `version` up and is told in `news`.

    Attributes
    ----------
    id, name
        In addresses, and in the folder.
    wanted
        What is to be planned next.
    opened
        What the desk says of it: profile, rules, locks.
    alternatives, shown
        The plans that were made, and the number of the one that is looked at; 0 for none.
    solving
        What the engines have reached; None where nothing is being planned.
    conflict, problem
        Why the last planning made no plan: rules that contradict each other, or a sentence.
    """

    id: str
    name: str
    wanted: Wanted
    opened: dict[str, Any]
    news: News
    version: int = 1
    alternatives: list[Alternative] = field(default_factory=list)
    shown: int = 0
    made: int = 0
    solving: dict[str, Any] | None = None
    conflict: dict[str, Any] | None = None
    problem: str = ""
    saved: dict[str, Any] | None = None
    on_disk: str | None = None

    def expect(self, version: object) -> None:
        """Make sure that whoever changes something has seen the last change; Stale otherwise."""
        if version != self.version:
            raise Stale

    def changed(self, **values: Any) -> None:
        """Change something, and tell all who show it."""
        for name, value in values.items():
            setattr(self, name, value)
        self.version += 1
        self.tell("state")

    def tell(self, what: str) -> None:
        """Tell all who show it that there is news."""
        self.news.tell(what, self.id)

    def opened_again(self, wanted: Wanted, opened: dict[str, Any], on_disk: str | None) -> None:
        """Begin anew, for the nest or its job file is another one on disk; tabs that show it are told.

        Raises
        ------
        InputError
            If it is being planned.
        """
        if self.solving is not None:
            raise InputError("this nest has changed on disk while it is being planned: cancel that first, or wait")
        nothing: dict[str, Any] = {"alternatives": [], "shown": 0, "conflict": None, "problem": "", "saved": None}
        self.changed(wanted=wanted, opened=opened, on_disk=on_disk, **nothing)

    @property
    def read(self) -> tuple[str, bool, str | None]:
        """What it was read from: the nest's sha256, whether it was mended, and the job file's text."""
        return self.opened["sha256"], self.wanted.repair, self.on_disk

    @property
    def current(self) -> Alternative | None:
        """The plan that is looked at."""
        return next((one for one in self.alternatives if one.number == self.shown), None)

    def looked_at(self, number: int | None) -> Alternative | None:
        """A plan by its number, or with None the one that is shown, if there is one."""
        return self.current if number is None else self.alternative(number)

    def alternative(self, number: object) -> Alternative:
        """A plan by its number; InputError if there is none."""
        found = next((one for one in self.alternatives if one.number == number), None)
        if found is None:
            raise InputError(f"there is no plan {number!r} in this session")
        return found

    def add(self, told: dict[str, Any], wanted: Wanted, relax: bool) -> None:
        """Keep a plan that was made, and show it."""
        work = told["work"]
        options = f" --work {work:g}" if work != WORK else ""
        options += f" --memory {told['memory_gb']:g}" if told["memory_gb"] != MEMORY_GB else ""
        options += " --relax" if relax else ""
        keys = ("sha256", "files", "plan_file", "program_file", "page", "figures", "summary", "ok", "stopped")
        parts = {key: told[key] for key in keys}
        broken, notes = tuple(told["broken"]), tuple(told["notes"])
        made = Alternative(self.made + 1, wanted, **parts, broken=broken, options=options, notes=notes)
        kept = [*self.alternatives, made]
        if len(kept) > MOST_ALTERNATIVES:
            kept.remove(next(one for one in kept if one.number != self.shown))
        self.changed(alternatives=kept, shown=made.number, made=made.number, solving=None, conflict=None, problem="")

    def as_json(self) -> dict[str, Any]:
        """The state as a page shows it."""
        current = self.current
        return {
            "id": self.id,
            "nest": self.name,
            "server": self.news.server,
            "version": self.version,
            **{key: self.opened[key] for key in ("profile", "notes", "locked", "settings", "rules")},
            "job_file": beside_name(Path(self.wanted.nest).name),
            "job_text": self.wanted.job_text,
            "repair": self.wanted.repair,
            "upto": self.wanted.upto,
            "shown": self.shown,
            "sha256": self.opened["sha256"],
            "fits": current is not None and (current.wanted, current.sha256) == (self.wanted, self.opened["sha256"]),
            "alternatives": [one.as_json(_locks(one.wanted)) for one in self.alternatives],
            "solving": self.solving,
            "conflict": self.conflict,
            "problem": self.problem,
            "saved": self.saved,
        }


def _locks(wanted: Wanted) -> tuple[str, ...]:
    return tuple(line for line, _ in JobText(wanted.job_text or "").lines())


def back_to(session: Session, number: object) -> Wanted:
    """What was wanted when an earlier plan was made; with a job file that says nothing where one was saved since."""
    before = session.alternative(number).wanted
    text = "" if before.job_text is None and session.on_disk is not None else before.job_text
    return replace(before, job_text=text, profile_now=session.wanted.profile_now)


def cut_up_to(session: Session, upto: int) -> Wanted:
    """The same wanted of what is left once the first cuts of the shown plan are made; all of it again with 0."""
    if upto == 0:
        return replace(session.wanted, old_plan=None, upto=0)
    current = session.current
    if current is None:
        raise InputError("there is no plan yet that could be cut up to some place")
    return replace(session.wanted, old_plan=current.plan, upto=upto)
