"""The job: parts are laid, nests checked, and where cutting is to be cheap several are planned and weighed."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

from kerfwise.encoder.display import clock
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.jobs.inputs import Tell
from kerfwise.jobs.programs import Times, time_made
from kerfwise.jobs.progress import CtrlC, Listener, Listeners
from kerfwise.pipeline import FinishedPlan
from kerfwise.rules.profile.profile import Profile

from .nests import Nested, expect_room, nests_from
from .placement import sparrow
from .placement.demand import Common, Demand, PartType, Spacing
from .placement.layout import Layout
from .placement.nofit import Placed
from .placement.rounds import Effort, Method, layouts
from .placement.shapes import Shapes
from .placement.sparrow import compact_layout
from .programs import planned, with_sheet_price

Purpose = Literal["density", "cutting"]
PURPOSES: tuple[Purpose, ...] = get_args(Purpose)
WEIGHED, WEIGH_WORK = 4, 2.0
"""How many layouts are weighed, and the limit of each plan, where nobody says otherwise."""
FIRST = "round 1"
"""What the layout of the first round is called."""
NOTHING_LAID = "interrupted before a part was laid: nothing was written"


@dataclass(frozen=True, eq=False, slots=True)
class NestingRequest:
    """What is to be laid, how, and what for; `most` layouts are weighed, each sheet planned within `work`."""

    plant: Profile
    wanted: Demand
    spacing: Spacing
    effort: Effort
    engine: Engine = "own"
    purpose: Purpose = "density"
    most: int = WEIGHED
    work: float = WEIGH_WORK


@dataclass(frozen=True, eq=False, slots=True)
class NestingResult:
    """The nests that are to be written, what was weighed to choose them, and whether somebody ended the look."""

    nested: Nested
    weighed: tuple[Weighed, ...] = ()
    interrupted: bool = False

    @property
    def taken(self) -> Weighed | None:
        """What was weighed and taken; None where nothing was weighed."""
        return next((one for one in self.weighed if one.nested is self.nested), None)


def find_nests(
    request: NestingRequest, watching: Watching, listener: Callable[[str], Listener], tell: Tell
) -> NestingResult:
    """Lay the parts, and weigh layouts for cutting where that is asked for.

    Raises InputError if a part fits on no sheet, or the check refuses the nests; where several are weighed, all of
    them; KeyboardInterrupt if somebody ended the look before a part was laid.
    """
    order = with_held(request.wanted, request.plant), request.spacing, request.effort, request.engine, watching, tell
    with watching:
        expect_room(request.wanted, request.spacing)
        groups = list(varied_layouts(*order)) if request.purpose == "cutting" else [ranked_layouts(*order)]
    best = min((group[0] for group in groups if group), key=lambda layout: layout.score, default=None)
    if best is None or (watching.stopped and not best.sheets):
        raise KeyboardInterrupt(NOTHING_LAID)
    if not best.sheets and request.effort.time_s is not None:
        raise InputError(f"the limit of {request.effort.time_s:g} s was over before a part was laid: give more")
    if any(best.missing) and best.by == FIRST and (limit_s := request.effort.time_s) is not None:
        tell(f"the limit of {limit_s:g} s ended the first round: {sum(best.missing)} parts were not tried on any sheet")
    if request.purpose == "density" or watching.stopped:
        return NestingResult(_sound(nests_from(best)), interrupted=watching.stopped)
    weighed: list[Weighed] = []
    heard = Listeners(listener)
    for layout in comparable_layouts(groups, request.most):
        if heard.interrupted:
            break
        weighed.append(weigh(nests_from(layout), request.plant, request.work, heard))
    return NestingResult(_sound(cheapest(weighed).nested), tuple(weighed), heard.interrupted)


def _sound(nested: Nested) -> Nested:
    if nested.faults:
        raise InputError("the check refuses these nests; nothing was written", details=nested.faults)
    return nested


# Who lays the parts: kerfwise itself, Pavlov's method, and sparrow after either where that is asked for.

Engine = Literal["own", "pavlov", "sparrow"]
ENGINES: tuple[Engine, ...] = get_args(Engine)
NO_SPYRROW = "the engine sparrow needs spyrrow, which is not installed: pip install 'kerfwise[nest]'"
SECONDS_A_SHEET = 10.0
"""What sparrow has for each sheet where no limit is given."""
ALONE = "each alone"
"""How layouts are marked that have no blocks where edges could be cut once."""
_OWN_SHARE = 0.25
_OTHERS_SHARE = 0.5
"""Share of the rounds, or of the time, that those have beside the engine asked for where layouts are weighed."""


def expect_engine(engine: str) -> None:
    """Say before the work that there is no such engine, or that it is not installed."""
    if engine not in ENGINES:
        raise InputError(f"unknown engine {engine!r}: expected {', '.join(ENGINES)}")
    if engine == "sparrow" and not sparrow.installed():
        raise InputError(NO_SPYRROW)


def ranked_layouts(
    wanted: Demand, spacing: Spacing, effort: Effort, engine: Engine, watching: Watching, tell: Tell
) -> list[Layout]:
    """Layouts, the best first. The engine sparrow counts seconds, so that two runs of it may differ."""
    method: Method = "pavlov" if engine == "pavlov" else "own"
    effort = replace(effort, method=method)
    if engine != "sparrow":
        return layouts(wanted, spacing, effort, watching, lambda: watching.stopped)
    limit_s = effort.time_s
    own = effort if limit_s is None else replace(effort, time_s=_OWN_SHARE * limit_s)
    ranked = layouts(wanted, spacing, own, watching, lambda: watching.stopped)
    best = ranked[0]
    if watching.stopped:
        return ranked
    seconds = SECONDS_A_SHEET * len(best.sheets) if limit_s is None else (1 - _OWN_SHARE) * limit_s
    shapes = Shapes(wanted.types, spacing.gap_mm, spacing.common)
    layout = compact_layout(best, shapes, seconds, effort.seed, tell, lambda: watching.going("sparrow packs strips"))
    return ranked if layout is best else [replace(layout, by="sparrow"), *ranked]


def varied_layouts(
    wanted: Demand, spacing: Spacing, effort: Effort, engine: Engine, watching: Watching, tell: Tell
) -> Iterator[list[Layout]]:
    """Layouts for weighing: those of the engine asked for, and of others, each group the best first.

    The others are Pavlov's method, or kerfwise's own where Pavlov's was asked for; and, where edges are cut once, parts
    that lie alone.
    """
    less = replace(effort, rounds=max(1, round(effort.rounds * _OTHERS_SHARE)))
    if effort.time_s is not None:
        effort, less = (replace(effort, time_s=effort.time_s * share) for share in (1 - _OTHERS_SHARE, 0.25))
    yield ranked_layouts(wanted, spacing, effort, engine, watching, tell)
    if watching.stopped:
        return
    yield ranked_layouts(wanted, spacing, less, "own" if engine == "pavlov" else "pavlov", watching, tell)
    if spacing.common is not None and not watching.stopped:
        alone = ranked_layouts(wanted, replace(spacing, common=None), less, "own", watching, tell)
        yield [replace(layout, spacing=spacing, by=f"{layout.by}, {ALONE}") for layout in alone]


# How far parts lie from each other and from the sheet's edge: a kerf and the web of the profile, unless it is said.

BESIDE_MM = 0.02
"""Metal that stays between the torch's kerf and the edge of the sheet, at the least: the torch runs on the sheet."""
_ROUNDING_MM = 1e-9


