"""The process that answers at once: what a nest is, what a move would do, why a contour is cut where it is."""

from __future__ import annotations

import base64
import hashlib
import math
import re
from collections import OrderedDict, defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any, TypeVar

from kerfwise.apps.edit.edited_nest import editing
from kerfwise.apps.viewer.compare import Side, SideAsked, compare, side_of
from kerfwise.apps.viewer.compare.comparison import compared_data
from kerfwise.apps.viewer.page.page_data import page_data
from kerfwise.apps.viewer.page.page_html import nest_data, page_of
from kerfwise.apps.viewer.page.page_reasons import heat_data, why_data
from kerfwise.encoder.errors import REPAIR, InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.questions import OF_CUTTING
from kerfwise.encoder.questions import Questions as OfDrawing
from kerfwise.encoder.readers.read import BrokenNest, seen
from kerfwise.jobs.explainer import Explainer, MovePreview, Mover
from kerfwise.jobs.inputs import DrawingSaid, Inputs, lines_as_cut, reading
from kerfwise.jobs.nest_job.request import NestRequest, profile_for
from kerfwise.models.plan.explain.explain import as_text
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import plan_in
from kerfwise.postproc.report import draw
from kerfwise.postproc.report.simple_pictures import reading_picture, thumbnail
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.overrides import lines_of

from .job_edits import JobText, conflicting_locks, edited, settings_of
from .plan_request import Answers, PlanRequest, Questions, already_of, enter_nest_folder, job_in, request_inputs
from .profile_answers import profile_answers

MOST_DRAWN = 3000
"""A picture of more lines than this is sent as dots: browsers draw that many lines slowly."""
_SHAPE_DIGITS = 6
"""Of mm, to which a part is the same as before."""
BENT = 80, 24
"""Frames of how a sheet moves, and points of each contour: some megabytes for 300 contours."""
BOLD = 3.0
"""How many times as thick as on paper a picture is drawn that stands beside a question."""


@dataclass(frozen=True)
class _Read:
    """A nest with its profile, and what was said while both were read."""

    given: Inputs
    notes: tuple[str, ...]


