"""A nest with all that is asked for it by profile, job file and command line; contours as people name them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache
from pathlib import Path
from typing import Literal

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, is_file, read_named, utf8_text
from kerfwise.encoder.nearest_name import unknown
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.questions import OF_CUTTING, OF_LAYERS, Answers, answer_problem, with_answers
from kerfwise.jobs.inputs import (
    DrawingSaid,
    Inputs,
    NestLike,
    ProfileLike,
    Tell,
    drawn_nest,
    is_plan_file,
    plant_of,
    program_text,
    refit_as_made,
    silent,
)
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.postproc.check.bevels import upright
from kerfwise.postproc.check.cuts_from_program import rebuild
from kerfwise.postproc.check.reader.read_program import read_on_machine
from kerfwise.postproc.output_files import write_files
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.yaml_positions import wrong_at
from kerfwise.rules.profile.contradictions import rule_option_problems
from kerfwise.rules.profile.load import DEFAULT
from kerfwise.rules.profile.overrides import Setting, lines_of, with_settings
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.values import ForOneNest

from .job import Job, beside_name, job_beside, misnamed, read_job, with_kept

JobLike = Job | str | Path | Literal[False] | None
"""A job, the path of its file, False for none, or None for the one beside the nest."""


@dataclass(frozen=True, slots=True)
class NestRequest:
    """What is asked for a nest by whoever runs kerfwise; what is not, its job file says, or else its profile.

    `last` is the plan (or program, or its path) in which contours have the numbers that locks call them by; None for
    the plan beside the nest. `date` is the day that the program's top says, "" for that of the job file. `trust` lets
    Python rules run that the profile names.
    """

    profile: ProfileLike | None = None
    job: JobLike = None
    settings: tuple[Setting, ...] = ()
    locks: tuple[Lock, ...] = ()
    answers: Answers = ()
    last: Plan | str | Path | None = None
    date: str = ""
    trust: bool = False


NOTHING = NestRequest()
"""Nothing is asked: the job file beside the nest, or the default profile."""


def job_for(nest: NestLike, job: JobLike, tell: Tell = silent) -> Job | None:
    """The job that is given, or the one in the file beside the nest, which is then told.

    Raises InputError if a job file cannot be read or is wrong anywhere.
    """
    if isinstance(job, Job) or job is False:
        return job or None
    if job is not None:
        return read_job(job)
    beside = job_beside(nest) if isinstance(nest, str | Path) else None
    if beside is None:
        if isinstance(nest, str | Path) and (other := misnamed(nest)) is not None:
            tell(f"{other} is not read: the job file of {Path(nest).name} is called {beside_name(nest)}")
        return None
    tell(f"the job file {beside} belongs to the nest and is read (--no-job, in Python job=False, goes without it)")
    return read_job(beside)


def profile_for(request: NestRequest, job: Job | None, tell: Tell = silent) -> Profile:
    """The profile that is given, else that of the job file, else the default, with what job and asker set in it.

    Raises InputError if there is no such profile, or it or a setting is wrong: with its place.
    """
    named = None if job is None else job.profile_path
    if request.profile is None and job is not None and named is not None:
        try:
            plant = plant_of(named, request.trust)
        except InputError as error:
            if error.line is not None or not error.message.startswith(("unknown profile", "cannot read the profile")):
                raise
            raise wrong_at(job.said_at.get("profile"), f"profile: {error}") from None
    else:
        plant = plant_of(DEFAULT if request.profile is None else request.profile, request.trust)
    if job is not None and request.profile is not None and named is not None:
        tell(f"{job.name} names the profile {job.profile}: the one that is given, {plant.name}, goes before it")
    if job is not None and job.machine is not None and job.machine.casefold() != plant.name.casefold():
        tell(f"{job.name} is for the machine {job.machine}, and the profile is {plant.name}")
    return with_values(answered(plant, job, request.answers), job, request.settings, request.locks, request.date)


def answered(plant: Profile, job: Job | None, answers: Answers) -> Profile:
    """The profile with the answers of the job file, and those given beside it, to questions that the drawing raises.

    Raises InputError for an answer to a question that no drawing raises, or a choice that it does not have.
    """
    for question, choice in answers:
        if (problem := answer_problem(question, choice)) is not None:
            raise InputError(problem[0])
    told = with_answers(() if job is None else job.answers, answers)
    if told:
        plant = replace(plant, drawing=replace(plant.drawing, answers=with_answers(plant.drawing.answers, told)))
    return plant.as_answered()


def locked_for(
    nest: Nest, nest_file: str | Path | None, plant: Profile, request: NestRequest, job: Job | None, tell: Tell = silent
) -> Inputs:
    """The nest, and the profile with the locks of job and asker on the nest's contours.

    Raises InputError if a lock names what the nest does not have: with its place.
    """
    last = cache(lambda: last_plan(request.last, nest, nest_file, plant))
    return Inputs(nest, with_locks(plant, nest, job, request.locks, last, tell), job)


def profile_with_locks(plant: Profile, request: NestRequest, job: Job | None) -> Profile:
    """The profile with the locks of job and asker as they are written, where there is no nest to find them on."""
    return replace(plant, locks=(*plant.locks, *(() if job is None else job.locks), *request.locks))


def inputs_for(nest: NestLike, request: NestRequest = NOTHING, tell: Tell = silent) -> Inputs:
    """A nest as it is to be cut, and its profile, with all that is asked for it.

    Raises InputError if something given cannot be read, or is wrong: with its place.
    """
    laid = isinstance(request.profile, Profile) and request.profile.for_one_nest is not None
    job = None if laid and request.job is None else job_for(nest, request.job, tell)
    plant = profile_for(request, job, tell)
    refit_mm = None if isinstance(nest, Nest) else refit_as_made(None, request.last, plant, tell)
    read = plant.as_cut(drawn_nest(nest, plant, DrawingSaid(refit_arcs_mm=refit_mm)))
    return locked_for(read, None if isinstance(nest, Nest) else nest, plant, request, job, tell)


def locks_told(profile: Profile) -> str:
    """That a profile has locks, which belong to one nest each, in a sentence; "" where it has none of its own file."""
    placed = [
        lock.place for lock in profile.locks if lock.place is not None and not lock.place.file.endswith(".job.yaml")
    ]
    if not placed:
        return ""
    return f"{placed[0]}: the profile has locks; they belong to one nest: write them in its job file, NEST.job.yaml"


# A profile with what belongs to one nest laid over it: profile < job file < command line.


def with_values(
    profile: Profile, job: Job | None, settings: Sequence[Setting], locks: Sequence[Lock], date: str = ""
) -> Profile:
    """The profile with what the job file sets, then what was set beside it; its locks come later, on the nest.

    Raises InputError if a key or value is wrong: with its place.
    """
    if job is not None:
        profile = with_settings(profile, job.settings, job.file)
    profile = with_settings(profile, settings)
    if job is None and not settings and not locks and not date:
        return profile
    old = profile.for_one_nest or ForOneNest()
    lines = (*old.locks, *(line for lock in locks for line in lines_of(lock)))
    file, sha256 = (old.file, old.sha256) if job is None else (job.name, job.sha256)
    read = (job.file,) if job is not None and job.file else ()
    said = {**old.said, **({} if job is None else job.said), **({"date": date} if date else {})}
    made_with = ForOneNest(file, sha256, (*old.settings, *map(str, settings)), lines, said=said)
    return replace(profile, for_one_nest=made_with, read_from=(*profile.read_from, *read))


def with_locks(
    profile: Profile, nest: Nest, job: Job | None, locks: Sequence[Lock], last: Callable[[], LastPlan], tell: Tell
) -> Profile:
    """The profile with the locks of the job file, and those that were said beside it, on the contours of the nest.

    Where two decide the same, the later stands, and that is told; within one place both stand, and clash. Raises
    InputError if a lock names what the nest does not have, with its place, or asks for what a rule would make that is
    off.
    """
    layers = [layer for layer in ((() if job is None else job.locks), locks) if layer]
    if not layers:
        return profile
    made_with = profile.for_one_nest or ForOneNest()
    names = Names(nest, lambda name: last().contour(name, made_with))
    found = [[one for lock in layer for one in names.on_nest(lock)] for layer in (profile.locks, *layers)]
    for number, contour in names.numbered.items():
        tell(f"{number} is {contour}, as in {last().name}")
    with_numbers = replace(made_with, numbered=dict(names.numbered))
    laid = replace(profile, locks=_standing(found, tell), for_one_nest=with_numbers)
    for _, _, text in rule_option_problems(laid.plant, laid.rules, laid.known_rules()):
        raise InputError(text, file=job.file if job is not None and job.locks else None)
    return laid


def _standing(layers: Sequence[Sequence[OnNest]], tell: Tell) -> tuple[Lock, ...]:
    """The locks of all layers but those that one of a later layer decides otherwise."""
    kept: list[Lock] = []
    for k, layer in enumerate(layers):
        later = [one for further in layers[k + 1 :] for one in further]
        for one in layer:
            by = next((other for other in later if other.against(one)), None)
            if by is None:
                kept += one.locks
            elif by.locks != one.locks:
                tell(f"{_told(one)} gives way to {_told(by)}")
    return tuple(kept)


def _told(one: OnNest) -> str:
    where = f" ({one.said.place})" if one.said.place else f" ({one.said.reason})" if one.said.reason else ""
    return f"the lock {next(lines_of(one.said))!r}{where}"


# Contours as people name them (an id, a part, `#7` for a cut of the last plan), and the locks on them.

_NUMBER = re.compile(r"#([1-9]\d{0,8})")
_NAMED = ("contour", "part", "place", "reason")
"""Fields of a lock that decide nothing by themselves."""


@dataclass(frozen=True, slots=True)
class OnNest:
    """One decision of a lock, on the contours of a nest: locks with their ids, and what is decided of which.

    Two locks cannot both stand where they decide the same, or say the contrary: `decides` are (key, of what), `orders`
    the pairs of which the first is cut before the second.
    """

    said: Lock
    locks: tuple[Lock, ...]
    decides: frozenset[tuple[str, object]]
    orders: frozenset[tuple[str, str]] = frozenset()

    def against(self, other: OnNest) -> bool:
        """Whether it decides what another lock decides too."""
        contrary = any((then, first) in self.orders for first, then in other.orders)
        return contrary or not self.decides.isdisjoint(other.decides)


class Names:
    """Finds the contours of a nest by the names that locks have for them.

    `by_number` says which contour a number such as #7 is. `numbered` is what was found so.
    """

    def __init__(self, nest: Nest, by_number: Callable[[str], str]) -> None:
        self._nest, self._by_number = nest, by_number
        self.numbered: dict[str, str] = {}

    def on_nest(self, lock: Lock) -> Iterator[OnNest]:
        """A lock on the contours that it is about, each thing that it decides for itself.

        Raises InputError if there is no such contour, part or cut, with the nearest name, or the lock is about one
        contour and names a part of several: at the place of the lock.
        """
        try:
            for one in _single(lock):
                yield self._one(one)
        except InputError as error:
            of_plan_file = f"{error.file}: " if error.file else ""
            raise wrong_at(lock.place, f"lock {next(lines_of(lock))!r}: {of_plan_file}{error.message}") from None

    def _one(self, lock: Lock) -> OnNest:
        if lock.zone is not None:
            part = self._part(lock.part or "")
            return OnNest(lock, (replace(lock, part=part),), frozenset({("zone", part)}))
        name = lock.contour or ""
        found = self._contours(name)
        if lock.before is not None:
            return _orders(lock, found, self._after(lock, found))
        if lock.position is not None:
            return self._placed(lock, name, found)
        if lock.tab is not None:
            found = [c for c in found if c.kind == "outer"] or found
        if lock.direction is not None and len(found) > 1:
            found = [c for c in found if c.encloses]
        if lock.entry is not None:
            found = [_only(name, found, "entered there")]
        key = next(f.name for f in fields(lock) if f.name not in _NAMED and getattr(lock, f.name) is not None)
        return OnNest(lock, tuple(replace(lock, contour=c.id) for c in found), frozenset((key, c.id) for c in found))

    def _placed(self, lock: Lock, name: str, found: list[Contour]) -> OnNest:
        """A position: the first and last of all can be a whole part; then each of its contours is, among the others.

        Marks come first anyway: a part that is first comes after the marks of others, one that is last has its own
        marks before.
        """
        place = lock.place_among(len(self._nest.contours))
        decides: set[tuple[str, object]] = {("position", c.id) for c in found} | {("at", place)}
        if place not in ("first", "last"):
            _only(name, found, f"cut {place} in order")
            return OnNest(lock, (replace(lock, contour=found[0].id),), frozenset(decides))
        others = [c for c in self._nest.contours if c not in found]
        marked = self._of_part(name) and any(c.kind == "mark" for c in self._nest.contours)
        if marked and place == "first":
            others = [c for c in others if c.kind != "mark"]
        if marked and place == "last":
            found = [c for c in found if c.kind != "mark"]
        first, then = (found, others) if place == "first" else (others, found)
        placed = _orders(replace(lock, position=None), first, then)
        locks = placed.locks if len(found) > 1 or marked else (replace(lock, contour=found[0].id),)
        return OnNest(lock, locks, frozenset(decides), placed.orders)

    def _of_part(self, name: str) -> bool:
        return name in self._nest.part_of and name not in self._nest.index

    def _after(self, lock: Lock, first: list[Contour]) -> list[Contour]:
        """What comes later; of a part not the marks, which come first, unless it is a mark that they come after."""
        then = self._contours(lock.before or "")
        if not self._of_part(lock.before or "") or all(c.kind == "mark" for c in first):
            return then
        return [c for c in then if c.kind != "mark"] or then

    def _contours(self, name: str) -> list[Contour]:
        nest = self._nest
        number = _NUMBER.fullmatch(name)
        if name in nest.index:
            return [nest.contour(name)]
        if name in nest.part_of:
            return list(nest.part_of[name])
        if number is None:
            if name in nest.left_out:
                raise InputError(f"{name} is left out as a small hole (small_holes.under: skip)")
            raise InputError(unknown("contour or part", name, (*nest.part_of, *nest.index)))
        cut = self._by_number(name)
        if cut not in nest.index:
            raise InputError(f"{name} is {cut} in the last plan, which the nest does not have")
        self.numbered[name] = cut
        return [nest.contour(cut)]

    def _part(self, name: str) -> str:
        if name in self._nest.part_of:
            return name
        if name in self._nest.index or _NUMBER.fullmatch(name):
            return self._contours(name)[0].part
        raise InputError(unknown("part", name, self._nest.part_of))


def _single(lock: Lock) -> Iterator[Lock]:
    """A lock of several decisions as one for each."""
    keys = [f.name for f in fields(lock) if f.name not in _NAMED and getattr(lock, f.name) is not None]
    bare = Lock(contour=lock.contour, part=lock.part, place=lock.place, reason=lock.reason)
    return (replace(bare, **{key: getattr(lock, key)}) for key in keys)


def _orders(lock: Lock, first: list[Contour], then: list[Contour]) -> OnNest:
    pairs = [(a.id, b.id) for a in first for b in then]
    if twice := next((a for a, b in pairs if a == b), None):
        raise InputError(f"{twice} cannot be cut before itself: {lock.contour} and {lock.before} both have it")
    return OnNest(lock, tuple(replace(lock, contour=a, before=b) for a, b in pairs), frozenset(), frozenset(pairs))


def _only(name: str, found: list[Contour], what: str) -> Contour:
    if len(found) > 1:
        raise InputError(f"{name} has {_listed(found)}: say which of them is {what}")
    return found[0]


def _listed(contours: list[Contour]) -> str:
    shown = ", ".join(c.id for c in contours[:5]) + (", …" if len(contours) > 5 else "")
    return f"{len(contours)} contours ({shown})"


# The last plan of a nest, in which a planner has seen that cut 7 is P3.outer.


@dataclass(frozen=True, slots=True)
class LastPlan:
    """A plan's or program's name, its contours by number, and what it was made with beside nest and profile."""

    name: str
    cuts: Mapping[int, str]
    made_with: ForOneNest | None = None

    def contour(self, name: str, made_with: ForOneNest) -> str:
        """The contour that a number such as #7 stands for.

        A lock on #7 changes the plan, so that #7 is another cut of it. Where the plan was made with the same job file
        and the same locks as now, #7 stays what it was then. Raises InputError if there are fewer cuts.
        """
        old = self.made_with
        if old is not None and (old.sha256, old.locks) == (made_with.sha256, made_with.locks) and name in old.numbered:
            return old.numbered[name]
        number = int(name.removeprefix("#"))
        if number not in self.cuts:
            raise InputError(f"{name}: {self.name} has {len(self.cuts)} cuts only")
        return self.cuts[number]


def last_plan(source: Plan | str | Path | None, nest: Nest, nest_file: str | Path | None, profile: Profile) -> LastPlan:
    """The plan or program that is given, or else the plan beside the nest, or in the folder that kerfwise is run in.

    Raises InputError if there is none, or it cannot be read.
    """
    if isinstance(source, Plan):
        return of_plan(source, "the plan")
    if source is None:
        stem = Path(nest_file).stem if nest_file else ""
        places = [Path(nest_file or "").with_name(f"{stem}.plan.json"), Path(f"{stem}.plan.json")] if stem else []
        source = next((place for place in places if is_file(place)), None)
        if source is None:
            looked = f" ({places[0]})" if places else ""
            raise InputError(
                f"#N is cut N of the last plan, and there is none beside the nest{looked}: plan it first, or name the "
                "plan with --lock-from (in Python: resume_from)"
            )
    if is_plan_file(source):
        return of_plan(read_plan(source), str(source))
    program = upright(nest, read_on_machine(program_text(source), nest, profile, str(source)), profile)
    cuts = rebuild(nest, program, profile.material.kerf_mm, profile.home_on(nest)).cuts
    return LastPlan(str(source), {k: cut.contour for k, cut in enumerate(cuts, 1)})


def of_plan(plan: Plan, name: str) -> LastPlan:
    """The same of a plan."""
    cuts = (*plan.already_cut, *plan.cuts)
    return LastPlan(name, {k: cut.cut.contour for k, cut in enumerate(cuts, 1)}, plan.made_with)


# Answers to questions of a drawing are kept in its job file, so that nobody is asked twice.


def kept_answers(nest: str | Path, job: Job | None, request: NestRequest, read: Nest, tell: Tell) -> Job | None:
    """The job with the answers that were given, written down in its file; those that no question asked for are told.

    Where there is to be no job file, or none can be written, that is told and the answers hold for this time.
    """
    used = set(OF_CUTTING) if read.reading is None else {*read.reading.answers, *OF_CUTTING}
    of_job = () if job is None else job.answers
    layers = {row.layer for row in read.reading.taken} if read.reading is not None else set()
    for question, choice in (*of_job, *request.answers):
        kind, _, layer = question.partition(":")
        if question not in used and kind in OF_LAYERS and layers and layer not in layers:
            message = f"{unknown('layer', layer, layers)}, so that {question}={choice} answers nothing"
            if (question, choice) in request.answers:
                raise InputError(f"--answer {question}={choice}: {message}")
            tell(f"{job.file if job else ''}: answers: {message}")
        elif question not in used and (question, choice) in request.answers:
            tell(f"--answer {question}={choice} answers no question of {Path(nest).name}: it is not kept")
    new = tuple((q, c) for q, c in request.answers if q in used and dict(of_job).get(q) != c)
    if not new or request.job is False or isinstance(request.job, Job):
        return job
    path = Path(request.job) if request.job is not None else Path(nest).with_name(beside_name(nest))
    try:
        data = read_named(path, "the job file", MOST_BYTES_OF_YAML) if is_file(path) else b""
        text = utf8_text(data, "a job file", path)
        write_files({path: with_kept(text, new, str(path))})
    except (InputError, OSError) as error:
        tell(f"the answers are not kept: {error}")
        return job
    tell(f"kept in {path}: {', '.join(f'{q}={c}' for q, c in new)}")
    return read_job(path)