def spacing_of(profile: Profile, gap_mm: float | None = None, edge_mm: float | None = None) -> Spacing:
    """The distances of a profile; each may be given in its place.

    Raises InputError if the torch would run off the sheet, or along its edge: `solve` refuses that.

    Examples
    --------
    >>> from kerfwise.rules.profile.load import load_profile
    >>> spacing_of(load_profile()), spacing_of(load_profile(), gap_mm=0.0)
    (Spacing(gap_mm=7.5, edge_mm=10.0, common=None), Spacing(gap_mm=0.0, edge_mm=10.0, common=None))

    The least distance to the edge that the message names is allowed:

    >>> spacing_of(load_profile("laser-st10kp-2mm"), edge_mm=0.12).edge_mm
    0.12
    """
    kerf_mm = profile.material.kerf_mm
    web_mm = profile.length_mm(profile.nesting.web_mm)
    edge = profile.length_mm(profile.nesting.edge_mm) if edge_mm is None else edge_mm
    least_mm = kerf_mm / 2 + BESIDE_MM
    if edge < least_mm - _ROUNDING_MM:
        raise InputError(
            f"{'nesting.edge' if edge_mm is None else '--edge'}: {edge:g} mm from parts to the edge of the sheet, and "
            f"the torch runs half a kerf, {kerf_mm / 2:g} mm, beside each part: give {least_mm:g} mm or more",
            file=(profile.file or None) if edge_mm is None else None,
        )
    return Spacing(kerf_mm + web_mm if gap_mm is None else gap_mm, edge, common_of(profile))


