"""Plans, writes, checks and draws one plate, and tells the processor seconds of every phase.

Usage: python benchmarks/phase_clock.py CONTOURS [--work W] [--minutes M] [--first]

The plate is made by examples/gen_sheet.py, seed 1. Prints one line of JSON. `phases.py` runs this file for each
checkout with the package of that one, so nothing of the benchmarks is imported here. A picture that is drawn in a
process of its own, beside the check, counts for the picture by the seconds of that process's processor.
"""

from __future__ import annotations

import argparse
import gc
import importlib
import importlib.util
import json
import math
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from typing import Any

from kerfwise.examples.gen_sheet import contour_count, make_sheet
from kerfwise.pipeline import Watchers

PHASES: dict[str, tuple[tuple[str, str], ...]] = {
    "read": (("kerfwise.encoder.readers.json_nest", "read_json"),),
    "candidates": (("kerfwise.jobs.request", "_with_ways_along"),),
    "facts": (("kerfwise.jobs.request", "compute_facts"), ("kerfwise.jobs.request", "contour_heat_kj")),
    "rules": (("kerfwise.jobs.request", "state_rules"),),
    "problem": (("kerfwise.models.engines.solve", "make_problem"), ("kerfwise.models.engines.solve", "simplify")),
    "planning": (("kerfwise.models.engines.solve", "run_portfolio"),),
    "looks at whole orders": (),
    "plan and its reasons": (
        ("kerfwise.pipeline", "make_plan"),
        ("kerfwise.pipeline", "with_reasons"),
        ("kerfwise.jobs.gantry", "with_times"),
    ),
    "program": (("kerfwise.pipeline", "write_program"),),
    "check": (
        ("kerfwise.pipeline", "check_plan"),
        ("kerfwise.pipeline", "check_written"),
        ("kerfwise.pipeline", "judge"),
    ),
    "picture": (("kerfwise.postproc.report", "draw"),),
}
"""Phase → the functions it is made by, where they are called from; what is called within one counts there only."""
LOOK_S = 0.5
"""How often a process looks at whether it has taken too long."""
REST, ALL, BUT_PLANNING, MEMORY = "all else", "all", "all but planning", "memory, MB"
BY_CLOCK = "all but planning, by the clock"
"""Seconds that go by meanwhile: what is done side by side counts once, and what other programs take counts too."""
STARTED, JUDGED, AFTER = (
    "start and imports",
    "program judged, after reading, by the clock",
    "picture drawn, by the clock",
)
"""Of a first plan: what is taken before the nest is read, numba included, and what goes by from then on."""