class Desk:
    """Answers questions about nests and plans; what it has worked out serves the next one."""

    def __init__(self) -> None:
        self._reads, self._plans, self._sides, self._bent = (RecentResults() for _ in range(4))

    def ready(self) -> bool:
        """All is loaded."""
        return True

    def prepared(self, wanted: PlanRequest, plan: str) -> bool:
        """Work out what moves and reasons need, before anybody asks."""
        return bool(self._mover(wanted, plan)[0].setting.route)

    def opened(self, wanted: PlanRequest) -> dict[str, Any]:
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
            "answers": {} if nest.reading is None else dict(nest.reading.answers),
            "shapes": _shapes(nest),
        }

    def picture(self, wanted: PlanRequest, plan: str) -> str:
        """The picture of a plan that is saved beside it (SVG)."""
        inputs = self._read(wanted).given
        return draw(inputs.nest, plan_in(plan), ".svg", inputs.profile.home_on(inputs.nest)).decode("utf-8")

    def preview(self, wanted: PlanRequest) -> str:
        """How a drawing is understood with the answers of the wanted job file, as the address of a picture.

        Questions that are still open get their likeliest answers; with an answer to a question of the cutting, slots
        and small holes are drawn as they would be cut.
        """
        name = enter_nest_folder(wanted)
        job = job_in(wanted)
        plant = profile_for(NestRequest(job=False if job is None else job, trust=wanted.trust), job)
        found = seen(name, reading(plant, DrawingSaid(repair=wanted.repair)))
        lines = found.lines
        if found.nest is not None and job is not None and {question for question, _ in job.answers} & set(OF_CUTTING):
            lines = tuple(lines_as_cut(found.nest, plant))
        kind = ".png" if len(lines) > MOST_DRAWN else ".svg"
        picture = reading_picture(lines, found.nest, "", kind, BOLD)
        media = {".png": "image/png", ".svg": "image/svg+xml"}[kind]
        return f"data:{media};base64,{base64.b64encode(picture).decode('ascii')}"

    def changed(self, wanted: PlanRequest, changes: Sequence[str]) -> dict[str, Any]:
        """The nest with parts dropped, moved, added and so on: its text, its parts, and what is left out.

        `drawing` is the nest as page data. What the wanted plan has cut already stays. Files of parts are those of the
        nest's folder.
        """
        if outside := next((one for one in changes if one.startswith("add ") and re.search(r"[/\\\\]", one)), None):
            raise InputError(f"{outside!r}: parts are added from files in the folder of the nest")
        inputs = self._read(wanted).given
        cut = already_of(wanted, inputs).contours
        edited = editing(inputs.nest, inputs.profile, cut=cut).do(*changes)
        parts = [part.id for part in edited.nest.parts]
        left_out = {"off": list(edited.off), "scrap": list(edited.scrap_left_out)}
        return {"text": edited.text(), "parts": parts, **left_out, "drawing": nest_data(edited.nest)}

    def room(self, wanted: PlanRequest) -> dict[str, Any]:
        """How far parts keep from each other and from the edge of the sheet, mm, and which are cut already."""
        inputs = self._read(wanted).given
        now = editing(inputs.nest, inputs.profile, cut=already_of(wanted, inputs).contours)
        return {"gap_mm": now.spacing.gap_mm, "edge_mm": now.spacing.edge_mm, "cut": sorted(now.cut)}

    def thumbnail(self, wanted: PlanRequest) -> str:
        """A small picture of a nest, as the address of an image."""
        picture = thumbnail(self._read(wanted).given.nest)
        return f"data:image/svg+xml;base64,{base64.b64encode(picture.encode()).decode('ascii')}"

    def edited(self, wanted: PlanRequest, changes: Sequence[dict[str, Any]]) -> dict[str, Any]:
        """The job file with changes made in it, and what gave way; refused whole where one of them cannot be."""
        read = self._read(wanted)
        text, undone = edited(wanted, read.given, changes)
        return {"job_text": text, "undone": undone}

    def page(self, wanted: PlanRequest) -> dict[str, Any]:
        """What the page shows of a nest that is not planned."""
        return page_data(self._read(wanted).given, None)

    def compared(self, sides: Sequence[tuple[str, PlanRequest, str]]) -> dict[str, Any]:
        """What the page shows of two plans side by side: each a name, what was wanted, and the plan."""
        return compared_data(compare(*(self._side(*side) for side in sides)))

    def heat(self, wanted: PlanRequest, plan: str) -> dict[str, Any] | None:
        """How hot a plan makes the sheet, in frames; None where its profile says nothing of heat."""
        return heat_data(self._read(wanted).given, plan_in(plan), wanted=None)

    def bent(self, wanted: PlanRequest, plan: str) -> dict[str, Any]:
        """How the sheet moves while a plan is cut, and how far its parts are off; refused where that is not known."""
        from kerfwise.apps.distortion.predict import movement_of  # scipy: only those who ask pay for it

        return self._bent.get((wanted.key, plan), lambda: movement_of(*self._planned(wanted, plan), *BENT))

    def why(self, wanted: PlanRequest, plan: str, contour: str) -> dict[str, Any]:
        """Why a contour is cut where it is, as the page shows it, and as `text`."""
        explanation = self._mover(wanted, plan)[0].explain(contour)
        return why_data(explanation) | {"text": as_text(explanation)}

    def move(
        self, wanted: PlanRequest, plan: str, contours: Sequence[str], place: int, look: bool = False
    ) -> dict[str, Any]:
        """Whether contours can be cut from another place on, what it costs, or what forbids it; nothing is planned.

        `how` is "goes"; "gives way", where rules yield to the lock, or a hard one does not hold at a place more;
        "others move", where it is forbidden with the others in their places and orders leave room for another plan; or
        "no". `locks` are what a drop there would lock, and `undone` those of before that it takes the place of.
        """
        explainer, mover = self._mover(wanted, plan)
        contours = _contours_of(self._read(wanted).given.nest, contours)
        locks = self._locks_of(explainer, contours, place)
        gone = self._against(wanted, locks)
        given_up = [lock.because for lock in gone]
        moved, _ = mover.move(contours, place, given_up, look)
        gives_way = list(moved.excused) if moved.lawful else _gives_way(explainer, moved)
        room = not moved.lawful and mover.has_room(contours, place, given_up)
        return {
            "how": "gives way" if gives_way else "goes" if moved.lawful else "others move" if room else "no",
            "contours": list(moved.contours),
            "place": moved.place,
            "lawful": moved.lawful,
            "gives_way": gives_way,
            "more_mm": moved.more_mm,
            "looked": moved.looked,
            "text": escape_text(moved.sentence),
            "breaks": [
                {"rule": a.rule, "contours": list(a.contours), "text": escape_text(a.sentence)} for a in moved.breaks
            ],
            "locked": [line for lock in locks for line in lines_of(lock)],
            "undone": [line for lock in gone for line in lines_of(lock)],
        }

    def _locks_of(self, explainer: Explainer, contours: Sequence[str], place: int) -> list[Lock]:
        """The places of contours that are moved together: they keep their order."""
        at = {planned.cut.contour: k for k, planned in enumerate(explainer.plan.cuts)}
        order = sorted(contours, key=lambda name: at.get(name, -1))
        return [Lock(contour=name, position=k) for k, name in enumerate(order, place)]

    def _against(self, wanted: PlanRequest, locks: Sequence[Lock]) -> list[Lock]:
        """The locks of the job file that give way to others."""
        inputs, text = self._read(wanted).given, JobText(wanted.job_text or "")
        gone = set(conflicting_locks(inputs.nest, text, locks))
        return [] if inputs.job is None else [lock for lock in inputs.job.locks if gone & set(lines_of(lock))]

    def _read(self, wanted: PlanRequest, again: bool = False) -> _Read:
        def read() -> _Read:
            notes: list[str] = []
            try:
                return _Read(request_inputs(wanted, notes.append), tuple(map(escape_text, notes)))
            except BrokenNest as broken:
                if wanted.repair:
                    raise
                raise Unmended(
                    broken, remaining_problems(lambda: request_inputs(replace(wanted, repair=True)))
                ) from None

        return self._reads.get(wanted.key, read, again)

    def _mover(self, wanted: PlanRequest, plan: str) -> tuple[Explainer, Mover]:
        def made() -> tuple[Explainer, Mover]:
            explainer = Explainer(*self._planned(wanted, plan), None)
            return explainer, Mover(explainer)

        return self._plans.get((wanted.key, plan), made)

    def _side(self, name: str, wanted: PlanRequest, plan: str) -> Side:
        def made() -> Side:
            inputs, made_of = self._planned(wanted, plan)
            return side_of(SideAsked(name, inputs, made_of))

        return self._sides.get((name, wanted.key, plan), made)

    def _planned(self, wanted: PlanRequest, plan: str) -> tuple[Inputs, Plan]:
        """A plan, with the nest and the profile that it is of."""
        made_of, inputs = plan_in(plan), self._read(wanted).given
        if made_of.profile.get("sha256") != inputs.profile.sha256:  # it was changed on disk since it was read
            inputs = self._read(wanted, again=True).given
        return inputs, made_of


