"""The trade-off of idle travel against overheats as a plot."""

from __future__ import annotations

import io
from collections.abc import Sequence

from ..trade_off import Trade, front


def front_png(trades: Sequence[Trade], limit_c: float) -> bytes:
    """A PNG of every plan as a point, with its price; those on the front are joined by a line."""
    # Loading matplotlib takes longer than most verbs: only those who want a picture pay for it.
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 5), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    best = front(trades)
    axes.plot([t.idle_mm / 1000 for t in best], [t.overheats for t in best], color="#c8442c", marker="o", label="front")
    others = [t for t in trades if t not in best]
    if others:
        places = [t.idle_mm / 1000 for t in others], [t.overheats for t in others]
        axes.scatter(*places, color="grey", zorder=1, label="no better")
    prices: dict[tuple[float, int], list[str]] = {}
    for trade in trades:
        prices.setdefault((trade.idle_mm / 1000, trade.overheats), []).append(f"{trade.price_mm:g}")
    for place, told in prices.items():
        axes.annotate(f"{', '.join(told)} mm", place, xytext=(5, 5), textcoords="offset points", fontsize=8)
    axes.set_xlabel("idle travel, m")
    axes.set_ylabel(f"points over {limit_c:g} °C")
    axes.set_title("what an overheat costs, and what that buys", fontsize=10, loc="left")
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3)
    file = io.BytesIO()
    figure.savefig(file, format="png", metadata={"Software": None})
    return file.getvalue()
