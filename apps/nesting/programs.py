"""From nests to programs, sheet by sheet: planned, repaired where that is needed, judged."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from kerfwise.encoder.display import clock, metres
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.nest import PART_TYPE, Nest
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.encoder.validate import validated
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.programs import time_made
from kerfwise.jobs.progress import Listener, Listeners
from kerfwise.jobs.request import options_for
from kerfwise.languages import ENGLISH, texts
from kerfwise.pipeline import FinishedPlan, Watchers, plan_nest
from kerfwise.postproc.output_files import remnant_files
from kerfwise.postproc.report import draw
from kerfwise.rules.profile.profile import Profile

from .nests import Nested, nest_files, nests_from
from .placement.demand import Stock
from .placement.fill import LEFT, Taste
from .placement.layout import Sheetful, refill_sheet
from .placement.shapes import Shapes


@dataclass(frozen=True, eq=False, slots=True)
class Programs:
    """The nests as they are cut, the plan of each, a line for each and for what was repaired.

    A sheet without a plan has None, where it may be passed over.
    """

    nested: Nested
    plans: tuple[FinishedPlan | None, ...]
    told: tuple[str, ...]
    interrupted: bool

    @property
    def finished(self) -> list[tuple[int, str, FinishedPlan]]:
        """Number, from 1 on, name and plan of each sheet that has one."""
        named = enumerate(zip(self.nested.names, self.plans, strict=False), 1)
        return [(number, name, done) for number, (name, done) in named if done is not None]

    @property
    def unplanned(self) -> int:
        """How many sheets have no plan."""
        return sum(done is None for done in self.plans)

    def files(self, dxf: bool, picture: str = "svg") -> dict[str, str | bytes]:
        """Nests, programs, plans, pictures and remnants, by the names that they have; `picture` is a format."""
        files = nest_files(self.nested, f".nest.{picture}", dxf)
        for _, name, done in self.finished:
            files |= program_files(name, done, picture)
        return files


def make_programs(
    nested: Nested,
    plant: Callable[[Nested, int], Profile],
    work: float,
    relax: bool,
    listener: Callable[[str], Listener],
    skip_bad: bool = False,
) -> Programs:
    """Plan every sheet as `kerfwise solve` would; with `skip_bad` one that has no plan is passed over, and told.

    `plant` gives the profile of each sheet: of the nests, and of the number from 0 on. Raises InputError, RulesConflict
    if a sheet has no plan, not even with its parts moved apart: `RulesConflict` names the sheet.
    """
    heard = Listeners(listener)
    plans: list[FinishedPlan | None] = []
    notes: list[str] = []
    for number, name in enumerate(nested.names):
        try:
            nested, done, how = planned(nested, number, plant(nested, number), work, heard, relax)
        except (RulesConflict, InputError) as error:
            if skip_bad:
                plans.append(None)
                notes.append(f"{name}: no program: {' '.join(str(error).split())}")
                continue
            if isinstance(error, InputError):
                raise
            raise RulesConflict(f"{name}: {error.message}; nothing was written", error.reasons) from error
        plans.append(done)
        notes += [plan_text(name, done, nested.layout.sheets[number].stock), *([how] if how else [])]
    return Programs(nested, tuple(plans), tuple(notes), heard.interrupted)


# From nests to programs: every sheet planned, judged, and its files made.


def _as_read(name: str, text: str) -> Nest:
    """The nest in a text that is to be written under a name."""
    data = text.encode()
    nest = validated(read_json(data, ReadOptions()))
    return replace(nest, file=f"{name}.json", sha256=hashlib.sha256(data).hexdigest())


def plan_sheet(
    name: str, text: str, profile: Profile, work: float, *, relax: bool = False, listener: Listener
) -> FinishedPlan:
    """Plan the nest in a text, as `kerfwise solve` would plan its file.

    Raises InputError, RulesConflict as `plan_nest` does; also if the check refuses the plan.
    """
    inputs = Inputs(profile.as_cut(_as_read(name, text)), profile)
    done = plan_nest(inputs, options_for(inputs.nest, profile, work=work), watchers=Watchers(listener), relax=relax)
    if not done.made.verdict.ok:
        raise RulesConflict(f"the check refuses the plan: {', '.join(done.made.verdict.broken())}")
    return done


def program_files(name: str, done: FinishedPlan, picture: str = "svg") -> dict[str, str | bytes]:
    """Program, plan and picture of a sheet, and what of it can be used again, by the names that they have."""
    nest, profile, plan = done.given.nest, done.given.profile, done.made.plan
    files: dict[str, str | bytes] = {
        f"{name}.nc": done.made.program,
        f"{name}.plan.json": plan.to_json(),
        f"{name}.{picture}": draw(nest, plan, f".{picture}", profile.home_on(nest)),
    }
    return files | {path.name: text for path, text in remnant_files(f"{name}.nc", nest, profile).items()}


def work_sheets_of(programs: Programs, language: str = ENGLISH) -> bytes:
    """The work sheets of all programs, as one PDF."""
    from kerfwise.apps.work_sheets.sheet_parts import sheet_of
    from kerfwise.apps.work_sheets.work_sheet import sheets_pdf, work_sheet

    count = len(programs.nested.names)
    return sheets_pdf(
        [
            work_sheet(
                done.given,
                done.made.plan,
                name=f"{name}.nc",
                about={"number": sheet_of(k, count, texts(language))},
                language=language,
            )
            for k, name, done in programs.finished
        ]
    )


def labels_of(programs: Programs, language: str = ENGLISH) -> bytes:
    """A label for each part of all sheets, as one PDF."""
    from kerfwise.apps.work_sheets.sheet_parts import labels_pdf

    return labels_pdf([(done.given.nest, done.given.profile) for _, _, done in programs.finished], language)


def plan_text(name: str, done: FinishedPlan, stock: Stock) -> str:
    """What the program of a sheet takes, in a line; the sheet costs what the list says."""
    priced = replace(done.given, profile=with_sheet_price(done.given.profile, stock))
    plan, times = done.made.plan, time_made(priced, done.made.plan)
    cost = "" if times.cost is None else f", {times.cost.total:.2f} {times.cost.currency}"
    totals = plan.totals
    return (
        f"{name}.nc: {len(plan.cuts)} contours, {totals.pierces} pierces, idle {metres(totals.idle_mm)}, "
        f"{clock(times.total_s)}{cost}"
    )


# Nests whose rules cannot hold, repaired: the parts of a sheet moved apart on it, where there is room to spare.

_WIDER = (0.25, 0.75, 1.5)
"""By how much of the gap parts have more around them, in turn; of `_LEAST_MM` where the gap is less."""
_LEAST_MM = 2.0
_SMALLER = (2, 1, 0)
"""How often blocks with common edges are doubled instead, in turn."""
_TASTES = (LEFT, Taste(0.01, 1.0), Taste(blocks=True))


def plan_or_repair(
    nested: Nested, number: int, plan: Callable[[str, str], FinishedPlan], stopped: Callable[[], bool]
) -> tuple[Nested, FinishedPlan, str]:
    """Plan a sheet; where it cannot be cut, move its parts apart and plan it again.

    First the parts that the refusal names are moved, then all. The sheet stays the same, and so does what lies on it.

    Parameters
    ----------
    nested, number
        The nests, and which of them, from 0 on.
    plan
        Plans a nest: takes its name and its text.
    stopped
        Whether somebody wants no more of it.

    Returns
    -------
    The nests, the plan, and what was moved, in a clause; nothing where nothing was.

    Raises
    ------
    InputError, RulesConflict
        The first refusal, if the parts have no room to be moved, or cannot be cut for another reason.
    """
    name = nested.names[number]
    try:
        return nested, plan(name, nested.texts[number]), ""
    except (InputError, RulesConflict) as error:
        for moved, how in _moved(nested, number, str(error)):
            if stopped():
                break
            if moved.faults:
                continue
            try:
                return moved, plan(name, moved.texts[number]), f"{name} repaired: {how}"
            except (InputError, RulesConflict):
                continue
        raise


def _moved(nested: Nested, number: int, refusal: str) -> Iterator[tuple[Nested, str]]:
    """The nests with the parts of one sheet further apart, wider and wider."""
    layout, sheet = nested.layout, nested.layout.sheets[number]

    def anew(full: Sheetful) -> Nested:
        return nests_from(replace(layout, sheets=(*layout.sheets[:number], full, *layout.sheets[number + 1 :])))

    if layout.spacing.common is not None:
        for doubled in _SMALLER:
            if (placed := _laid(nested, sheet, {}, doubled)) is not None:
                yield (
                    anew(placed),
                    f"blocks of {2**doubled} parts with common edges at most" if doubled else "no blocks",
                )
    kinds = sorted({one.kind for one in sheet.placed})
    named = _named(nested, number, refusal) or set(kinds)
    spacing = layout.spacing
    for widened in [named] if named == set(kinds) else [named, set(kinds)]:
        for share in _WIDER:
            more_mm = share * max(spacing.gap_mm, _LEAST_MM)
            if (placed := _laid(nested, sheet, dict.fromkeys(widened, more_mm))) is None:
                break
            names = ", ".join(layout.wanted.types[kind].name for kind in sorted(widened))
            text = "all parts" if widened == set(kinds) else names
            yield anew(placed), f"{more_mm:.3g} mm more around {text}"


def _named(nested: Nested, number: int, refusal: str) -> set[int]:
    """The part types that a refusal is about."""
    words = set(re.findall(r"[^\s,;:()]+", refusal))
    stems = {word.rsplit(".", 1)[0] for word in words} | words
    numbers = {kind.name: k for k, kind in enumerate(nested.layout.wanted.types)}
    parts = nested.nests[number].parts
    return {numbers[str(part.attributes[PART_TYPE])] for part in parts if part.id in stems}


def _laid(nested: Nested, sheet: Sheetful, more: dict[int, float], doubled: int = 0) -> Sheetful | None:
    """The sheet with its parts laid once more, some with so much more around them; None where they have no room.

    Blocks with common edges are doubled so often at the most; 0: none are made.
    """
    layout = nested.layout
    shapes = Shapes(
        layout.wanted.types, layout.spacing.gap_mm, layout.spacing.common if doubled else None, more, doubled
    )
    tastes = [replace(taste, blocks=taste.blocks or doubled > 0) for taste in _TASTES]
    return refill_sheet(sheet, sheet.placed, shapes, layout.spacing, tastes)


def planned(
    nested: Nested,
    number: int,
    profile: Profile,
    work: float,
    listener: Callable[[str], Listener],
    relax: bool = False,
) -> tuple[Nested, FinishedPlan, str]:
    """A sheet planned as `kerfwise solve` would plan it, repaired where that is needed: see `plan_or_repair`."""
    heard = Listeners(listener)

    def plan(name: str, text: str) -> FinishedPlan:
        return plan_sheet(name, text, profile, work, relax=relax, listener=heard(name))

    return plan_or_repair(nested, number, plan, lambda: heard.stopped)


def with_sheet_price(profile: Profile, stock: Stock) -> Profile:
    """The profile with the price of this sheet, where it has prices; a remnant that has none was paid before."""
    if not profile.prices.given or (stock.price is None and not stock.remnant):
        return profile
    prices = replace(profile.prices, sheet_each=stock.price or 0.0, sheet_kg=0.0)
    return replace(profile, prices=prices)
