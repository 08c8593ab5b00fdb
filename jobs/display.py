"""How results are shown: the summary that `solve` prints, pictures in notebooks, tables for pandas."""

from __future__ import annotations

import base64
import html
import importlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import InputError
from kerfwise.models.plan.plan import Dropped, Plan
from kerfwise.postproc.check import CheckResult, report
from kerfwise.postproc.output_files import write_files
from kerfwise.postproc.report.legend import counted
from kerfwise.rules.statements import EXEMPTION_MM, RELAXED_MM

if TYPE_CHECKING:
    import pandas

    from .nest_job import Job


PictureKind = Literal["svg", "png", "html"]


@dataclass(frozen=True, eq=False, slots=True)
class Picture:
    """A drawing; the last line of a notebook's cell shows it.

    Attributes
    ----------
    content
        The content of its file.
    kind
        svg, png, or html for a page that plays the cuts in order.

    Examples
    --------
    >>> Picture(b"<svg/>", "svg").html()
    '<img style="max-width: 100%" src="data:image/svg+xml;base64,PHN2Zy8+"/>'
    """

    content: bytes
    kind: PictureKind

    def save(self, path: str | Path) -> Path:
        """Write the file, whole or not at all.

        Raises InputError if it cannot be written, or its name ends otherwise than in the kind of the picture.
        """
        path = Path(path)
        if path.suffix.lower() != f".{self.kind}":
            raise InputError(f"this picture is of type {self.kind}: the file name must end in .{self.kind}", file=path)
        write_files({path: self.content})
        return path

    def html(self) -> str:
        """The picture as a piece of a web page."""
        if self.kind == "html":
            page = html.escape(self.content.decode("utf-8"))
            return f'<iframe srcdoc="{page}" style="width: 100%; height: 40em; border: 0"></iframe>'
        kind = {"svg": "svg+xml", "png": "png"}[self.kind]
        data = base64.b64encode(self.content).decode("ascii")
        return f'<img style="max-width: 100%" src="data:image/{kind};base64,{data}"/>'

    def _repr_html_(self) -> str:
        return self.html()

    def __repr__(self) -> str:
        return f"<{self.kind} picture, {len(self.content)} bytes>"


# Tables for whoever works on with pandas: the cuts of a plan, a row each.

SIDE_CHOSEN = {
    "profile": "as the profile says",
    "long-parts": "more long parts lie there",
    "offcut": "a large offcut stiffens the far end",
    "heat": "more is cut on that half",
    "narrow-side": "both narrow sides are alike",
}
"""Why cutting starts from a side, by `Plan.start_side_because`."""
NO_PANDAS = "a table needs pandas, which is not installed: pip install pandas"


def data_frame(rows: Sequence[dict[str, Any]], columns: Sequence[str] | None = None) -> pandas.DataFrame:
    """The rows as a table. Raises InputError if pandas is not installed."""
    try:
        loaded: Any = importlib.import_module("pandas")
    except ImportError:
        raise InputError(NO_PANDAS) from None
    return loaded.DataFrame(rows, columns=columns)


CUT_COLUMNS = (
    "order", "contour", "part", "kind", "zone", "direction", "entry_x_mm", "entry_y_mm", "pierce_x_mm", "pierce_y_mm",
    "length_mm", "start_s", "end_s", "dwell_s", "because",
)  # fmt: skip


def cut_rows(plan: Plan) -> Iterator[dict[str, Any]]:
    """A row for each cut that the plan makes, in order, with the keys `CUT_COLUMNS`: lengths in mm, times in s."""
    for order, planned in enumerate(plan.cuts, plan.resumed_after + 1):
        cut = planned.cut
        row = (
            order, cut.contour, planned.part, planned.kind, cut.zone, cut.direction, *cut.entry, *cut.pierce,
            planned.length_mm, cut.start_s, cut.end_s, planned.dwell_s, "; ".join(planned.because),
        )  # fmt: skip
        yield dict(zip(CUT_COLUMNS, row, strict=True))


# What solve prints: the plan in four lines, then every rule with its verdict.


def summary(plan: Plan, verdict: CheckResult) -> str:
    """The plan's totals, what is proven of it, and the verdict of the independent check on every rule."""
    return "\n".join([*summary_lines(plan), report(verdict)])


def summary_lines(plan: Plan) -> list[str]:
    """The plan's totals, what is proven of it, and what was dropped."""
    totals, solve = plan.totals, plan.solve
    proof = proof_of(plan)
    lines = []
    if plan.already:
        again = "" if plan.broken_off is None else f", cut {plan.resumed_after + 1} is made again"
        lines.append(f"resumed after cut {plan.resumed_after}{again}: only the rest is planned")
    if plan.broken_off is not None and plan.cuts and plan.broken_off.cut.pierce == plan.cuts[0].cut.pierce:
        name = plan.broken_off.cut.contour
        lines.append(f"{name} begins in its old pierce: there is no room for another beside the old kerf")
    lines += [
        f"{counted(len(plan.cuts), 'contour')}, {counted(totals.pierces, 'pierce')}, cut {totals.cut_mm / 1000:.3f} m, "
        f"idle {totals.idle_mm / 1000:.3f} m, {_clock(totals.time_s)}",
        f"{_objective(plan)}, found by {solve.found_by}, {proof}",
        *_prices(plan),
        f"start side {plan.start_side} ({SIDE_CHOSEN.get(plan.start_side_because, plan.start_side_because)}), "
        f"{counted(max((p.cut.zone for p in plan.cuts), default=0), 'zone')}",
    ]
    if plan.cost is not None:
        lines.append(f"a sheet costs {plan.cost}")
    if plan.zones_cost is not None:
        lines.append(plan.zones_cost.sentence)
    zero = f"the sheet's corner, at ({plan.zero[0]:g}, {plan.zero[1]:g}) of the drawing"
    lines.append(f"the machine's zero is {'that of the drawing' if plan.origin == 'drawing' else zero}")
    if plan.waits:
        longest = max(plan.waits, key=lambda planned: planned.dwell_s)
        all_told = f"{len(plan.waits)}, {plan.wait_s:.1f} s in all"
        longest_told = f"the longest {longest.dwell_s:.1f} s before {longest.cut.contour}"
        lines.append(f"waits for metal to cool: {all_told}, {longest_told}")
    return [*lines, *_dropped(plan.dropped)]


