"""How fast the page is in the browser: frames while the view moves and at 64 times, first drawing, memory, file.

Usage: python -m kerfwise.benchmarks.page [CONTOURS …] [--into docs/page.md]

Prints the table of docs/page.md, and sets its rows into that page with `--into`. It needs Chromium and Playwright. The
nests are those of `examples/gen_sheet.py`, with an order from left to right that nobody has planned.
"""

from __future__ import annotations

import argparse
import math
import statistics
import tempfile
from pathlib import Path

from playwright.sync_api import Browser, Page

from kerfwise.benchmarks.tables import put_row
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Nest, Part, Sheet
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.models.plan.plan import Plan, PlannedCut, SolveReport, Totals
from kerfwise.postproc.report import draw
from kerfwise.tests.tools.browser import launched

HEAD = (
    "| contours | file, MB | first drawing, ms | moved: a frame, ms | slowest of 20, ms "
    "| played at 64 ×: a frame, ms | slowest of 20, ms | memory, MB |"
)
SIZES = (16, 115, 308, 1000, 5000, 10_000)
FRAMES = 150
_MOVES = """frames => new Promise(done => {
  const app = window.kerfwise, stage = app.stages[0], took = [];
  let before = 0, left = frames;
  const step = now => {
    if (before) took.push(now - before);
    before = now;
    if (!left--) return done(took);
    const { wide, high } = stage.size, k = frames - left;
    if (k < frames / 2) stage.camera.zoom(k % 50 < 25 ? 1.06 : 1 / 1.06, wide / 2, high / 2);
    else stage.camera.pan(9 * Math.sin(k / 9), 6 * Math.cos(k / 7));
    app.moved();
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
})"""
_PLAYS = """frames => new Promise(done => {
  const app = window.kerfwise, took = [];
  let before = 0, left = frames;
  app.set({ time_s: app.end() / 2, speed: 64, playing: true });
  const step = now => {
    if (before) took.push(now - before);
    before = now;
    if (!left--) { app.set({ playing: false }); return done(took); }
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
})"""
_SHARP = "document.querySelector('#stages canvas').dataset.sharp === 'true'"


def main() -> None:
    """Read the command line, print a row a size."""
    arguments = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    arguments.add_argument("contours", type=int, nargs="*", default=SIZES)
    arguments.add_argument("--into", type=Path, help="the page whose rows are renewed")
    given = arguments.parse_args()
    print(f"{HEAD}\n|{'---:|' * 8}")
    with tempfile.TemporaryDirectory() as folder, launched() as browser:
        for count in given.contours:
            nest = nest_of(count)
            file = Path(folder) / f"{count}.html"
            file.write_bytes(draw(nest, plan_of(nest), ".html"))
            put_row(_row(browser, file, len(nest.contours)), HEAD, given.into)


def _row(browser: Browser, file: Path, contours: int) -> str:
    page = browser.new_page(viewport={"width": 1400, "height": 900})
    page.goto(file.as_uri())
    while page.evaluate("document.documentElement.dataset.ready") != "yes" or not page.evaluate(_SHARP):
        page.wait_for_timeout(20)
    painted = int(page.evaluate("document.documentElement.dataset.painted"))
    moved, played = page.evaluate(_MOVES, FRAMES), page.evaluate(_PLAYS, FRAMES)
    held = memory_mb(page)
    page.close()
    slowest, slowest_played = (statistics.quantiles(took, n=20)[-1] for took in (moved, played))
    cells = (
        f"{contours:,}", f"{file.stat().st_size / 1e6:.2f}", f"{painted}", f"{statistics.median(moved):.1f}",
        f"{slowest:.1f}", f"{statistics.median(played):.1f}", f"{slowest_played:.1f}", f"{held:.0f}",
    )  # fmt: skip
    return f"| {' | '.join(cells)} |"


def memory_mb(page: Page) -> float:
    """What the page's scripts hold once garbage is collected; the pictures of the drawing are not counted."""
    tools = page.context.new_cdp_session(page)
    tools.send("HeapProfiler.collectGarbage")
    tools.send("Performance.enable")
    metrics = {one["name"]: one["value"] for one in tools.send("Performance.getMetrics")["metrics"]}
    return float(metrics["JSHeapUsedSize"]) / 1e6


def nest_of(contours: int) -> Nest:
    """A made nest of about so many contours, read without a check."""
    sheet = make_sheet(1, contours)
    parts = []
    for data in sheet["parts"]:
        name = data["id"]
        holes = (Contour(f"{name}.hole{k}", name, "hole", Curve.of(h)) for k, h in enumerate(data.get("holes", []), 1))
        parts.append(Part(name, Contour(f"{name}.outer", name, "outer", Curve.of(data["outer"])), tuple(holes)))
    size = sheet["sheet"]
    return Nest(Sheet.rectangle(size["width"], size["height"]), tuple(parts))


def plan_of(nest: Nest) -> Plan:
    """An order from left to right, holes before their part, in zones of some twelve parts."""
    parts = sorted(nest.parts, key=lambda part: (float(part.outer.curve.vertices[:, 0].min()), part.id))
    planned, now_s, here, idle_mm = [], 0.0, (0.0, 0.0), 0.0
    for place, part in enumerate(parts):
        for contour in part:
            x, y = contour.curve.start
            travel_mm = math.dist(here, (x, y))
            begin_s = now_s + travel_mm / 300
            now_s, idle_mm, here = begin_s + contour.curve.length_mm / 50, idle_mm + travel_mm, (x, y)
            cut = Cut(contour.id, here, "ccw", here, zone=place // 12 + 1, start_s=begin_s, end_s=now_s)
            planned.append(PlannedCut(cut, part.id, contour.kind, contour.curve.length_mm, ("from left to right",)))
    totals = Totals(sum(cut.length_mm for cut in planned), idle_mm, len(planned), now_s, 0.0)
    solve = SolveReport("none", "feasible", idle_mm, None, None, 0.0, 1)
    return Plan({"file": "made"}, {"name": "none"}, "left", "made", tuple(planned), totals, solve)


if __name__ == "__main__":
    main()
