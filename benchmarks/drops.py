"""How soon a drop in the viewer is answered, on made plates: `python -m kerfwise.benchmarks.drops`.

Usage: python -m kerfwise.benchmarks.drops [--contours 16 41 115 308 1000] [--work 30] [--seed 1] [--at-hand 2]
       [--into docs/page.md]

A nest is planned with little work (`--at-hand`) and opened in a server of its own; then a contour near the middle of
the order is dropped three places further on, as the page does it. Printed are seconds by the clock from the drop on:
until the first lawful plan is there with its program and the verdict, until the last plan that was better, and until
the end, with the travel of each and what is proven. Kernels are compiled beforehand; what a row takes the first time
is not counted. With `--into` the rows are set into that page, too.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kerfwise.apps.viewer.serve.nest_folder import Folder
from kerfwise.apps.viewer.serve.server import Server, Serving
from kerfwise.apps.viewer.serve.session import Alternative, Session
from kerfwise.benchmarks.tables import put_row
from kerfwise.examples.gen_sheet import make_sheet

HEAD = "| contours | first plan, s | better plans | last of them, s | end, s | first, m | last, m | end, m | proven |"


@dataclass(frozen=True)
class Came:
    """A plan, and when it came."""

    after_s: float
    plan: Alternative

    @property
    def cost(self) -> str:
        """Its cost, m, and its excuses."""
        excuses = self.plan.figures["excuses"]
        return f"{self.plan.figures['light_mm'] / 1000:.2f}" + (f" and {excuses} excused" if excuses else "")


async def ended(server: Server, session: Session, work: float | None = None) -> list[Came]:
    """Plan what is wanted to its end; each plan as it came."""
    ear, found = server.news.listen(session.id), list[Came]()
    before, began_s = {one.number for one in session.alternatives}, time.perf_counter()
    server.planning.solve(session, work)
    while session.solving is not None or not found:
        await ear.next()
        known = before | {one.plan.number for one in found}
        after_s = time.perf_counter() - began_s
        found += [Came(after_s, one) for one in session.alternatives if one.number not in known]
        if session.conflict is not None or session.problem:
            raise SystemExit(f"{session.name}: {session.problem or session.conflict}")
    server.news.leave(ear)
    return found


async def lawful_drop(server: Server, session: Session) -> dict[str, Any]:
    """A drop of one contour near the middle of the order that no rule forbids."""
    current = session.current
    assert current is not None
    cuts = json.loads(current.plan)["cuts"]
    middle = len(cuts) // 2
    for row in sorted(range(len(cuts) - 4), key=lambda row: abs(row - middle)):
        name = cuts[row]["contour"]
        told: dict[str, Any] = await server.about(session, "move", contours=[name], place=row + 4)
        if told["lawful"] and told["more_mm"]:
            return told
    raise SystemExit(f"{session.name}: nothing can be dropped three places further on")


async def row(contours: int, work: float, seed: int, at_hand: float) -> str:
    """A line of the table."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        text = json.dumps(make_sheet(seed, contours))
        (folder / "plate.json").write_text(text, encoding="utf-8", newline="\n")
        server = Server(Folder(folder), Serving(work=work))
        await server.begin()
        try:
            session = await server.open_nest(folder / "plate.json")
            await ended(server, session, at_hand)
            told = await lawful_drop(server, session)
            began_s = time.perf_counter()
            await server.edit(session, [{"lock": line} for line in told["locked"]])
            edited_s = time.perf_counter() - began_s
            came = await ended(server, session)
        finally:
            await server.end()
    first, last = came[0], came[-1]
    better = [one for one in came if one.plan.stage == "better"]
    shown = better[-1] if better else first
    proven = last.plan.figures
    said = "optimal" if last.plan.figures["status"] == "optimal" else f"gap {100 * (proven['gap'] or 1):.1f} %"
    times = [f"{edited_s + one.after_s:.2f}" for one in (first, shown, last)]
    cells = [str(contours), times[0], str(len(better)), times[1], times[2], first.cost, shown.cost, last.cost, said]
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Read the command line, print the table."""
    arguments = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    arguments.add_argument("--contours", type=int, nargs="+", default=[16, 41, 115, 308, 1000])
    arguments.add_argument("--work", type=float, default=30.0)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--at-hand", type=float, default=2.0, help="work for the plan that the drop is made in")
    arguments.add_argument("--into", type=Path, help="the page whose rows are renewed")
    given = arguments.parse_args()
    print(f"{HEAD}\n|{'---:|' * 9}")
    for contours in given.contours:
        put_row(asyncio.run(row(contours, given.work, given.seed, given.at_hand)), HEAD, given.into)


if __name__ == "__main__":
    main()
