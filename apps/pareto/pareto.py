"""The trade-off of idle travel, overheats and errors of parts: the best plan at each of several prices, simulated."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.already_cut import NOTHING_CUT, AlreadyCut
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.jobs.by_engine import OrdersOf
from kerfwise.jobs.display import Picture, data_frame
from kerfwise.jobs.heat_control import cooler_orders
from kerfwise.jobs.heat_path import path_of_plan
from kerfwise.jobs.inputs import Inputs, expect_one_torch
from kerfwise.jobs.progress import Listener
from kerfwise.jobs.request import facts_of, make_request
from kerfwise.jobs.resume import lock_broken_cut_first
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.physics.heat import simulate
from kerfwise.models.plan.plan import Plan
from kerfwise.pipeline import VerifiedPlan, plan_request, verified
from kerfwise.rules.profile.profile import Profile

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, slots=True)
class Straightness:
    """How far the parts of a plan will be off, mm: `of` simulates it, `orders` finds plans at a price on it.

    `prices_mm` are what a mm may cost, mm of idle travel: a plan is made at each.
    """

    of: Callable[[Inputs, Plan], float]
    orders: OrdersOf
    prices_mm: tuple[float, ...] = ()


class TradeOff:
    """Plans of one nest at prices of an overheat, and of a mm that parts are off.

    `profile`: its own price of an overheat is not looked at. `limits`: of each plan. `relax`: where hard rules clash,
    the cheapest statements give way, marked in each plan. `straightness`: how far parts are off, where that is an axis,
    too. Raises RulesConflict if hard orders contradict each other.
    """

    def __init__(
        self, facts: Facts, profile: Profile, limits: SolveOptions, relax: bool = False,
        straightness: Straightness | None = None,
    ) -> None:  # fmt: skip
        self._facts, self._limits, self._straightness = facts, limits, straightness
        self._profile = replace(profile, objective=replace(profile.objective, heat=0.0, distortion=0.0))
        self._asked = make_request(facts, self._profile, relax, limits=limits)
        self._cooler = cooler_orders(facts, self._profile, self._asked.stated)
        if straightness is not None and straightness.prices_mm:
            self._straighter = straightness.orders(facts, self._profile, self._asked.stated)

    def fit(self) -> None:
        """Find out which orders overheat metal: the nest is simulated many times over, once for all prices."""
        if self._profile.heat.absorbed_power_w:
            self._cooler.start()

    def at(self, price_mm: float, progress: Progress | None = None, off_price_mm: float = 0.0) -> Trade:
        """The plan at a price of an overheat or of a mm, simulated; what was simulated for other prices helps.

        Raises RulesConflict if no lawful plan exists, or none was found.
        """
        facts, straightness = self._facts, self._straightness
        objective = replace(self._profile.objective, heat=price_mm, distortion=off_price_mm)
        profile = replace(self._profile, objective=objective)
        orders = self._straighter if off_price_mm else self._cooler
        planned = plan_request(self._asked, profile, self._limits, progress=progress, simulated=orders)
        made = verified(planned, profile)
        path = path_of_plan(made.plan, facts.nest, profile)
        found = simulate(facts.nest, path, profile.heat, profile.material.thickness_mm)
        off_mm = None if straightness is None else straightness.of(Inputs(facts.nest, profile), made.plan)
        return Trade(price_mm, made, found.overheats, found.peak_c, off_mm, off_price_mm)


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Offer:
    """Plans of one nest at several prices of an overheat, and of a mm that parts are off, each simulated.

    Attributes
    ----------
    trades
        The plans, by price of an overheat, then by price of a mm.
    limit_c
        Above this metal is too hot, °C.
    name
        That of the nest.
    interrupted
        Whether Ctrl-C ended the look: the plans found so far are here.
    refused
        Why a price left no plan, where one did; None otherwise.
    """

    trades: tuple[Trade, ...]
    limit_c: float
    name: str = ""
    interrupted: bool = False
    refused: RulesConflict | None = None

    @property
    def front(self) -> tuple[Trade, ...]:
        """Those that no other beats in idle travel, overheats and, where simulated, mm; by idle travel."""
        return tuple(front(self.trades))

    @property
    def _has_mm(self) -> bool:
        return any(trade.off_mm is not None for trade in self.trades)

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
            | ({} if trade.off_mm is None else {"off_price_mm": trade.off_price_mm, "off_mm": round(trade.off_mm, 4)})
            for trade in self.trades
        ]

    def files(self) -> Mapping[str, str]:
        """Name → content of the plan and the program of each price that the check takes."""
        return {
            f"{trade.name}.{suffix}": content
            for trade in self.trades
            if trade.lawful
            for suffix, content in (("plan.json", trade.plan.to_json()), ("nc", trade.made.program))
        }

    def picture(self) -> Picture:
        """A PNG of every plan as a point; those on the front are joined by steps."""
        return Picture(front_png(self.trades, self.limit_c, self.name), "png")

    def to_frame(self) -> pandas.DataFrame:
        """`rows` as a table.

        Raises InputError if pandas is not installed.
        """
        return data_frame(self.rows())

    def save(self, folder: str | Path) -> tuple[Path, ...]:
        """Write the plan and the program of each price to a folder, all or none; the check must take them.

        Raises InputError if they cannot be written.
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
        if self._has_mm:
            lines[0] += f" {'off, mm':>9} {'price of a mm':>14}"
        for row in self.rows():
            mark = "" if row["front"] else "   no better than another"
            mark = mark if row["lawful"] else "   the check refuses it: not written"
            lines.append(
                f"{row['price_mm']:10g} {row['overheats']:14d} {row['peak_c']:9.1f} {row['idle_mm'] / 1000:9.3f} "
                f"{row['time_s']:9.1f}"
                + (f" {row['off_mm']:9.3f} {row['off_price_mm']:14g}" if self._has_mm else "")
                + mark
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
    straightness: Straightness | None = None,
) -> Offer:
    """A plan at each price, the lowest first. After Ctrl-C, or where a price leaves no plan, those found so far.

    Each is of what is left where a stopped program has `already` cut some of the nest. With `relax` the cheapest
    statements give way where hard rules clash. With `straightness` each has its mm, and plans at prices on them follow.

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
    offered = TradeOff(facts_of(inputs.nest, profile, already), profile, limits, relax, straightness)
    trades: list[Trade] = []
    off_prices = () if straightness is None else sorted(set(straightness.prices_mm) - {0.0})
    try:
        for price_mm, off_price_mm in [*((p, 0.0) for p in sorted(set(prices_mm))), *((0.0, p) for p in off_prices)]:
            if price_mm:
                offered.fit()  # Ctrl-C meanwhile ends the job at once: there is no better plan in it to keep
            with new_listener() as listener:
                trades.append(offered.at(price_mm, listener, off_price_mm))
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


# Plans of one nest with idle travel, overheats and mm: which no other beats, and all as a plot.

_FRONT, _OTHER = "#c8442c", "#868e96"


@dataclass(frozen=True, eq=False, slots=True)
class Trade:
    """One plan: the price of an overheat that it was made at, mm of idle travel, what it has of both, and its peak.

    `off_mm` is how far its parts will be off, mean of their worst places, mm, where that was simulated; `off_price_mm`
    the price of a mm of it.
    """

    price_mm: float
    made: VerifiedPlan
    overheats: int
    peak_c: float
    off_mm: float | None = None
    off_price_mm: float = 0.0

    @property
    def name(self) -> str:
        """That of its files."""
        return f"off-price-{self.off_price_mm:.12g}" if self.off_price_mm else f"price-{self.price_mm:.12g}"

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

    @property
    def costs(self) -> tuple[float, float, float]:
        """Idle travel, mm, overheats, and mm that parts are off: the less the better."""
        return self.idle_mm, self.overheats, self.off_mm or 0.0

    def beats(self, other: Trade) -> bool:
        """Whether it is no worse in any of them and better in one."""
        return self.costs != other.costs and all(a <= b for a, b in zip(self.costs, other.costs, strict=True))


def front(trades: Sequence[Trade]) -> list[Trade]:
    """Those lawful ones that no other beats, by idle travel; of equal ones the first."""
    kept: dict[tuple[float, float, float], Trade] = {}
    lawful = [trade for trade in trades if trade.lawful]
    for trade in sorted(lawful, key=lambda t: (t.costs, t.price_mm, t.off_price_mm)):
        if not any(other.beats(trade) for other in lawful):
            kept.setdefault(trade.costs, trade)
    return list(kept.values())


def front_png(trades: Sequence[Trade], limit_c: float, name: str = "") -> bytes:
    """A PNG of every plan as a point, with its price; those on the front are joined by steps.

    What lies above and to the right of the steps is beaten by a plan that there is. `name` is that of the nest.
    """
    # Loading matplotlib takes longer than most verbs: only those who want a picture pay for it.
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    has_mm = any(trade.off_mm is not None for trade in trades)
    figure = Figure(figsize=(7.5, 9 if has_mm else 5), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(1 + has_mm, squeeze=False)[:, 0]
    _plot(panels[0], trades, lambda t: t.overheats, 1.0)
    panels[0].set_ylabel(f"overheats: points over {limit_c:g} °C")
    panels[0].yaxis.set_major_locator(MaxNLocator(integer=True))
    if has_mm:
        _plot(panels[1], trades, lambda t: t.off_mm or 0.0, 0.01)
        panels[1].set_ylabel("parts off when cold, mean, mm")
    panels[-1].set_xlabel("idle travel, m")
    prices = "the price of an overheat" + (", or of a mm," if has_mm else "")
    title = f"{name}: each point a plan" if name else "each point a plan"
    panels[0].set_title(f"{title}, beside it {prices} in mm of idle travel", fontsize=10, loc="left")
    file = io.BytesIO()
    figure.savefig(file, format="png", metadata={"Software": None})
    return file.getvalue()


def _plot(axes: Any, trades: Sequence[Trade], height: Callable[[Trade], float], least: float) -> None:
    """One panel: idle travel against one of the others. Steps join what nothing beats in these two."""
    best = front(trades)
    low: list[Trade] = []
    for trade in best:
        if not low or height(trade) < height(low[-1]):
            low.append(trade)
    for label, marker, colour, shown in (
        ("front", "o", _FRONT, best),
        ("no better", "o", _OTHER, [t for t in trades if t.lawful and t not in best]),
        ("refused by the check", "x", _OTHER, [t for t in trades if not t.lawful]),
    ):
        if shown:
            at = [t.idle_mm / 1000 for t in shown], [height(t) for t in shown]
            axes.scatter(*at, color=colour, marker=marker, zorder=2 if colour == _FRONT else 1, label=label)
    axes.plot([t.idle_mm / 1000 for t in low], [height(t) for t in low], color=_FRONT, drawstyle="steps-post")
    prices: dict[tuple[float, float], list[str]] = {}
    for trade in trades:
        price = f"{trade.off_price_mm:g} for a mm" if trade.off_price_mm else f"{trade.price_mm:g} mm"
        prices.setdefault((trade.idle_mm / 1000, height(trade)), []).append(price)
    for place, texts in prices.items():
        axes.annotate(", ".join(texts), place, xytext=(6, 6), textcoords="offset points", fontsize=8)
    axes.margins(x=0.18)
    axes.set_ylim(0, 1.12 * max([least, *(height(t) for t in trades)]))
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3)
