"""A whole list: its groups laid one after the other with what is left of the stock, and what nesting gives back."""

from __future__ import annotations

import hashlib
import json
import os
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text, json_lines
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.questions import Answers
from kerfwise.jobs.display import Picture
from kerfwise.jobs.inputs import Tell
from kerfwise.jobs.nest_job.job import ENDING, job_of
from kerfwise.jobs.nest_job.request import with_values
from kerfwise.jobs.progress import Listener
from kerfwise.postproc.output_files import make_folder, write_files
from kerfwise.postproc.report import draw
from kerfwise.rules.profile.load import shipped_profiles
from kerfwise.rules.profile.overrides import Setting
from kerfwise.rules.profile.profile import Profile

from .by_material import SHIPPED, Cutting, Group, cuttings_of, groups_of, left_of, uncuttable, without
from .find_nests import NestingRequest, NestingResult, Watching, find_nests, weighed_lines
from .nests import (
    FORMAT,
    TABLE,
    Nested,
    expect_folder,
    lines_of,
    nest_files,
    part_uses,
    remove_earlier,
    write_nests,
    written_before,
)
from .part_list import BadRow
from .placement.demand import Demand
from .placement.layout import share_used
from .programs import Programs
from .request import Order


@dataclass(frozen=True, eq=False, slots=True)
class GroupRequest:
    """One group, how it is cut, and what is to be laid."""

    group: Group
    cutting: Cutting
    asked: NestingRequest


@dataclass(frozen=True, eq=False, slots=True)
class ListRequest:
    """All groups of a list, and what of it cannot be nested: parts that nobody can read or cut, with the reason.

    `date` is the day that every program says at its top, "" for none; `settings` are those of the command line.
    """

    groups: tuple[GroupRequest, ...]
    bad: tuple[BadRow, ...]
    date: str = ""
    settings: tuple[Setting, ...] = ()

    def folder(self, one: GroupRequest) -> str:
        """The folder of a group in that of the list; "" where there is one group only."""
        return one.group.name if len(self.groups) > 1 else ""

    def head(self, one: GroupRequest) -> str:
        """A line that says which group the next lines are about; "" where there is one only."""
        folder = self.folder(one)
        return escape_text(f"{folder}: {one.group.said}, profile {one.cutting.plant.name}") if folder else ""


def request_list(
    order: Order,
    plants: Sequence[Profile],
    request: Callable[[Profile, Demand], NestingRequest],
    *,
    skip_bad: bool = False,
    answers: Answers = (),
    date: str = "",
    settings: tuple[Setting, ...] = (),
) -> ListRequest:
    """The groups of an order, each with its profile; what cannot be cut is found here, before anything is laid.

    `order`: parts and stock. `plants`: the profiles that there are, the first for parts of which nothing is said.
    `request`: what is to be laid of a group under its profile. `skip_bad`: whether parts that cannot be cut are left
    out. `answers`: to questions about material. `date`: the day that every program says at its top, as 2026-12-24; ""
    for none. `settings`: what the profiles have been set to besides: the job files say it, too. Raises ListQuestions if
    no profile or row is for some material; InputError if parts cannot be cut, or there is no sheet for some, and they
    may not be left out: all of them, with reasons.
    """
    bad: list[BadRow] = list(order.bad)
    cuttings, left_out = cuttings_of(plants, groups_of(order.wanted), answers)
    bad += left_out
    wrong: list[BadRow] = []
    found: list[GroupRequest] = []
    for group, cutting in cuttings:
        if not group.wanted.stocks:
            wrong += (BadRow(kind.name, None, f"there is no sheet of {group.said}") for kind in group.wanted.types)
            continue
        one_request = request(cutting.plant, group.wanted)
        cannot = uncuttable(group.wanted, cutting.plant, one_request.spacing)
        wrong += (BadRow(group.wanted.types[kind].name, None, why) for kind, why in sorted(cannot.items()))
        if len(cannot) < len(group.wanted.types):
            wanted = without(group.wanted, cannot)
            found.append(GroupRequest(replace(group, wanted=wanted), cutting, replace(one_request, wanted=wanted)))
    if wrong and not skip_bad:
        head = f"{len(wrong)} of {len(order.wanted.types)} parts cannot be nested or cut (--skip-bad leaves them out)"
        raise InputError(head, details=tuple(map(str, wrong)))
    bad += wrong
    if not found:
        raise InputError("no part can be nested", details=tuple(map(str, bad)))
    return ListRequest(tuple(found), tuple(bad), date, settings)