def spacing_warning(profile: Profile, spacing: Spacing) -> str:
    """A sentence where parts lie nearer than the cut is wide; empty where they do not.

    Examples
    --------
    >>> from kerfwise.rules.profile.load import load_profile
    >>> spacing_warning(load_profile(), Spacing(0.2, 10.0))
    'parts lie 0.2 mm apart, and the cut is 1.5 mm wide: it burns into the neighbour, which only wood bears'
    """
    kerf_mm = profile.material.kerf_mm
    if spacing.gap_mm >= kerf_mm:
        return ""
    return (
        f"parts lie {spacing.gap_mm:g} mm apart, and the cut is {kerf_mm:g} mm wide: it burns into the neighbour, "
        "which only wood bears"
    )


def common_of(profile: Profile) -> Common | None:
    """How far parts lie apart whose edges are cut once; None where the profile asks for no common cuts.

    The tolerance is the profile's, but no more than that of the torch's path: edges further off are not cut once.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from kerfwise.rules.profile.sections import Common as CommonCuts
    >>> from kerfwise.rules.profile.sections import Cuts
    >>> from kerfwise.rules.profile.load import load_profile
    >>> common_of(replace(load_profile("laser-st10kp-2mm"), cuts=Cuts(common=CommonCuts(20.0, gap_tolerance_mm=0.3))))
    Common(apart_mm=0.2, shortest_mm=20.0, tolerance_mm=0.05)
    """
    common, kerf_mm = profile.common_options(), profile.material.kerf_mm
    return None if common is None else Common(kerf_mm, common.shortest_mm, min(common.gap_mm, tolerance_mm(kerf_mm)))


def with_held(wanted: Demand, profile: Profile) -> Demand:
    """The order, with those parts marked that tabs of the profile hold, in any way that they may lie."""
    tabs = profile.tabs()
    if tabs is None:
        return wanted

    def held(kind: PartType) -> bool:
        return any(tabs.reason(Placed(0, pose, 0.0, 0.0).part(kind.part, kind.name)) for pose in kind.poses)

    return replace(wanted, types=tuple(replace(kind, held=held(kind)) for kind in wanted.types))


# Who watches while parts are laid.


class Watching(CtrlC):
    """Told after each round, and asked while sparrow packs; both say whether to go on, `stopped` that not.

    As a context it listens to Ctrl-C while parts are laid, and to SIGTERM, by which schedulers end a job.
    """

    signals = (signal.SIGINT, signal.SIGTERM)

    def __call__(self, number: int, best: Layout) -> bool:
        """After a round."""
        return not self.stopped

    def going(self, doing: str) -> bool:
        """While something else is done."""
        return not self.stopped


# Nest and cut together: layouts that use the sheets alike are planned, and the cheapest to cut is taken.

NEAR = 0.02
"""Layouts whose sheets are worth so much more, as a share, are weighed too."""


