"""How soon a changed nest has a plan again: a part dropped, moved, turned, added, the plan at hand as the start.

Usage: python -m kerfwise.benchmarks.edits [--contours 16 41 115] [--seed 1] [--work 1]

Plates of examples/gen_sheet.py under the default profile, planned with so much work before. For each change: seconds of
the edit, and of `solve --first --start OLD` with its check, of processor and by the clock, kernels compiled; how many
cuts of the old plan kept their place among the others; and what the new plan costs beside one that starts from nothing
with the same work as the old one.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from typing import TypeVar

import kerfwise
from kerfwise.apps.bench.bench_child import load_kernels
from kerfwise.apps.edit.edited_nest import EditedNest
from kerfwise.benchmarks.plates import cost, made_plate
from kerfwise.encoder.nest import Nest

T = TypeVar("T")
HEAD = """\
| contours | change | edit, s | first plan, s (clock) | cuts in the old order | first plan, m | anew, m |
|---:|---|---:|---:|---:|---:|---:|"""


def timed(run: Callable[[], T]) -> tuple[T, float, float]:
    """What it gives, and the seconds of processor and by the clock that it took."""
    clock, processor = time.monotonic(), time.process_time()
    return run(), time.process_time() - processor, time.monotonic() - clock


def in_order(old: Sequence[str], new: Sequence[str]) -> int:
    """How many of `new` can stand still while the others move, so that they follow each other as in `old`.

    Examples
    --------
    >>> in_order("abcde", "bacde")
    4
    """
    places = {name: k for k, name in enumerate(old)}
    longest: list[int] = []
    best: list[tuple[int, int]] = []
    for name in new:
        if (at := places.get(name)) is not None:
            longest.append(1 + max((n for n, before in zip(longest, best, strict=True) if before[0] < at), default=0))
            best.append((at, longest[-1]))
    return max(longest, default=0)


def changed_by(edited: EditedNest, change: str) -> Nest:
    """The nest after a change."""
    return edited.do(change).nest


def lawful(edited: EditedNest, part: str) -> dict[str, str]:
    """A turn and a move of a part that keep the gap; none where there is no room."""
    turns = (f"turn {part} {deg}" for deg in (180, 90, 270, 1))
    moves = (f"move {part} {x} {y}" for x, y in ((2, 0), (-2, 0), (0, 2), (0, -2)))
    found = {}
    for kind, tried in (("turn", turns), ("move", moves)):
        for change in tried:
            with suppress(kerfwise.InputError):
                edited.do(change)
                found[kind] = change
                break
    return found


def main() -> None:
    """Plan, change, plan again, and print."""
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--contours", type=int, nargs="+", default=[16, 41, 115])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--work", type=float, default=1.0)
    given = parser.parse_args()
    load_kernels()
    print(HEAD)
    for contours in given.contours:
        rows(contours, given.seed, given.work)


def rows(contours: int, seed: int, work: float) -> None:
    """The rows of one plate."""
    nest = made_plate(contours, seed)
    old = kerfwise.solve(nest, work=work).plan
    names = [part.id for part in nest.parts]
    middle = names[len(names) // 2]
    edited = kerfwise.edit(nest, None, f"drop {names[-1]}").undo()
    changes = {"drop": f"drop {middle}", **lawful(edited, middle)}
    for kind, change in changes.items():
        changed, edit_s, _ = timed(partial(changed_by, edited, change))
        first, first_s, clock_s = timed(partial(kerfwise.solve, changed, first=True, start=old))
        anew = kerfwise.solve(changed, work=work).plan
        same = in_order([row.cut.contour for row in old.cuts], [row.cut.contour for row in first.plan.cuts])
        print(
            f"| {len(old.cuts)} | {kind} | {edit_s:.2f} | {first_s:.2f} ({clock_s:.2f}) "
            f"| {same} of {len(first.plan.cuts)} | {cost(first.plan.solve.objective)} | {cost(anew.solve.objective)} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
