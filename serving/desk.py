"""The process that answers at once: what a nest is, what a move would do, why a contour is cut where it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.read import BrokenNest
from kerfwise.encoder.shown import shown
from kerfwise.jobs.compare import Side, SideAsked, compare, side_of
from kerfwise.jobs.explaining import Explainer
from kerfwise.jobs.given import Given
from kerfwise.jobs.moving import Moved, Mover
from kerfwise.jobs.page.heat import heat_data
from kerfwise.jobs.page.page import compared_data, page_data
from kerfwise.jobs.page.why import why_data
from kerfwise.models.plan.explain import as_text
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.reader import plan_in
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.lock_text import lines_of

from .asking import Answers, Asking
from .edits import against, edited
from .job_text import JobText, settings_of
from .kept import Kept
from .problems import Unmended, left_by
from .profile_desk import profile_answers
from .wanted import Wanted, already_of, given_of


@dataclass(frozen=True)
class _Read:
    """A nest with its profile, and what was said while both were read."""

    given: Given
    notes: tuple[str, ...]


class Desk:
    """Answers questions about nests and plans; what it has worked out serves the next one."""

    def __init__(self) -> None:
        self._reads, self._plans, self._sides = Kept(), Kept(), Kept()

    def ready(self) -> bool:
        """All is loaded."""
        return True

    def prepared(self, wanted: Wanted, plan: str) -> bool:
        """Work out what moves and reasons need, before anybody asks."""
        return bool(self._mover(wanted, plan)[0].setting.route)

    def opened(self, wanted: Wanted) -> dict[str, Any]:
        """What there is to know of a nest before it is planned."""
        read = self._read(wanted, again=True)
        already_of(wanted, read.given)
        nest, profile = read.given.nest, read.given.profile
        numbered = {} if profile.for_one_nest is None else dict(profile.for_one_nest.numbered)
        text = JobText(wanted.job_text or "")
        return {
            "file": nest.file,
            "sha256": nest.sha256,
            "profile": profile.name,
            "notes": list(read.notes),
            "numbered": numbered,
            "locked": [line for line, _ in text.lines()],
            "settings": dict(settings_of(text.job())),
            "rules": [_rule(read.given, name) for name in {**profile.rules, **profile.settings()}],
        }

    def edited(self, wanted: Wanted, changes: Sequence[dict[str, Any]]) -> dict[str, Any]:
        """The job file with changes made in it, and what gave way; refused whole where one of them cannot be."""
        read = self._read(wanted)
        text, undone = edited(wanted, read.given, changes)
        return {"job_text": text, "undone": undone}

    def page(self, wanted: Wanted) -> dict[str, Any]:
        """What the page shows of a nest that is not planned."""
        return page_data(self._read(wanted).given, None)

    def compared(self, sides: Sequence[tuple[str, Wanted, str]]) -> dict[str, Any]:
        """What the page shows of two plans side by side: each a name, what was wanted, and the plan."""
        return compared_data(compare(*(self._side(*side) for side in sides)))

    def heat(self, wanted: Wanted, plan: str) -> dict[str, Any] | None:
        """How hot a plan makes the sheet, in frames; None where its profile says nothing of heat."""
        return heat_data(self._read(wanted).given, plan_in(plan), wanted=None)

    def why(self, wanted: Wanted, plan: str, contour: str) -> dict[str, Any]:
        """Why a contour is cut where it is, as the page shows it, and as `text`."""
        told = self._mover(wanted, plan)[0].explain(contour)
        return why_data(told) | {"text": as_text(told)}

    def move(
        self, wanted: Wanted, plan: str, contours: Sequence[str], place: int, look: bool = False
    ) -> dict[str, Any]:
        """Whether contours can be cut from another place on, what it costs, or what forbids it; nothing is planned.

        `locks` are what a drop there would lock, and `undone` those of before that it takes the place of.
        """
        explainer, mover = self._mover(wanted, plan)
        contours = _contours_of(self._read(wanted).given.nest, contours)
        locks = self._locks_of(explainer, contours, place)
        gone = self._against(wanted, locks)
        moved, _ = mover.move(contours, place, [lock.because for lock in gone], look)
        return {
            "contours": list(moved.contours),
            "place": moved.place,
            "lawful": moved.lawful,
            "gives_way": _gives_way(explainer, moved),
            "more_mm": moved.more_mm,
            "looked": moved.looked,
            "text": shown(moved.sentence),
            "breaks": [{"rule": a.rule, "contours": list(a.contours), "text": shown(a.sentence)} for a in moved.breaks],
            "locked": [line for lock in locks for line in lines_of(lock)],
            "undone": [line for lock in gone for line in lines_of(lock)],
        }

    def _locks_of(self, explainer: Explainer, contours: Sequence[str], place: int) -> list[Lock]:
        """The places of contours that are moved together: they keep their order."""
        at = {planned.cut.contour: k for k, planned in enumerate(explainer.plan.cuts)}
        order = sorted(contours, key=lambda name: at.get(name, -1))
        return [Lock(contour=name, position=k) for k, name in enumerate(order, place)]

    def _against(self, wanted: Wanted, locks: Sequence[Lock]) -> list[Lock]:
        """The locks of the job file that give way to others."""
        given, text = self._read(wanted).given, JobText(wanted.job_text or "")
        gone = set(against(given.nest, text, locks))
        return [] if given.job is None else [lock for lock in given.job.locks if gone & set(lines_of(lock))]

    def _read(self, wanted: Wanted, again: bool = False) -> _Read:
        def read() -> _Read:
            notes: list[str] = []
            try:
                return _Read(given_of(wanted, notes.append), tuple(map(shown, notes)))
            except BrokenNest as broken:
                if wanted.repair:
                    raise
                raise Unmended(broken, left_by(lambda: given_of(replace(wanted, repair=True)))) from None

        return self._reads.get(wanted.key, read, again)

    def _mover(self, wanted: Wanted, plan: str) -> tuple[Explainer, Mover]:
        def made() -> tuple[Explainer, Mover]:
            explainer = Explainer(*self._planned(wanted, plan), None)
            return explainer, Mover(explainer)

        return self._plans.get((wanted.key, plan), made)

    def _side(self, name: str, wanted: Wanted, plan: str) -> Side:
        def made() -> Side:
            given, made_of = self._planned(wanted, plan)
            return side_of(SideAsked(name, given, made_of))

        return self._sides.get((name, wanted.key, plan), made)

    def _planned(self, wanted: Wanted, plan: str) -> tuple[Given, Plan]:
        """A plan, with the nest and the profile that it is of."""
        made_of, given = plan_in(plan), self._read(wanted).given
        if made_of.profile.get("sha256") != given.profile.sha256:  # it was changed on disk since it was read
            given = self._read(wanted, again=True).given
        return given, made_of


def _contours_of(nest: Nest, names: Sequence[str]) -> list[str]:
    """The contours that ids and parts stand for; InputError if there are none."""
    parts = nest.part_of
    found = [one for name in names for one in ([name] if name in nest.index else [c.id for c in parts.get(name, ())])]
    if not found:
        raise InputError(f"the nest has no {', '.join(repr(shown(name)) for name in names)}")
    return list(dict.fromkeys(found))


def _gives_way(explainer: Explainer, moved: Moved) -> list[str]:
    """The rules that give way to a lock there, where no others are broken: it can be locked all the same."""
    book = explainer.profile.rulebook()
    rules = list(dict.fromkeys(about.rule for about in moved.breaks))
    return rules if all(rule in book and book[rule].gives_way for rule in rules) else []


def _rule(given: Given, name: str) -> dict[str, Any]:
    """A rule as its slider shows it; one of the plant's own has no key that can be set."""
    profile = given.profile
    rule, setting = profile.rulebook()[name], profile.rules.get(name) or profile.settings()[name]
    return {
        "id": name,
        "sentence": shown(rule.sentence),
        "strength": setting.strength,
        "strengths": list(rule.strengths),
        "weight_mm": setting.weight,
        "default_weight_mm": rule.default_weight,
        "settable": name in profile.rules,
    }


def desk(asking: Asking) -> Answers:
    """The questions that the desk answers."""
    made = Desk()
    names = ("ready", "prepared", "opened", "edited", "page", "compared", "heat", "why", "move")
    return {**{name: getattr(made, name) for name in names}, **profile_answers()}
