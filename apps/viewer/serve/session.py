"""A session: one nest, what is wanted of it, its plans, and who waits for news of them."""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import MOST_BYTES_OF_YAML
from kerfwise.jobs.nest_job.job import beside_name
from kerfwise.models.engines.tuning import MEMORY_GB
from kerfwise.models.engines.tuning import REQUEST_WORK as WORK

from .job_edits import JobText
from .news import News
from .plan_request import PlanRequest, start_plan_name

# A session: one nest, what is wanted of it, and the plans that were made. All tabs that show the nest share it.

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
    base
        The version of the last change that somebody has made: plans that arrive since then are no such change.
    runs, following
        How often it was planned, and the planning whose plans are shown as they come; 0 once somebody has gone back.
    solving
        How far the planning is; None where nothing is being planned.
    conflict, problem
        Why the last planning made no plan: rules that contradict each other, or a sentence.
    questions
        What it could not decide, such as what becomes of narrow slots: each with its choices, as JSON.
    on_disk
        What the job file beside the nest says, as it was read last.
    seen
        The drawing that somebody has seen: `sha256` and `shapes`, as the desk tells them.
    changed_job
        The job file was changed outside: what it says on `disk`, what is `kept` here, and which of them is `using`.
    keeper
        Keeps on disk what is told; None where nothing is.
    """

    id: str
    name: str
    wanted: PlanRequest
    opened: dict[str, Any]
    news: News
    version: int = 1
    base: int = 1
    alternatives: list[Alternative] = field(default_factory=list)
    shown: int = 0
    made: int = 0
    runs: int = 0
    following: int = 0
    solving: dict[str, Any] | None = None
    conflict: dict[str, Any] | None = None
    problem: str = ""
    questions: list[dict[str, Any]] = field(default_factory=list)
    saved: dict[str, Any] | None = None
    on_disk: str | None = None
    seen: dict[str, Any] | None = None
    changed_job: dict[str, Any] | None = None
    keeper: Keeper | None = None

    def expect(self, version: object, shown: bool = False) -> None:
        """Make sure that whoever changes something has seen the last change; Stale otherwise.

        Plans that have come meanwhile are such a change where it depends on which of them is `shown`.
        """
        if not isinstance(version, int) or not (self.version if shown else self.base) <= version <= self.version:
            raise Stale

    def changed(self, *, by_hand: bool = True, **values: Any) -> None:
        """Change something, keep it, and tell all who show it; `by_hand` unless it only has come from the planner."""
        for name, value in values.items():
            setattr(self, name, value)
        self.version += 1
        self.base = self.version if by_hand else self.base
        if self.keeper is not None:
            self.keeper.keep(self)
        self.tell("state")

    def tell(self, what: str) -> None:
        """Tell all who show it that there is news."""
        self.news.tell(what, self.id)

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

    def add(self, event: dict[str, Any], wanted: PlanRequest, relax: bool, run: int) -> Alternative:
        """Keep a plan that was made, and show it, unless somebody has gone back, or one of its planning costs less."""
        work = event["work"]
        options = f" --work {work:g}" if work != WORK else ""
        options += f" --memory {event['memory_gb']:g}" if event["memory_gb"] != MEMORY_GB else ""
        options += " --relax" if relax else ""
        parts = _parts_of(event) | {"options": options, "run": run}
        alternative = Alternative(self.made + 1, wanted, **parts)
        last = min((one for one in self.alternatives if one.run == run), key=lambda one: one.rank, default=None)
        if last is not None and last.unpriced == alternative.unpriced:
            alternative = replace(alternative, gained_mm=last.gain_of(event["figures"]))
        same = last is not None and not last.kept and last.same_order(alternative)
        kept = [one for one in self.alternatives if not (same and one is last)] + [alternative]
        best = last is None or same or alternative.rank <= last.rank
        shows = self.following == run and alternative.sha256 == self.opened["sha256"] and best
        shown = alternative.number if shows else self.shown
        if len(kept) > MOST_ALTERNATIVES:
            kept.remove(min((one for one in kept if one.number != shown), key=lambda one: (one.weight, one.number)))
        if self.keeper is not None:
            self.keeper.keep_plan(self, alternative)
        gone = [one.number for one in self.alternatives if one not in kept]
        undone: dict[str, Any] = {"conflict": None, "problem": "", "questions": []}
        self.changed(by_hand=False, alternatives=kept, shown=shown, made=alternative.number, **undone)
        for number in gone:
            if self.keeper is not None:
                self.keeper.forget_plan(self, number)
        return alternative

    def is_known(self, event: dict[str, Any], run: int) -> bool:
        """Whether a planning has shown a cheaper plan than one that it ends with."""
        before = [one.figures["objective_mm"] for one in self.alternatives if one.run == run and not one.unpriced]
        return bool(min(before, default=math.inf) < event["figures"]["objective_mm"])

    def check(self, number: int, event: dict[str, Any]) -> None:
        """The program of a plan that is there is written and checked; nothing where the plan is gone."""
        before = next((one for one in self.alternatives if one.number == number), None)
        if before is None:
            return
        checked = replace(before, **_parts_of(event))
        if self.keeper is not None:
            self.keeper.keep_plan(self, checked)
        now = [checked if one.number == number else one for one in self.alternatives]
        self.changed(by_hand=False, alternatives=now)

    def keep(self, number: int, kept: bool) -> None:
        """Have a plan never thrown away, however many come; or no longer."""
        plan = self.alternative(number)
        self.changed(alternatives=[replace(one, kept=kept) if one is plan else one for one in self.alternatives])

    def as_json(self) -> dict[str, Any]:
        """The state as a page shows it."""
        current = self.current
        return {
            "id": self.id,
            "nest": self.name,
            "server": self.news.server,
            "version": self.version,
            "base": self.base,
            **{key: self.opened[key] for key in ("profile", "notes", "locked", "settings", "rules")},
            "job_file": beside_name(Path(self.wanted.nest).name),
            "job_text": self.wanted.job_text,
            "repair": self.wanted.repair,
            "upto": self.wanted.upto,
            "shown": self.shown,
            "sha256": self.opened["sha256"],
            "fits": current is not None and (current.wanted, current.sha256) == (self.wanted, self.opened["sha256"]),
            "alternatives": [one.as_json(_locks(one.wanted), self.opened["sha256"]) for one in self.alternatives],
            "solving": self.solving,
            "conflict": self.conflict,
            "problem": self.problem,
            "questions": self.questions,
            "saved": self.saved,
        }


def _parts_of(event: dict[str, Any]) -> dict[str, Any]:
    """What the planner tells of a plan."""
    keys = ("sha256", "files", "plan_file", "program_file", "page", "figures", "summary", "ok", "stopped", "stage")
    parts = {key: event[key] for key in (*keys, "checked")} | {"unpriced": event.get("unpriced", False)}
    return parts | {"broken": tuple(event["broken"]), "notes": tuple(event["notes"])}


def _locks(wanted: PlanRequest) -> tuple[str, ...]:
    return tuple(line for line, _ in JobText(wanted.job_text or "").lines())


def restore_plan(session: Session, number: int) -> PlanRequest:
    """What was wanted when an earlier plan was made; with 0, for no plan, what is wanted now of the whole nest."""
    if number == 0:
        return replace(session.wanted, old_plan=None, upto=0)
    before = session.alternative(number).wanted
    return with_job_text(session, replace(before, profile_now=session.wanted.profile_now), before.job_text)


def with_job_text(session: Session, wanted: PlanRequest, text: object) -> PlanRequest:
    """The same by another job file; None is one that says nothing where one was saved since."""
    if not (text is None or (isinstance(text, str) and len(text.encode("utf-8", "replace")) <= MOST_BYTES_OF_YAML)):
        raise InputError(f"job_text: expected a text of at most {MOST_BYTES_OF_YAML} bytes, or null")
    return replace(wanted, job_text="" if text is None and session.on_disk is not None else text)


def request_after_cuts(session: Session, wanted: PlanRequest, number: int, upto: int) -> PlanRequest:
    """The same wanted of what is left once the first cuts of a plan are made; all of it again with 0."""
    if upto == 0:
        return replace(wanted, old_plan=None, upto=0)
    if number == 0:
        raise InputError("there is no plan yet that could be cut up to some place")
    return replace(wanted, old_plan=session.alternative(number).plan, upto=upto)


class Keeper(Protocol):
    """Keeps what a session holds."""

    def keep(self, session: Session) -> None:
        """Keep what is wanted and shown."""

    def keep_plan(self, session: Session, plan: Alternative) -> None:
        """Keep a plan, in place of what was kept of it before."""

    def forget_plan(self, session: Session, number: int) -> None:
        """Keep a plan no longer."""


# One plan of a session's history, with all that it was made of.


@dataclass(frozen=True, slots=True)
class Alternative:
    """A plan that was made, and what it was made of.

    `sha256` is that of the nest's file. `files` are the plan's files by name, as `kerfwise solve` writes them; those
    of the plan and the program are called `plan_file` and `program_file`. `page` is what the page shows of it, as JSON;
    `figures` what a list of plans says of it. `stopped` says that the engines were asked to end: then the command line
    may come further. `options` are those of the command line beside what is wanted. `run` is the planning that has made
    it, `stage` whether it was its `first` plan, a `better` one or the `final` one, `gained_mm` how much travel it saves
    against the best before; None where there is none, or the excuses are others. `kept` says that somebody wants it
    kept, however many come. Of one that is not `checked` there is no program yet: nothing is known of that. One that is
    `unpriced` costs what rules say alone: what a simulation finds would be paid for besides.
    """

    number: int
    wanted: PlanRequest
    sha256: str
    files: Mapping[str, Packed]
    plan_file: str
    program_file: str
    page: Packed
    figures: Mapping[str, Any]
    summary: str
    ok: bool
    broken: tuple[str, ...] = ()
    stopped: bool = False
    options: str = ""
    notes: tuple[str, ...] = field(default=())
    run: int = 0
    stage: str = "final"
    gained_mm: float | None = None
    kept: bool = False
    checked: bool = True
    unpriced: bool = False

    @property
    def rank(self) -> tuple[bool, float]:
        """The less the better: plans that are asked for all first, the cheapest first of all."""
        return self.unpriced, self.figures["objective_mm"]

    def gain_of(self, figures: Mapping[str, Any]) -> float | None:
        """How much less idle travel and the like other figures have, mm; None where the excuses are others."""
        same = figures["excuses"] == self.figures["excuses"]
        return float(self.figures["light_mm"] - figures["light_mm"]) if same else None

    def same_order(self, other: Alternative) -> bool:
        """Whether another plan cuts the same in the same order, entry by entry."""
        cost, other_cost = self.figures["objective_mm"], other.figures["objective_mm"]
        return bool(abs(cost - other_cost) < 1e-6 and _cuts_of(self) == _cuts_of(other))

    @property
    def state(self) -> str:
        """`kept`, `kept but for` or `broken`; `unchecked` where the plan alone was judged."""
        return str(self.figures["state"]) if self.checked else "unchecked"

    @property
    def weight(self) -> int:
        """How much it would be missed: least what was shown on the way to a better one."""
        return 2 if self.kept else int(self.stage == "final")

    @property
    def plan(self) -> str:
        """The plan, as JSON."""
        return self.files[self.plan_file].text()

    @property
    def program(self) -> str:
        """The NC text; InputError where there is none yet."""
        if not self.checked:
            raise InputError("the program of this plan is not written and checked yet")
        return self.files[self.program_file].text()

    @property
    def command(self) -> str:
        """The command line that makes the same files, once its job file is saved."""
        return self.wanted.command(self.options, start_plan_name(self.wanted.nest) in self.files)

    def as_json(self, locks: tuple[str, ...], sha256: str) -> dict[str, Any]:
        """What a page shows of it in the list of plans; `sha256` is that of the drawing as it is now."""
        return {
            "number": self.number,
            "figures": dict(self.figures),
            "summary": self.summary,
            "ok": self.ok,
            "broken": list(self.broken),
            "stopped": self.stopped,
            "command": self.command,
            "notes": list(self.notes),
            "locked": list(locks),
            "upto": self.wanted.upto,
            "run": self.run,
            "stage": self.stage,
            "proven": self.figures["status"] == "optimal",
            "gained_mm": self.gained_mm,
            "kept": self.kept,
            "checked": self.checked,
            "unpriced": self.unpriced,
            "of_now": self.sha256 == sha256,
        }


def _cuts_of(plan: Alternative) -> list[tuple[Any, ...]]:
    return [(cut["contour"], cut["entry"], cut["direction"]) for cut in json.loads(plan.plan)["cuts"]]


# Text that is kept by the dozen and looked at one by one: a plan's files, and what the page shows of it.

_QUICK = 1
"""A level that packs some hundred megabytes a second; what repeats itself in a plan, it finds too."""


@dataclass(frozen=True, slots=True)
class Packed:
    """A text, compressed.

    Examples
    --------
    >>> packed = Packed.of("G1 X10 Y10\\n" * 1000)
    >>> packed.text() == "G1 X10 Y10\\n" * 1000, len(packed.data) < 500
    (True, True)
    """

    data: bytes

    @classmethod
    def of(cls, text: str) -> Packed:
        """The text, compressed; names that are no Unicode keep their bytes."""
        return cls(zlib.compress(text.encode("utf-8", "surrogatepass"), _QUICK))

    def text(self) -> str:
        """The text as it was."""
        return self.bytes().decode("utf-8", "surrogatepass")

    def bytes(self) -> bytes:
        """The text in UTF-8."""
        return zlib.decompress(self.data)
