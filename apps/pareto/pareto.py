"""The trade-off of idle travel and overheats: the best plan at each of several prices of an overheat, simulated."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.already_cut import NOTHING_CUT, AlreadyCut
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.jobs.display import Picture, data_frame
from kerfwise.jobs.heat_control import cooler_orders
from kerfwise.jobs.inputs import Inputs, expect_one_torch
from kerfwise.jobs.plan_nest import VerifiedPlan, solve_and_verify
from kerfwise.jobs.progress import Listener
from kerfwise.jobs.request import facts_of, make_request
from kerfwise.jobs.resume import lock_broken_cut_first
from kerfwise.jobs.simulation import path_of_plan
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.physics.heat import simulate
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.profile import Profile

if TYPE_CHECKING:
    import pandas


class TradeOff:
    """Plans of one nest at prices of an overheat.

    Parameters
    ----------
    facts
        Of the nest.
    profile
        Its own price of an overheat is not looked at.
    limits
        Of each plan.
    relax
        Where hard rules clash, the cheapest statements give way, marked in each plan.

    Raises
    ------
    RulesConflict
        If hard orders contradict each other.
    """

    def __init__(self, facts: Facts, profile: Profile, limits: SolveOptions, relax: bool = False) -> None:
        self._facts, self._limits = facts, limits
        self._profile = replace(profile, objective=replace(profile.objective, heat=0.0))
        self._asked = make_request(facts, self._profile, relax, limits=limits)
        self._cooler = cooler_orders(facts, self._profile, self._asked.stated)

    def fit(self) -> None:
        """Find out which orders overheat metal: the nest is simulated many times over, once for all prices."""
        if self._profile.heat.absorbed_power_w:
            self._cooler.start()

    def at(self, price_mm: float, progress: Progress | None = None) -> Trade:
        """The plan at a price, simulated; what was simulated for other prices helps.

        Raises
        ------
        RulesConflict
            If no lawful plan exists, or none was found.
        """
        facts = self._facts
        profile = replace(self._profile, objective=replace(self._profile.objective, heat=price_mm))
        verified = solve_and_verify(self._asked, profile, self._limits, progress, cooler=self._cooler)
        path = path_of_plan(verified.plan, facts.nest, profile)
        found = simulate(facts.nest, path, profile.heat, profile.material.thickness_mm)
        return Trade(price_mm, verified, found.overheats, found.peak_c)


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Offer:
    """Plans of one nest at several prices of an overheat, each simulated.

    Attributes
    ----------
    trades
        The plans, by price.
    limit_c
        Above this metal is too hot, °C.
    name
        That of the nest.
    interrupted
        Whether Ctrl-C ended the look: the plans found so far are here.
    refused
        Why a price left no plan, where one did; None otherwise.
    off_mm
        How far the parts of each plan will be off, mean of their worst places, mm, where that was simulated.
    """

    trades: tuple[Trade, ...]
    limit_c: float
    name: str = ""
    interrupted: bool = False
    refused: RulesConflict | None = None
    off_mm: tuple[float, ...] = ()

    @property
    def front(self) -> tuple[Trade, ...]:
        """Those that no other beats in idle travel and in overheats, by idle travel."""
        return tuple(front(self.trades))

    def rows(self) -> list[dict[str, Any]]:
        """A row for each plan, as `kerfwise pareto --json` prints them."""
        best = self.front
        return [
            {
                "price_mm": trade.price_mm,
                "overheats": trade.overheats,
                "peak_c": round(trade.peak_c, 1),
                "idle_mm": round(trade.idle_mm, 1),
                "time_s": round(trade.plan.totals.time_s, 1),
                "lawful": trade.lawful,
                "front": trade in best,
            }
            | ({"off_mm": round(self.off_mm[k], 4)} if self.off_mm else {})
            for k, trade in enumerate(self.trades)
        ]

    def files(self) -> Mapping[str, str]:
        """Name → content of the plan and the program of each price that the check takes."""
        return {
            f"price-{trade.price_mm:.12g}.{suffix}": content
            for trade in self.trades
            if trade.lawful
            for suffix, content in (("plan.json", trade.plan.to_json()), ("nc", trade.made.program))
        }

    def picture(self) -> Picture:
        """A PNG of every plan as a point; those on the front are joined by steps."""
        return Picture(front_png(self.trades, self.limit_c, self.name), "png")

    def to_frame(self) -> pandas.DataFrame:
        """`rows` as a table.

        Raises
        ------
        InputError
            If pandas is not installed.
        """
        return data_frame(self.rows())

    def save(self, folder: str | Path) -> tuple[Path, ...]:
        """Write the plan and the program of each price to a folder, all or none; the check must take them.

        Raises
        ------
        InputError
            If they cannot be written.
        """
        from kerfwise.postproc.output_files import make_folder, write_files

        make_folder(Path(folder))
        files: dict[Path, str | bytes] = {Path(folder) / name: content for name, content in self.files().items()}
        write_files(files)
        return tuple(files)

    def __repr__(self) -> str:
        return f"<Offer: {len(self.trades)} plans, {len(self.front)} on the front>"

    def __str__(self) -> str:
        over = f"over {self.limit_c:g} °C"
        lines = [f"{'price, mm':>10} {over:>14} {'peak, °C':>9} {'idle, m':>9} {'time, s':>9}"]
        if self.off_mm:
            lines[0] += f" {'off, mm':>9}"
        for row in self.rows():
            mark = "" if row["front"] else "   no better than another"
            mark = mark if row["lawful"] else "   the check refuses it: not written"
            lines.append(
                f"{row['price_mm']:10g} {row['overheats']:14d} {row['peak_c']:9.1f} {row['idle_mm'] / 1000:9.3f} "
                f"{row['time_s']:9.1f}" + (f" {row['off_mm']:9.3f}" if self.off_mm else "") + mark
            )
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return self.picture().html()


def trade_off(
    inputs: Inputs,
    prices_mm: Sequence[float],
    limits: SolveOptions,
    new_listener: Callable[[], Listener] = Listener,
    name: str = "",
    *,
    already: AlreadyCut = NOTHING_CUT,
    relax: bool = False,
) -> Offer:
    """A plan at each price, the lowest first. After Ctrl-C, or where a price leaves no plan, those found so far.

    Each is of what is left where a stopped program has `already` cut some of the nest. With `relax` the cheapest
    statements give way where hard rules clash.

    Raises
    ------
    InputError
        If a lock names what the nest does not have, or a contour cannot be cut.
    RulesConflict
        If not even the first price leaves a plan.
    KeyboardInterrupt
        If Ctrl-C was pressed before there was any.
    """
    expect_one_torch(inputs.profile, "the price of heat")
    profile = lock_broken_cut_first(inputs.profile, already)
    limit_c = profile.heat.limit_c
    offered = TradeOff(facts_of(inputs.nest, profile, already), profile, limits, relax)
    trades: list[Trade] = []
    try:
        for price_mm in sorted(set(prices_mm)):
            if price_mm:
                offered.fit()  # Ctrl-C meanwhile ends the job at once: there is no better plan in it to keep
            with new_listener() as listener:
                trades.append(offered.at(price_mm, listener))
            if listener.stopped:
                return Offer(tuple(trades), limit_c, name, interrupted=True)
    except RulesConflict as error:
        if not trades:
            raise
        return Offer(tuple(trades), limit_c, name, refused=error)
    except KeyboardInterrupt:
        if not trades:
            raise
        return Offer(tuple(trades), limit_c, name, interrupted=True)
    return Offer(tuple(trades), limit_c, name)


# Plans of one nest with their idle travel and overheats: which no other beats, and all as a plot.

_FRONT, _OTHER = "#c8442c", "#868e96"


@dataclass(frozen=True, eq=False, slots=True)
class Trade:
    """One plan: the price of an overheat that it was made at, mm of idle travel, what it has of both, and its peak."""

    price_mm: float
    made: VerifiedPlan
    overheats: int
    peak_c: float

    @property
    def plan(self) -> Plan:
        """The plan itself."""
        return self.made.plan

    @property
    def idle_mm(self) -> float:
        """Its idle travel."""
        return self.plan.totals.idle_mm

    @property
    def lawful(self) -> bool:
        """Whether the check takes it."""
        return self.made.verdict.ok

    def beats(self, other: Trade) -> bool:
        """Whether it is no worse in either and better in one."""
        mine, theirs = (self.overheats, self.idle_mm), (other.overheats, other.idle_mm)
        return mine != theirs and mine[0] <= theirs[0] and mine[1] <= theirs[1]


def front(trades: Sequence[Trade]) -> list[Trade]:
    """Those lawful ones that no other beats, by idle travel; of equal ones the first."""
    kept: list[Trade] = []
    lawful = [trade for trade in trades if trade.lawful]
    for trade in sorted(lawful, key=lambda t: (t.idle_mm, t.overheats, t.price_mm)):
        if not kept or trade.overheats < kept[-1].overheats:
            kept.append(trade)
    return kept


def front_png(trades: Sequence[Trade], limit_c: float, name: str = "") -> bytes:
    """A PNG of every plan as a point, with its price; those on the front are joined by steps.

    What lies above and to the right of the steps is beaten by a plan that there is. `name` is that of the nest.
    """
    # Loading matplotlib takes longer than most verbs: only those who want a picture pay for it.
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=(7.5, 5), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    best = front(trades)
    places = [t.idle_mm / 1000 for t in best], [t.overheats for t in best]
    axes.plot(*places, color=_FRONT, marker="o", drawstyle="steps-post", label="front")
    for label, marker, others in (
        ("no better", "o", [t for t in trades if t.lawful and t not in best]),
        ("refused by the check", "x", [t for t in trades if not t.lawful]),
    ):
        if others:
            places = [t.idle_mm / 1000 for t in others], [t.overheats for t in others]
            axes.scatter(*places, color=_OTHER, marker=marker, zorder=1, label=label)
    prices: dict[tuple[float, int], list[str]] = {}
    for trade in trades:
        prices.setdefault((trade.idle_mm / 1000, trade.overheats), []).append(f"{trade.price_mm:g}")
    for place, told in prices.items():
        axes.annotate(f"{', '.join(told)} mm", place, xytext=(6, 6), textcoords="offset points", fontsize=8)
    axes.margins(x=0.18)
    axes.set_ylim(0, 1.12 * max([1, *(t.overheats for t in trades)]))
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("idle travel, m")
    axes.set_ylabel(f"overheats: points over {limit_c:g} °C")
    title = f"{name}: each point a plan" if name else "each point a plan"
    axes.set_title(f"{title}, beside it the price of an overheat in mm of idle travel", fontsize=10, loc="left")
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3)
    file = io.BytesIO()
    figure.savefig(file, format="png", metadata={"Software": None})
    return file.getvalue()
