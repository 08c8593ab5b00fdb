"""Nest and cut together: layouts that use the sheets alike are planned, and the cheapest to cut is taken."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.jobs.batch.figures import clock
from kerfwise.jobs.listening import Listener
from kerfwise.jobs.main_job import Finished
from kerfwise.jobs.times import Times, time_made
from kerfwise.nesting.allot import Layout
from kerfwise.nesting.wanted import Stock
from kerfwise.rules.profile.profile import Profile

from .repair import planned
from .run import Nested

NEAR = 0.02
"""Layouts whose sheets are worth so much more, as a share, are weighed too."""


def alike(groups: Sequence[Sequence[Layout]], most: int) -> list[Layout]:
    """The best layout, and others that lay as many parts on sheets worth about the same: of each group the best first.

    Parameters
    ----------
    groups
        Layouts of each way to lay parts, the best of each first.
    most
        How many at most.
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
    plans: tuple[Finished, ...] = ()
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
    plans: list[Finished] = []
    price, time_s, pierces, idle_mm = 0.0, 0.0, 0, 0.0
    moved: list[str] = []
    for number, sheet in enumerate(nested.layout.sheets):
        try:
            nested, done, how = planned(nested, number, priced(profile, sheet.stock), work, listener)
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


def priced(profile: Profile, stock: Stock) -> Profile:
    """The profile with the price of this sheet, where it has prices; a remnant that has none was paid before."""
    if not profile.prices.given or (stock.price is None and not stock.remnant):
        return profile
    prices = replace(profile.prices, sheet_each=stock.price or 0.0, sheet_kg=0.0)
    return replace(profile, prices=prices)


def cheapest(weighed: Sequence[Weighed]) -> Weighed:
    """The one that costs least; the densest that the check accepts, if there is one, where none can be planned."""
    planned = [one for one in weighed if one.price is not None]
    first = next((one for one in weighed if not one.nested.faults), weighed[0])
    return min(planned, key=lambda one: round(one.price or 0.0, 6), default=first)


def weighed_text(weighed: Sequence[Weighed], taken: Weighed, profile: Profile) -> str:
    """What was weighed, a line each, the densest first."""
    return "\n".join(_lines(weighed, taken, profile))


def _lines(weighed: Sequence[Weighed], taken: Weighed, profile: Profile) -> Iterator[str]:
    unit = profile.prices.currency if profile.prices.given else "s"
    titles = f"{'weighed':9} {'sheets':>6} {'left m²':>8} {'time':>9} {'pierces':>7} {'idle m':>8}"
    yield f"{titles} {unit:>10} {'a part':>9}"
    for number, one in enumerate(weighed, 1):
        layout = one.nested.layout
        mark = " ← taken" if one is taken else ""
        name = "densest" if number == 1 else f"layout {number}"
        head = f"{name:9} {len(layout.sheets):6} {layout.remnant_mm2 / 1e6:8.3f}"
        said = "".join(f"; {moved}" for moved in one.moved)
        if one.price is None:
            yield f"{head} no plan: {one.why}{mark}"
            continue
        parts = sum(len(nest.parts) for nest in one.nested.nests)
        cut = f"{clock(one.time_s):>9} {one.pierces:7} {one.idle_mm / 1000:8.2f}"
        yield f"{head} {cut} {one.price:10.2f} {one.price / parts:9.3f}{mark}  {layout.by}{said}"