def _shapes(nest: Nest) -> dict[str, str]:
    """What tells the sheet ("") and each part, by its name, from what it was before."""
    lines = {part.id: [contour.curve for contour in (part.outer, *part.holes, *part.marks)] for part in nest.parts}
    return {
        name: hashlib.sha256(b"".join(curve.vertices.round(_SHAPE_DIGITS).tobytes() for curve in curves)).hexdigest()[
            :12
        ]
        for name, curves in {"": [nest.sheet.outline, *nest.sheet.holes], **lines}.items()
    }


def _contours_of(nest: Nest, names: Sequence[str]) -> list[str]:
    """The contours that ids and parts stand for; InputError if there are none."""
    parts = nest.part_of
    found = [one for name in names for one in ([name] if name in nest.index else [c.id for c in parts.get(name, ())])]
    if not found:
        raise InputError(f"the nest has no {', '.join(repr(escape_text(name)) for name in names)}")
    return list(dict.fromkeys(found))


def _gives_way(explainer: Explainer, moved: MovePreview) -> list[str]:
    """The rules that give way to a lock there, where no others are broken: it can be locked all the same."""
    book = explainer.profile.rulebook()
    rules = list(dict.fromkeys(about.rule for about in moved.breaks))
    return rules if all(rule in book and book[rule].gives_way for rule in rules) else []


def _rule(inputs: Inputs, name: str) -> dict[str, Any]:
    """A rule as its slider shows it; one of the plant's own has no key that can be set."""
    profile = inputs.profile
    rule, setting = profile.rulebook()[name], profile.rules.get(name) or profile.settings()[name]
    return {
        "id": name,
        "sentence": escape_text(rule.sentence),
        "strength": setting.strength,
        "strengths": list(rule.strengths),
        "weight_mm": setting.weight,
        "default_weight_mm": rule.default_weight,
        "settable": name in profile.rules,
    }


def desk(asking: Questions) -> Answers:
    """The questions that the desk answers."""
    answers = Desk()
    own = (
        answers.ready, answers.prepared, answers.opened, answers.preview, answers.picture,
        answers.thumbnail, answers.edited, answers.changed, answers.room, answers.page, answers.compared,
        answers.heat, answers.bent, answers.why, answers.move,
    )  # fmt: skip
    return {**{answer.__name__: answer for answer in own}, **profile_answers()}


# The last few things that were worked out, for who asks again.

MOST_KEPT = 6
"""Nests, and plans of them, that are kept worked out."""

T = TypeVar("T")


@dataclass
class RecentResults:
    """What was worked out, by what it was asked for."""

    most: int = MOST_KEPT
    made: OrderedDict[Any, Any] = field(default_factory=OrderedDict)

    def get(self, key: Any, make: Callable[[], T], again: bool = False) -> T:
        """What is kept under a key, made if it is not there, or is to be made again."""
        if again or key not in self.made:
            self.made[key] = make()
            while len(self.made) > self.most:
                self.made.popitem(last=False)
        self.made.move_to_end(key)
        found: T = self.made[key]
        return found


