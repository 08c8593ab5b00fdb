"""Plans of one nest with their idle travel and overheats: which no other beats, and all as a plot."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass

from kerfwise.models.plan.plan import Plan

from .produce import Produced

_FRONT, _OTHER = "#c8442c", "#868e96"


@dataclass(frozen=True, eq=False, slots=True)
class Trade:
    """One plan: the price of an overheat that it was made at, mm of idle travel, what it has of both, and its peak."""

    price_mm: float
    made: Produced
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