def comparable_layouts(groups: Sequence[Sequence[Layout]], most: int) -> list[Layout]:
    """The best layout, and others that lay as many parts on sheets worth about the same: of each group the best first.

    `groups`: layouts of each way to lay parts, the best of each first.
    """
    every = sorted((layout for group in groups for layout in group), key=lambda layout: layout.score)
    missing, worth, _ = every[0].score
    firsts = [group[0] for group in groups if group]
    found: dict[tuple[object, ...], Layout] = {}
    for layout in (every[0], *firsts, *every):
        if layout.score[0] <= missing and layout.score[1] <= worth * (1 + NEAR):
            found.setdefault(layout.alike, layout)
    return list(found.values())[:most]


@dataclass(frozen=True, eq=False, slots=True)
class Weighed:
    """A layout, how its sheets are cut, and what that costs; `why` says why it has no plan, where it has none.

    `price` is in the profile's currency, or in seconds where the profile has no prices. `moved` says which sheets were
    repaired, and how.
    """

    nested: Nested
    plans: tuple[FinishedPlan, ...] = ()
    price: float | None = None
    time_s: float = 0.0
    pierces: int = 0
    idle_mm: float = 0.0
    why: str = ""
    moved: tuple[str, ...] = ()


def weigh(nested: Nested, profile: Profile, work: float, listener: Callable[[str], Listener]) -> Weighed:
    """Plan every sheet of a layout, within `work` each, and add up what they cost; repair sheets that have no plan.

    A layout that the check refuses is not planned.
    """
    if nested.faults:
        return Weighed(nested, why=f"the check refuses it: {nested.faults[0]}")
    plans: list[FinishedPlan] = []
    price, time_s, pierces, idle_mm = 0.0, 0.0, 0, 0.0
    moved: list[str] = []
    for number, sheet in enumerate(nested.layout.sheets):
        try:
            nested, done, how = planned(nested, number, with_sheet_price(profile, sheet.stock), work, listener)
        except (InputError, RulesConflict) as error:
            return Weighed(nested, why=f"{nested.names[number]}: {str(error).splitlines()[0]}")
        moved += [how] if how else []
        times, totals = time_made(done.given, done.made.plan), done.made.plan.totals
        price += _price(times, profile)
        time_s += times.total_s
        pierces += totals.pierces
        idle_mm += totals.idle_mm
        plans.append(done)
    return Weighed(nested, tuple(plans), price, time_s, pierces, idle_mm, moved=tuple(moved))


def _price(times: Times, profile: Profile) -> float:
    if not profile.prices.given:
        return times.total_s
    return times.cost.total if times.cost is not None else 0.0


def cheapest(weighed: Sequence[Weighed]) -> Weighed:
    """The one that costs least; the densest that the check accepts, if there is one, where none can be planned."""
    planned = [one for one in weighed if one.price is not None]
    first = next((one for one in weighed if not one.nested.faults), weighed[0])
    return min(planned, key=lambda one: round(one.price or 0.0, 6), default=first)


def weighed_lines(found: NestingResult, profile: Profile) -> Iterator[str]:
    """What was weighed, a line each, the densest first; none where nothing was."""
    if found.taken is None:
        return
    unit = profile.prices.currency if profile.prices.given else "s"
    titles = f"{'weighed':9} {'sheets':>6} {'left m²':>8} {'time':>9} {'pierces':>7} {'idle m':>8}"
    yield f"{titles} {unit:>10} {'a part':>9}"
    for number, one in enumerate(found.weighed, 1):
        layout = one.nested.layout
        mark = " ← taken" if one is found.taken else ""
        name = "densest" if number == 1 else f"layout {number}"
        head = f"{name:9} {len(layout.sheets):6} {layout.remnant_mm2 / 1e6:8.3f}"
        moves = "".join(f"; {moved}" for moved in one.moved)
        if one.price is None:
            yield f"{head} no plan: {one.why}{mark}"
            continue
        parts = sum(len(nest.parts) for nest in one.nested.nests)
        cut = f"{clock(one.time_s):>9} {one.pierces:7} {one.idle_mm / 1000:8.2f}"
        yield f"{head} {cut} {one.price:10.2f} {one.price / parts:9.3f}{mark}  {layout.by}{moves}"
