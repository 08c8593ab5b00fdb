"""From a list of parts to nests, and on to programs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TypedDict, Unpack

from kerfwise.api.reading import Settings, settings_of
from kerfwise.apps.nesting.find_nests import (
    PURPOSES,
    WEIGH_WORK,
    WEIGHED,
    Engine,
    NestingRequest,
    NestingResult,
    Purpose,
    Watching,
    expect_engine,
    spacing_of,
    spacing_warning,
)
from kerfwise.apps.nesting.nest_list import (
    Done,
    GroupRequest,
    ListRequest,
    Nests,
    nest_groups,
    nests_of_job,
    plant_of_sheet,
    request_list,
)
from kerfwise.apps.nesting.placement.demand import Demand
from kerfwise.apps.nesting.placement.layout import Layout
from kerfwise.apps.nesting.placement.rounds import Effort
from kerfwise.apps.nesting.programs import make_programs
from kerfwise.apps.nesting.request import order_of
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nearest_name import unknown
from kerfwise.jobs.inputs import DrawingSaid, ProfileLike, Tell, plant_of, reading
from kerfwise.jobs.nest_job.job import day_of
from kerfwise.jobs.nest_job.request import answered
from kerfwise.jobs.progress import Listener
from kerfwise.models.engines.tuning import REQUEST_WORK as WORK
from kerfwise.rules.profile.load import DEFAULT
from kerfwise.rules.profile.overrides import with_settings
from kerfwise.rules.profile.profile import Profile

Files = Mapping[str | Path, int] | Iterable[str | Path] | str | Path
"""Files with how many of each, or words as on the command line, such as bracket.dxf=12, or the path of a list."""
OnRound = Callable[[int, int], object]
"""Called after each round with its number and how many sheets the best layout has; False ends the look."""


class NestOptions(TypedDict, total=False):
    """What `nest` and `make` take by keyword besides, each with a default in `_USUAL`."""

    sheets: Files
    remnants: Files
    gap_mm: float | None
    edge_mm: float | None
    engine: Engine
    purpose: Purpose
    weigh: int
    weigh_work: float
    rounds: int
    time_s: float | None
    seed: int
    units: str | None
    repair: bool
    skip_bad: bool
    name_pattern: str | None
    answers: Mapping[str, str] | None
    settings: Settings
    date: str


def nest(
    parts: Files,
    profile: ProfileLike | Sequence[ProfileLike] = DEFAULT,
    *,
    on_round: OnRound | None = None,
    **options: Unpack[NestOptions],
) -> Nests:
    """Lay parts on sheets, remnants first, as `kerfwise nest` does. Nothing is written: see `Nests.save`.

    Parameters
    ----------
    parts
        Files of parts with quantities, such as {"bracket.dxf": 12}; words such as "bracket.dxf=12"; lists of parts.
    profile
        A profile, its name or its path; several for a list of several materials, each cut by the one that is for it.
    sheets, remnants
        Sizes such as "3000x1500", or files, each with how many there are: {"3000x1500": 4}, or "3000x1500=4".
    gap_mm, edge_mm
        Distances, mm, instead of those of the profile.
    engine
        "own" (the default), "pavlov" or "sparrow".
    purpose
        "density" (the default), or "cutting": plan several layouts that use the sheets alike, take the cheapest to cut.
    weigh, weigh_work
        How many of them (4), and the limit of each plan (2).
    rounds, time_s, seed
        Orders that are tried (12); a limit by the clock in their place; the seed of random orders (1).
    units, repair
        As for `read_nest`.
    skip_bad
        Leave out parts that cannot be read or cut: `left_out` of the result names them.
    name_pattern
        What the names of files say, such as "{part}_{quantity}x".
    answers
        Answers to questions of drawings, and of which row of a chart is for a material: {"row:S235-8mm": "10mm"}.
    settings
        Values of the profiles for this list only: {"leads.lead_in": "4 mm"}, or lines such as "leads.lead_in=4 mm".
    date
        Day that every program says at its top, and the job file of every sheet, as "2026-12-24".
    on_round
        Called after each round; if it answers False, the best nests so far are taken.

    Returns
    -------
    Nests
        `nests`, `missing`, `use`, `prices`; print it to read it.

    Raises
    ------
    InputError
        If something given cannot be used, a part fits on no sheet, or the check refuses the nests.
    KeyboardInterrupt
        If Ctrl-C was pressed before a part was laid.

    Examples
    --------
    >>> import kerfwise
    >>> folder = "examples/parts/"
    >>> laid = kerfwise.nest({folder + "flange.json": 3, folder + "tag.json": 5}, sheets="1000x600", rounds=1)
    >>> len(laid.nests), len(laid.nests[0].parts), laid.missing
    (1, 8, {})
    """
    notes: list[str] = []
    request, found = _nested(parts, profile, on_round, notes, options)
    return nests_of_job(request, [Done(one, result) for one, result in found], notes)


def make(
    parts: Files,
    profile: ProfileLike | Sequence[ProfileLike] = DEFAULT,
    *,
    work: float = WORK,
    relax: bool = False,
    on_round: OnRound | None = None,
    **options: Unpack[NestOptions],
) -> Nests:
    """Lay parts on sheets, and turn every sheet into a checked program, as `kerfwise make` does.

    Parameters
    ----------
    parts, profile, sheets, remnants, gap_mm, edge_mm, engine, purpose, weigh, weigh_work, rounds, seed
    units, repair, skip_bad, name_pattern, answers, settings, date
        As for `nest`.
    time_s, on_round
        As for `nest`: of laying parts, not of planning.
    work, relax
        As for `solve`, for each sheet.

    Returns
    -------
    Nests
        With `programs`; `save` writes programs, plans and remnants, too.

    Raises
    ------
    InputError, RulesConflict
        As `nest` and `solve` do: if one sheet has no plan, not even with its parts moved apart.

    Examples
    --------
    >>> import kerfwise
    >>> made = kerfwise.make("examples/parts/flange.json=2", sheets="600x400", rounds=1, work=0.5)
    >>> made.programs[0].split(",")[0]
    'sheet1.nc: 12 contours'
    """
    notes: list[str] = []
    request, found = _nested(parts, profile, on_round, notes, options)
    skip_bad = options.get("skip_bad", False)
    done = []
    for one, result in found:
        plant = partial(plant_of_sheet, request, one, None)
        made = make_programs(result.nested, plant, work, relax, lambda name: Listener(), skip_bad)
        done.append(Done(one, result, made))
    return nests_of_job(request, done, notes)


def _nested(
    parts: Files,
    profile: ProfileLike | Sequence[ProfileLike],
    on_round: OnRound | None,
    notes: list[str],
    options: NestOptions,
) -> tuple[ListRequest, list[tuple[GroupRequest, NestingResult]]]:
    request = list_request(parts, profile, notes.append, **options)
    return request, nest_groups(request, lambda: _Watch(on_round), lambda name: Listener(), notes.append)


_USUAL: NestOptions = {
    "sheets": (), "remnants": (), "gap_mm": None, "edge_mm": None, "engine": "own", "purpose": "density",
    "weigh": WEIGHED, "weigh_work": WEIGH_WORK, "rounds": 12, "time_s": None, "seed": 1, "units": None,
    "repair": False, "skip_bad": False, "name_pattern": None, "answers": None, "settings": (), "date": "",
}  # fmt: skip


def list_request(
    parts: Files,
    profiles: ProfileLike | Sequence[ProfileLike],
    tell: Tell,
    trust: bool = False,
    **options: Unpack[NestOptions],
) -> ListRequest:
    """Read parts, sheets and remnants, and find for each group of parts how it is cut; `tell` hears the readers."""
    given: NestOptions = {**_USUAL, **options}
    if given["purpose"] not in PURPOSES:
        raise InputError(unknown("purpose", str(given["purpose"]), PURPOSES))
    for name, count in (("rounds", given["rounds"]), ("weigh", given["weigh"])):
        if not isinstance(count, int) or count < 1:
            raise InputError(f"{name}: expected a whole number from 1, got {count!r}")
    for name, limit in (("time_s", given["time_s"]), ("weigh_work", given["weigh_work"])):
        if limit is not None and not limit > 0:
            raise InputError(f"{name}: expected a number over 0, got {limit!r}")
    gap_mm, edge_mm, skip_bad = given["gap_mm"], given["edge_mm"], given["skip_bad"]
    for name, mm in (("gap_mm", gap_mm), ("edge_mm", edge_mm)):
        if mm is not None and not mm >= 0:
            raise InputError(f"{name}: expected 0 or more, got {mm!r}")
    named = [profiles] if isinstance(profiles, str | Path | Profile) else list(profiles)
    laid, said = settings_of(given["settings"]), tuple((given["answers"] or {}).items())
    plants = [with_settings(answered(plant_of(one, trust), None, said), laid) for one in named]
    expect_engine(given["engine"])
    for plant in plants:
        spacing_of(plant, gap_mm, edge_mm)
    reads = reading(plants[0], DrawingSaid(given["units"], repair=given["repair"]))
    words = _words(parts), _words(given["sheets"]), _words(given["remnants"])
    order = order_of(*words, reads, tell, skip_bad=skip_bad, name_pattern=given["name_pattern"])
    effort = Effort(given["rounds"], given["time_s"], given["seed"])
    how = given["engine"], given["purpose"], given["weigh"], given["weigh_work"]

    def nesting(plant: Profile, wanted: Demand) -> NestingRequest:
        spacing = spacing_of(plant, gap_mm, edge_mm)
        for note in (spacing_warning(plant, spacing), *plant.chart_notes()):
            if note:
                tell(note)
        return NestingRequest(plant, wanted, spacing, effort, *how)

    day = day_of(given["date"])
    return request_list(order, plants, nesting, skip_bad=skip_bad, answers=said, date=day, settings=laid)


def _words(files: Files) -> list[str]:
    if isinstance(files, str | Path):
        return [str(files)]
    if isinstance(files, Mapping):
        return [f"{file}={count}" for file, count in files.items()]
    return [str(file) for file in files]


class _Watch(Watching):
    """Tells a function of each round."""

    def __init__(self, on_round: OnRound | None) -> None:
        super().__init__()
        self._on_round = on_round

    def __call__(self, number: int, best: Layout) -> bool:
        if self._on_round is not None and self._on_round(number, len(best.sheets)) is False:
            self.stopped = True
        return super().__call__(number, best)