def nest_groups(
    request: ListRequest, watching: Callable[[], Watching], listener: Callable[[str], Listener], tell: Tell
) -> list[tuple[GroupRequest, NestingResult]]:
    """Lay group after group; sheets that serve several are there once. Ctrl-C keeps what is laid so far."""
    used: Counter[int] = Counter()
    found: list[tuple[GroupRequest, NestingResult]] = []
    for one in request.groups:
        wanted = left_of(one.asked.wanted, used)
        if not wanted.stocks:
            raise InputError(f"no sheet is left for {one.group.said}: other parts of the list take them all")
        try:
            result = find_nests(replace(one.asked, wanted=wanted), watching(), listener, tell)
        except KeyboardInterrupt:
            if not found:
                raise
            break
        found.append((one, result))
        used.update(id(sheet.stock.sheet) for sheet in result.nested.layout.sheets)
        if result.interrupted:
            break
    return found


# What is written: a folder a group, job files that name the profile, and a table of the whole list.


def job_text(request: ListRequest, one: GroupRequest, folder: Path | None, nested: Nested, number: int) -> str:
    """The job file of a sheet: its profile, what is set in that for the group, the orders, the first day, the date.

    Without a folder, where nothing is written yet, it names no profile.
    """
    cutting = one.cutting
    orders = dict.fromkeys(str(o) for part in nested.nests[number].parts if (o := part.attributes.get("order")))
    days = [str(day) for part in nested.nests[number].parts if (day := part.attributes.get("due"))]
    lines = []
    if folder is not None:
        lines += [f"profile: {json.dumps(_profile_name(cutting.base, folder), ensure_ascii=False)}"]
    lines += [f"order: {json.dumps(', '.join(orders), ensure_ascii=False)}"] if orders else []
    lines += [f"due: {min(days)}"] if days else []
    lines += [f"date: {request.date}"] if request.date else []
    settings = {one.key: _set_in(one, folder) for one in request.settings}
    settings |= {key: value for key, _, value in (one.partition("=") for one in cutting.settings)}
    lines += ["set:", *(f"  {key}: {value}" for key, value in settings.items())] if settings else []
    return "\n".join(lines) + "\n"


def plant_of_sheet(request: ListRequest, one: GroupRequest, out: Path | None, nested: Nested, number: int) -> Profile:
    """The profile of a sheet, from 0 on, with its job file as it will be written in `out` laid over it.

    Where nobody knows yet which folder that is, programs have what the job file says, and not its name.
    """
    if not _has_job(request, one):
        return one.cutting.plant
    folder = None if out is None else out / request.folder(one)
    text = job_text(request, one, folder, nested, number)
    file = (Path() if folder is None else folder) / f"{nested.names[number]}{ENDING}"
    job = replace(job_of(text, str(file)), sha256=hashlib.sha256(text.encode()).hexdigest())
    return with_values(one.cutting.base, job if folder else replace(job, file="", sha256=""), (), ())


def _has_job(request: ListRequest, one: GroupRequest) -> bool:
    """Whether a job file says more than the profile."""
    return bool(one.group.said or request.date or request.settings)


def _set_in(setting: Setting, folder: Path | None) -> str:
    """A setting as a job file in that folder says it: files are named as seen from there."""
    is_file = setting.key in ("material.chart", "machine.dialect") and Path(setting.text).is_file()
    return json.dumps(_from(folder, setting.text), ensure_ascii=False) if is_file and folder else setting.text


def _profile_name(plant: Profile, folder: Path) -> str:
    """A profile as a job file in that folder names it."""
    shipped = Path(plant.file).stem
    if plant.file.startswith(SHIPPED) and shipped in shipped_profiles():
        return shipped
    if not plant.file:
        return plant.name
    return _from(folder, plant.file)


def _from(folder: Path, file: str) -> str:
    """A file's path as seen from a folder."""
    with suppress(ValueError):  # no way from one drive to another
        return Path(os.path.relpath(file, folder)).as_posix()
    return Path(file).resolve().as_posix()


def write_list(
    out: Path,
    request: ListRequest,
    found: Sequence[tuple[GroupRequest, Nested, Mapping[str, str | bytes]]],
) -> list[Path]:
    """Write the files of every group, and of a list of several groups the table of all.

    Files of an earlier run that are not made again are removed, folders of groups with them.
    """
    left_out = [{"part": one.name, "at": str(one.place or ""), "why": one.why} for one in request.bad]
    seed = request.groups[0].asked.effort.seed
    make_folder(out)
    written: list[Path] = []
    for one, nested, files in found:
        folder = out / request.folder(one)
        if _has_job(request, one):
            jobs = {f"{name}{ENDING}": job_text(request, one, folder, nested, k) for k, name in enumerate(nested.names)}
            files = {**files, **jobs}
        more = {"left_out": left_out} if left_out and not request.folder(one) else {}
        written += write_nests(folder, nested, files, profile=one.cutting.plant.name, seed=seed, **more)
    if len(request.groups) > 1:
        folders = [request.folder(one) for one, _, _ in found]
        parts = [
            {"folder": request.folder(one), **asdict(row)} for one, nested, _ in found for row in part_uses(nested)
        ]
        data = {"format": FORMAT, "seed": seed, "groups": folders, "parts": parts, "left_out": left_out}
        remove_earlier(out, written_before(out), {TABLE}, folders)
        write_files({out / TABLE: json_lines(data)})
        written.append(out / TABLE)
    return written