class Clock:
    """Processor seconds by phase; a phase within a phase counts for itself alone."""

    def __init__(self) -> None:
        self.seconds = dict.fromkeys(PHASES, 0.0)
        self._running: list[str] = []
        self._begun: list[str] = []
        self._since_s = time.process_time()
        self.clock_s = dict.fromkeys(PHASES, 0.0)
        """The same by the clock."""
        self._since_clock_s = time.perf_counter()

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Count for a phase."""
        self._turn()
        self._running.append(name)
        self._begun.append(name)
        try:
            yield
        finally:
            self._turn()
            self._running.pop()

    def _turn(self) -> None:
        now_s, now_clock_s = time.process_time(), time.perf_counter()
        if self._running:
            self.seconds[self._running[-1]] += now_s - self._since_s
            self.clock_s[self._running[-1]] += now_clock_s - self._since_clock_s
        self._since_s, self._since_clock_s = now_s, now_clock_s

    def so_far(self) -> tuple[dict[str, float], list[str], list[str]]:
        """Seconds of every phase up to now, those that are running, and those that were never begun."""
        self._turn()
        return dict(self.seconds), list(self._running), [name for name in PHASES if name not in self._begun]

    def around(self, name: str, step: Callable[..., Any]) -> Callable[..., Any]:
        """The same function, counted."""

        def run(*given: Any, **options: Any) -> Any:
            if threading.current_thread() is not threading.main_thread():
                return self._beside(name, lambda: step(*given, **options))
            with self.phase(name):
                return step(*given, **options)

        return run

    def _beside(self, name: str, step: Callable[[], Any]) -> Any:
        """What a thread finds beside another phase, whose seconds these are not."""
        began_s = time.thread_time()
        try:
            return step()
        finally:
            took_s = time.thread_time() - began_s
            self.seconds[name] += took_s
            if self._running:
                self.seconds[self._running[-1]] -= took_s


def spent(
    contours: int, work: float, told: Callable[[dict[str, Any]], None], most_s: float = math.inf, first: bool = False
) -> None:
    """Plan, write, check and draw one plate in this process; tell processor seconds by phase, and the memory.

    Of a `first` plan all counts from the start of the process on. After `most_s` of the processor that is told and the
    process ended; `running` and `missing` are then the phases that it was in, and those that it never began.
    """
    from kerfwise.apps.bench.bench_child import peak_mb
    from kerfwise.encoder.readers import ReadOptions
    from kerfwise.jobs.by_engine import Method
    from kerfwise.jobs.inputs import Inputs
    from kerfwise.jobs.request import options_for
    from kerfwise.pipeline import plan_nest
    from kerfwise.rules.profile.load import load_profile

    text = json.dumps(make_sheet(1, contours)).encode()
    gc.disable()  # as `solve` does
    if first:
        importlib.import_module("kerfwise.commands.solve")
        importlib.import_module("kerfwise.jobs.warm_up").search_beside(contours)  # loads numba, as `solve` does
    profile, started_s = load_profile(), time.process_time()
    clock = Clock()
    for name, steps in PHASES.items():
        for module, step in steps:
            place = importlib.import_module(module)
            if hasattr(place, step):
                setattr(place, step, clock.around(name, getattr(place, step)))
    _around_looks(clock)
    began_s, began_clock_s = time.process_time(), time.perf_counter()

    def tell(ended: bool) -> None:
        seconds, running, missing = clock.so_far()
        took = os.times()
        beside_s = took.children_user + took.children_system  # of processes of this one that have ended
        seconds["picture"] += beside_s
        whole_s = time.process_time() - began_s + beside_s
        sums = {REST: whole_s - sum(seconds.values()), ALL: whole_s, BUT_PLANNING: whole_s - seconds["planning"]}
        by_clock = {BY_CLOCK: time.perf_counter() - began_clock_s - clock.clock_s["planning"]}
        most = {MEMORY: peak_mb()}
        if first:
            sums[ALL] += started_s
            most |= {STARTED: started_s, JUDGED: judged_s - read_s, AFTER: time.perf_counter() - read_s}
        told({**seconds, **sums, **by_clock, **most, "ended": ended, "running": running, "missing": missing})

    read_s = judged_s = began_clock_s
    nest = importlib.import_module("kerfwise.encoder.readers.json_nest").read_json(text, ReadOptions())
    read_s, limits = time.perf_counter(), options_for(nest, profile, work=work)
    home = profile.home_on(nest)
    with _beside(nest, home) as beside, _judged_beside(nest, profile) as judging:

        def planned(plan: Any) -> Any:
            promise = None if judging is None else judging.begin(plan)
            if beside is not None:
                beside.begin(plan)
            return promise

        # started here, as processes are forked where there is one thread
        threading.Thread(target=_end_after, args=(began_s + most_s, tell), daemon=True).start()
        watchers = Watchers(planned=planned)
        made = plan_nest(Inputs(nest, profile), limits, Method(first=first), watchers).made
        judged_s = time.perf_counter()
        if not made.verdict.ok:
            raise SystemExit("the check refuses the plan")
        with clock.phase("picture"):
            picture = None if beside is None else beside.end(made.plan)
        if picture is None:
            importlib.import_module("kerfwise.postproc.report").draw(nest, made.plan, ".svg", home)
    tell(False)


def _beside(nest: Any, home: tuple[float, float]) -> Any:
    """A picture drawn beside the check, as `kerfwise solve` does it, by checkouts that do."""
    if importlib.util.find_spec("kerfwise.commands.page_picture") is None:
        return nullcontext()
    return importlib.import_module("kerfwise.commands.page_picture").DrawnBeside(nest, ".svg", home)


def _judged_beside(nest: Any, profile: Any) -> Any:
    """A plan judged beside the writing of its program, likewise."""
    if importlib.util.find_spec("kerfwise.commands.judged_beside") is None:
        return nullcontext()
    return importlib.import_module("kerfwise.commands.judged_beside").JudgedBeside(nest, profile)


def _end_after(most_s: float, tell: Callable[[bool], None]) -> None:
    """End the process once it has taken so many seconds of the processor."""
    while time.process_time() < most_s:
        time.sleep(LOOK_S)
    tell(True)
    sys.stdout.flush()
    os._exit(0)


def _around_looks(clock: Clock) -> None:
    """Count what rules that judge a whole order find wrong with those that are tried."""
    plain: Any = importlib.import_module("kerfwise.pipeline").lazy_statements

    def counted(*given: Any) -> Callable[..., Any]:
        return clock.around("looks at whole orders", plain(*given))

    for name in ("kerfwise.pipeline", "kerfwise.jobs.plan_without_zones"):
        vars(importlib.import_module(name))["lazy_statements"] = counted


def main() -> None:
    """Print the line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("contours", type=int)
    parser.add_argument("--work", type=float, default=2.0)
    parser.add_argument("--minutes", type=float, default=math.inf)
    parser.add_argument("--first", action="store_true")
    given = parser.parse_args()
    contours = contour_count(make_sheet(1, given.contours))

    def tell(told: dict[str, Any]) -> None:
        print(json.dumps(told | {"contours": contours}))

    spent(given.contours, given.work, tell, 60 * given.minutes, given.first)


if __name__ == "__main__":
    main()
