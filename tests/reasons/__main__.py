"""Plans the golden corpus and proves the reasons of its plans: what each sentence names is taken away.

Usage: python -m kerfwise.tests.reasons [--most N] [--counts FILE] [CASE…]

Each sentence of a plan about where a contour is cut is judged by arithmetic that shares nothing with what made it
(`judge.py`). Prints after each case how many there were, every false one, and at the end how many of which kind; exit
code 1 if one is false.
"""

from __future__ import annotations

import argparse
import fnmatch
import json
import sys
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from kerfwise import Plan, pipeline
from kerfwise.jobs.request import facts_of
from kerfwise.models.plan.explain.alternatives import PositionCosts, explain_entry
from kerfwise.models.plan.explain.context import PlanContext
from kerfwise.rule_kit import Facts
from kerfwise.rules.stating.lazy_statements import lazy_statements
from kerfwise.tests.golden.run import cases, run
from kerfwise.tests.reasons.entries import entry_verdicts
from kerfwise.tests.reasons.judge import Judge, Verdict, kind

SUMS = ("plans", "reasons", "false")
ENTRIES_OF = 8
"""Of so many contours of a plan the other entries are judged."""


def main(argv: list[str] | None = None) -> int:
    """Judge the reasons of the cases that are named, or of all; the exit code."""
    parser = argparse.ArgumentParser(prog="python -m kerfwise.tests.reasons", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("cases", nargs="*", metavar="CASE", help="a case of the golden corpus, or a pattern; else all")
    parser.add_argument(
        "--most", type=int, default=1000, help="once so many are judged no further case is planned (default 1000)"
    )
    parser.add_argument("--contours", type=int, default=60, help="of the largest plan that is judged (default 60)")
    parser.add_argument(
        "--counts", type=Path, metavar="FILE", help="where counts by case are kept: cases in it are not run again"
    )
    given = parser.parse_args(argv)
    chosen = [n for n in cases() if not given.cases or any(fnmatch.fnmatch(n, p) for p in given.cases)]
    kept: dict[str, dict[str, int]] = {}
    if given.counts and given.counts.exists():
        kept = json.loads(given.counts.read_text(encoding="utf-8"))
    for name in chosen:
        if name in kept or _all_of(kept)["reasons"] >= given.most:
            continue
        kept[name] = _case(name, given.contours)
        if given.counts:
            given.counts.write_text(json.dumps(kept, indent=1), encoding="utf-8")
    count = _all_of(kept)
    told = ", ".join(f"{n} {what}" for what, n in sorted(count.items()) if what not in SUMS)
    print(f"{count['plans']} plans, {count['reasons']} reasons: {told}; {count['false']} false")
    return 1 if count["false"] else 0


def _all_of(kept: dict[str, dict[str, int]]) -> Counter[str]:
    return sum(map(Counter, kept.values()), Counter[str]())


def _case(name: str, contours: int) -> dict[str, int]:
    """What there is of each kind in the plans of a case, told as soon as it is known."""
    count, began = Counter[str](), time.perf_counter()
    with recorded() as made:
        run(name, cases()[name])
    for plan, setting in made:
        if len(plan.cuts) > contours:
            continue
        count["plans"] += 1
        for verdict in judged(plan, setting):
            count["reasons"] += 1
            count[kind(verdict.sentence)] += 1
            if verdict.wrong:
                count["false"] += 1
                print(f"{name}: {verdict.contour}: {verdict.sentence}\n    FALSE: {verdict.wrong}", flush=True)
    seconds = time.perf_counter() - began
    print(
        f"{name}: {count['plans']} plans, {count['reasons']} reasons, {count['false']} false ({seconds:.0f} s)",
        flush=True,
    )
    return dict(count)


@contextmanager
def recorded() -> Iterator[list[tuple[Plan, PlanContext]]]:
    """The plans that are made meanwhile, each with what it was made of."""
    made: list[tuple[Plan, PlanContext]] = []
    tells = pipeline.with_reasons

    def told(plan: Plan, setting: PlanContext, going: Callable[[], bool]) -> Plan:
        plan = tells(plan, setting, going)
        made.append((plan, setting))
        return plan

    pipeline.with_reasons = told
    try:
        yield made
    finally:
        pipeline.with_reasons = tells


def judged(plan: Plan, setting: PlanContext) -> Iterator[Verdict]:
    """Every sentence of a plan about where a contour is cut."""
    facts = setting.facts
    home, order = setting.profile.home_on(facts.nest), setting.order

    def later() -> set[tuple[str, str]]:
        look, found = lazy_statements(facts, setting.profile), set[tuple[str, str]]()
        for k, contour in enumerate(order):
            rest = [*order[:k], *order[k + 1 :]]
            for slot in range(len(order)):
                found |= {(s.about.rule, s.about.sentence) for s in look([*rest[:slot], contour, *rest[slot:]])}
        return found

    judge = Judge(facts, setting.stated.statements, setting.candidates, home, later)
    if judge.timed:  # seconds are not worked out here
        return
    for cut in plan.cuts:
        yield from judge.verdicts(facts.nest.index[cut.cut.contour], cut.because)
    if setting.profile.machine.torches.several or facts.already_cut:  # copies have entries in common; metal is cut
        return
    along, offered = PositionCosts(setting), dict[tuple[str, ...], Facts]()
    for contour in setting.order[:: max(1, len(setting.order) // ENTRIES_OF)]:

        def ways_round(rules: Collection[str], contour: int = contour) -> set[str]:
            off = tuple(rules)
            if off not in offered:
                settings = {
                    **setting.profile.rules,
                    **{name: replace(setting.profile.rules[name], strength="off", weight=None) for name in off},
                }
                offered[off] = facts_of(facts.whole_nest, replace(setting.profile, rules=settings))
            made = offered[off]
            number = made.nest.index[facts.nest.contours[contour].id]
            return {made.candidates[c].direction for c in made.candidates_of(number)}

        yield from entry_verdicts(judge, contour, explain_entry(along, contour), ways_round)


if __name__ == "__main__":
    sys.exit(main())
