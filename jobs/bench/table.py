"""Results as a table that is printed line by line, as its last line, and as JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict

from .measure import BenchResult

WIDTHS = (18, 13, 12, 12, 9, 7, 9, 9)
TITLES = ("instance", "engine", "cost", "best known", "gap", "proven", "seconds", "memory")


def head() -> str:
    """The titles."""
    return _joined(TITLES)


def line(result: BenchResult, best: float | None) -> str:
    """One result; the gap is to the best known cost."""
    bound = "" if result.bound is None else f"≥ {result.bound:g}"
    return _joined(
        (
            result.instance,
            result.engine,
            "none" if result.cost is None else f"{result.cost:g}",
            "" if best is None else f"{best:g}",
            "" if (gap := gap_to(result, best)) is None else f"{gap:+.2%}",
            "yes" if result.proven else bound,
            f"{result.seconds:.2f} s",
            f"{result.memory_mb:.0f} MB",
        )
    ) + (f"  {result.fault}" if result.fault else "")


def gap_to(result: BenchResult, best: float | None) -> float | None:
    """(cost - best) / best, None where either is not known."""
    if best is None or result.cost is None or not result.feasible:
        return None
    return (result.cost - best) / best if best else float(result.cost > 0)


def results_in_all(results: Sequence[BenchResult], bests: Sequence[float | None]) -> str:
    """How many, how good."""
    gaps = [gap for r, b in zip(results, bests, strict=True) if (gap := gap_to(r, b)) is not None]
    said = [
        f"{len(results)} runs",
        f"{sum(r.feasible for r in results)} feasible",
        f"{sum(r.proven for r in results)} proven",
    ]
    if gaps:
        said.append(f"at or under best known {sum(g <= 0 for g in gaps)} of {len(gaps)}")
        said.append(f"mean gap {sum(gaps) / len(gaps):.3%}, worst {max(gaps):.2%}")
    said.append(
        f"{sum(r.seconds for r in results):.1f} s, at most {max((r.memory_mb for r in results), default=0):.0f} MB"
    )
    return ", ".join(said)


def results_as_json(results: Sequence[BenchResult]) -> str:
    """A list of objects, one a run."""
    return json.dumps([asdict(result) for result in results], indent=1)


def _joined(cells: Sequence[str]) -> str:
    first, *rest = zip(cells, WIDTHS, strict=True)
    return first[0].ljust(first[1]) + "".join(" " + cell.rjust(width) for cell, width in rest)