# What is wrong with a drawing that cannot be cut, and where, so that it can be drawn; and what repair would mend.

_AT = re.compile(r"\((-?\d+(?:\.\d+)?(?:e-?\d+)?), (-?\d+(?:\.\d+)?(?:e-?\d+)?)\)")
_BEGIN, _END = r"(?<!\S)", r"(?![\w.])"
_NEAR_MM = 0.01
Spot = tuple[float, float]


class Unmended(InputError):
    """A drawing that cannot be cut, and the lines of its error that stay where it is repaired."""

    def __init__(self, broken: BrokenNest, left: Sequence[str]) -> None:
        super().__init__(broken.message, file=broken.file, details=broken.details)
        self.broken, self.left = broken, tuple(left)


def remaining_problems(repaired: Callable[[], object]) -> tuple[str, ...]:
    """What is still wrong once a drawing is repaired: what reading it so is refused for."""
    try:
        repaired()
    except OfDrawing as asked:
        return tuple(f"({x}, {y})" for question in asked.questions for x, y in _points(question.text))
    except InputError as error:
        return (error.message, *error.details)
    return ()


def problems_of(broken: BrokenNest, left: Sequence[str] | None) -> dict[str, Any]:
    """What the page draws: `said`, the nest with the wrong contours in red (`kerfwise-page/1`), and each problem.

    A problem has its sentence, the contours that it names, the point where its mark stands, or null, and whether repair
    mends it: nothing is wrong at its point then, by the lines that are `left`. A sentence about the whole drawing is
    mended where none is left. Where `left` is None it was repaired already.
    """
    stay = None if left is None else {point for text in left for point in _points(text)[-1:]}
    lines, wrong = broken.details or (broken.message,), _Wrong(broken)
    return {
        "said": escape_text(broken.message),
        "page": page_of(
            broken.nest, [], escape_text(broken.nest.file or "drawing"), broken.wrong, escape_text(broken.message)
        ),
        "lines": [
            {
                "text": escape_text(text).replace(REPAIR, "repair"),
                "contours": (named := wrong.named(text)),
                "at": _place(broken.nest, named, text),
                "mends": stay is not None and (not left or (bool(at := _points(text)[-1:]) and at[0] not in stay)),
            }
            for text in lines
        ],
    }


class _Wrong:
    """The wrong contours of a drawing, found by what a sentence says: thousands of either are told in seconds."""

    def __init__(self, broken: BrokenNest) -> None:
        self._names = {name: k for k, name in enumerate(broken.wrong)}
        self._of_words = [name for name in broken.wrong if len(name.split()) > 1]
        self._ends: dict[str, tuple[Spot, Spot]] = {}
        self._at: dict[tuple[int, int], list[str]] = defaultdict(list)
        for name in broken.wrong:
            curve = broken.nest.contour(name).curve
            if not curve.closed:
                (ax, ay), (bx, by) = curve.vertices[[0, -1], :2].tolist()
                self._ends[name] = (ax, ay), (bx, by)
                self._at[_square(ax, ay)].append(name)

    def named(self, text: str) -> list[str]:
        """The contours that a sentence names, or whose ends it tells."""
        found = {name for name in self._of_words if name in text and re.search(_BEGIN + re.escape(name) + _END, text)}
        begun = (word[:k] for word in text.split() for k in range(1, len(word) + 1) if re.match(_END, word[k:]))
        found |= {name for name in begun if name in self._names}
        points = _points(text)
        if len(points) > 1:
            found |= {
                name
                for x, y in points
                for name in self._begun_near(x, y)
                if all(any(_near(end, point) for point in points) for end in self._ends[name])
            }
        return sorted(found, key=self._names.__getitem__)

    def _begun_near(self, x: float, y: float) -> Iterator[str]:
        """Open lines whose first end is in the square of a point, or in one beside it."""
        i, j = _square(x, y)
        for square in product((i - 1, i, i + 1), (j - 1, j, j + 1)):
            yield from self._at.get(square, ())


def _square(x: float, y: float) -> tuple[int, int]:
    return math.floor(x / _NEAR_MM), math.floor(y / _NEAR_MM)


def _place(nest: Nest, named: Sequence[str], text: str) -> Spot | None:
    """The point that a sentence names last, else one of its contour; None for a sentence about the whole drawing."""
    if points := _points(text):
        return points[-1]
    if not named:
        return None
    x, y = nest.contour(named[0]).curve.point_at(0.0)
    return round(x, 3), round(y, 3)


def _points(text: str) -> list[Spot]:
    return [(float(x), float(y)) for x, y in _AT.findall(text)]


def _near(one: Spot, other: Spot) -> bool:
    return abs(one[0] - other[0]) < _NEAR_MM and abs(one[1] - other[1]) < _NEAR_MM