def left_out_text(bad: Sequence[BadRow]) -> str:
    """What of a list is not nested, a line each."""
    return "\n".join(f"left out: {escape_text(str(one))}" for one in bad)


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Nests:
    """Parts laid on sheets. `print(nests)` says what `kerfwise nest`, or `kerfwise make`, prints.

    Attributes
    ----------
    nests
        A nest a sheet, as they can be given to `solve`: of a list of several materials those of one after the other.
    profile
        The profile that distances and prices are of; of a list of several materials that of the first.
    programs
        What `make` has planned, a line a sheet; empty for `nest`.
    notes
        What the readers had to say, and which sheets were repaired.
    left_out
        Parts that cannot be read or cut, by name: why. Empty unless `skip_bad`.
    interrupted
        Whether Ctrl-C, or the progress callback, ended the look: the nests are the best so far.
    """

    nests: tuple[Nest, ...]
    profile: Profile
    programs: tuple[str, ...]
    notes: tuple[str, ...]
    left_out: dict[str, str]
    interrupted: bool
    _asked: ListRequest
    _found: tuple[Done, ...]

    @property
    def missing(self) -> dict[str, int]:
        """Parts that are on no sheet, by name: how many."""
        layouts = [one.nested.layout for one in self._found]
        return {
            kind.name: lost
            for layout in layouts
            for kind, lost in zip(layout.wanted.types, layout.missing, strict=True)
            if lost
        }

    @property
    def use(self) -> float:
        """Metal of all parts laid, of that of all sheets taken."""
        return share_used([one.nested.layout for one in self._found])

    @property
    def prices(self) -> tuple[float | None, ...]:
        """What each layout that was weighed costs to cut, the densest first; None for one that has no plan."""
        return tuple(one.price for done in self._found for one in done.result.weighed)

    @property
    def folders(self) -> tuple[str, ...]:
        """The folder that `save` writes each nest to: "" but for a list of several materials."""
        return tuple(self._asked.folder(done.group) for done in self._found for _ in done.nested.nests)

    def picture(self, sheet: int = 1) -> Picture:
        """A nest as SVG; sheets count from 1."""
        return Picture(draw(self.nests[sheet - 1], None, ".svg"), "svg")

    def save(self, folder: str | Path, dxf: bool = False) -> list[Path]:
        """Write nests, pictures and the table, and of `make` programs and plans, as the command line does.

        Raises InputError if the folder holds files of others.
        """
        out = Path(folder)
        expect_folder(out)
        files = [(done.group, done.nested, done.files(dxf)) for done in self._found]
        return write_list(out, self._asked, files)

    def __str__(self) -> str:
        lines = []
        for done in self._found:
            if head := self._asked.head(done.group):
                lines.append(head)
            lines += lines_of(done.nested)
            lines += weighed_lines(done.result, done.group.cutting.plant)
            lines += () if done.made is None else done.made.told
        return "\n".join([*lines, *([left_out_text(self._asked.bad)] if self._asked.bad else [])])

    __repr__ = __str__


@dataclass(frozen=True, eq=False, slots=True)
class Done:
    """A group, its nests, and what `make` made of them."""

    group: GroupRequest
    result: NestingResult
    made: Programs | None = None

    @property
    def nested(self) -> Nested:
        """The nests as they are written: those of the programs, which may be repaired."""
        return self.result.nested if self.made is None else self.made.nested

    def files(self, dxf: bool) -> dict[str, str | bytes]:
        """Nests and pictures, and what `make` made, by the names that they have."""
        return nest_files(self.nested, ".svg", dxf) if self.made is None else self.made.files(dxf)


def nests_of_job(request: ListRequest, done: Sequence[Done], notes: list[str]) -> Nests:
    """What the job has found, and made of it."""
    interrupted = len(done) < len(request.groups) or any(
        one.result.interrupted or (one.made is not None and one.made.interrupted) for one in done
    )
    nests = tuple(nest for one in done for nest in one.nested.nests)
    programs = tuple(text for one in done if one.made is not None for text in one.made.told)
    left_out = {one.name or str(one.place): one.why for one in request.bad}
    plant = request.groups[0].cutting.plant
    return Nests(nests, plant, programs, tuple(notes), left_out, interrupted, request, tuple(done))