def job_line(job: Job, plan: Plan) -> str:
    """What a plan is for and what all sheets take and cost, where a job file says how many; "" where it says nothing.

    Examples
    --------
    >>> from kerfwise.jobs.nest_job import Job
    >>> from types import SimpleNamespace as Plan
    >>> job_line(Job(order="4711", quantity=3), Plan(totals=Plan(time_s=100.4), cost=None))
    'order 4711: 3 sheets, 5 min 01 s'
    """
    words = [f"{what} {value}" for what, value in (("order", job.order), ("due", job.due)) if value is not None]
    if not words and job.quantity == 1:
        return ""
    all_told = [counted(job.quantity, "sheet"), _clock(plan.totals.time_s * job.quantity)]
    all_told += [] if plan.cost is None else [f"{plan.cost.total * job.quantity:.2f} {plan.cost.currency}"]
    return f"{', '.join(words)}: {', '.join(all_told)}" if words else ", ".join(all_told)


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest:02d} s"


def proof_of(plan: Plan) -> str:
    """What is proven of the cost, and for what: plans within the same zones, by the same entries.

    A bound beyond `Plan.heavy_mm` says that no plan has fewer excuses and relaxed statements; what is left of both is
    then a bound on the rest.
    """
    solve, heavy_mm = plan.solve, plan.heavy_mm
    if solve.status == "optimal":
        return f"proven optimal within these zones and entries (by {solve.proved_by})"
    if solve.bound is None or solve.gap is None:
        return "no bound is proven"
    if not heavy_mm:
        return f"gap {solve.gap:.2%} (bound {solve.bound / 1000:.3f} m, for these zones and entries)"
    if not plan.none_needless:
        return "nothing is proven: plans with fewer excuses are not ruled out"
    fewest = "no plan with these zones and entries has fewer excuses"
    if plan.light_gap is None:
        return f"{fewest}; of what it costs besides nothing is proven"
    return f"{fewest}; besides, gap {plan.light_gap:.2%} (bound {(solve.bound - heavy_mm) / 1000:.3f} m)"


def _objective(plan: Plan) -> str:
    """What the plan costs; excuses and relaxed statements, which weigh more than any travel, are counted apart."""
    excuses, heavy_mm = plan.solve.excuses, plan.heavy_mm
    rest_mm, relaxed = plan.solve.objective - heavy_mm, (heavy_mm - excuses * EXEMPTION_MM) / RELAXED_MM
    text = f"objective {rest_mm / 1000:.3f} m"
    if plan.pierces:
        text += " without the way of the pierce pass"
    if excuses:
        fewest = ", the fewest within these zones and entries" if plan.solve.status == "optimal" else ""
        text += f" and {excuses} excuse{'s' if excuses > 1 else ''}{fewest}"
    if relaxed:
        text += f" and {relaxed:.0f} relaxed statement{'s' if relaxed > 1 else ''}"
    return text


def _prices(plan: Plan) -> Iterator[str]:
    """What the objective is made of, where that is more than travel."""
    prices = plan.prices
    if prices is None or not (prices.breaches or prices.simulated_mm):
        return
    rules = (
        f" + {rule} {mm / 1000:.3f} m ({counted(count, 'place')})"
        for rule, (count, mm) in prices.by_rule.items()
        if mm < EXEMPTION_MM
    )
    shown = f" + what the simulation shows {prices.simulated_mm / 1000:.3f} m" if prices.simulated_mm else ""
    yield f"that is travel {prices.travel_mm / 1000:.3f} m" + "".join(rules) + shown


MOST_DROPPED = 3


def _dropped(found: Sequence[Dropped]) -> Iterator[str]:
    """What was dropped, a line for each reason: a sum that must hold may have a hundred orders of a rule give way."""
    alike: dict[tuple[str, str], list[str]] = {}
    for dropped in found:
        named = "" if dropped.relaxed else " before ".join(dropped.contours)
        alike.setdefault((dropped.rule, dropped.why), []).append(named)
    for (rule, why), orders in alike.items():
        if not orders[0]:
            yield f"{rule}, {why}"
        elif len(orders) == 1:
            yield f"dropped: {orders[0]} ({rule}), {why}"
        else:
            yield f"dropped: {len(orders)} orders of {rule}, {join_names(orders, MOST_DROPPED)}; {why}"
