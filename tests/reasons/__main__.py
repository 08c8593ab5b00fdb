"""Plans the golden corpus and proves the reasons of its plans: what each sentence names is taken away.

Usage: python -m kerfwise.tests.reasons [--most N] [--seconds S] [CASE…]

Each sentence of a plan about where a contour is cut is judged by arithmetic that shares nothing with what made it
(`judge.py`). Prints how many of which kind there were, and every false one; exit code 1 if there is one.
"""

from __future__ import annotations

import argparse
import fnmatch
import sys
import time
from collections import Counter
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import replace

from kerfwise import pipeline
from kerfwise.encoder.facts.facts import Facts
from kerfwise.jobs.request import facts_of
from kerfwise.models.plan.explain.alternatives import PositionCosts, explain_entry
from kerfwise.models.plan.explain.context import PlanContext
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.stating.lazy_statements import lazy_statements
from kerfwise.tests.golden.run import cases, run
from kerfwise.tests.reasons.entries import entry_verdicts
from kerfwise.tests.reasons.judge import Judge, Verdict, kind

ENTRIES_OF = 8
"""Of so many contours of a plan the other entries are judged."""


def main(argv: list[str] | None = None) -> int:
    """Judge the reasons of the cases that are named, or of all; the exit code."""
    parser = argparse.ArgumentParser(prog="python -m kerfwise.tests.reasons", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("cases", nargs="*", metavar="CASE", help="a case of the golden corpus, or a pattern; else all")
    parser.add_argument("--most", type=int, default=1000, help="reasons that are judged (default 1000)")
    parser.add_argument("--contours", type=int, default=60, help="of the largest plan that is judged (default 60)")
    given = parser.parse_args(argv)
    chosen = [n for n in cases() if not given.cases or any(fnmatch.fnmatch(n, p) for p in given.cases)]
    count, false, plans, began = Counter[str](), list[Verdict](), 0, time.perf_counter()
    for name in chosen:
        with recorded() as made:
            run(name, cases()[name])
        for plan, setting in made:
            if count.total() >= given.most or len(plan.cuts) > given.contours:
                continue
            plans += 1
            for verdict in judged(plan, setting):
                count[kind(verdict.sentence)] += 1
                if verdict.wrong:
                    false.append(verdict)
                    print(f"{name}: {verdict.contour}: {verdict.sentence}\n    FALSE: {verdict.wrong}", flush=True)
    told = ", ".join(f"{number} {what}" for what, number in sorted(count.items()))
    print(f"{plans} plans, {count.total()} reasons: {told}; {len(false)} false ({time.perf_counter() - began:.0f} s)")
    return 1 if false else 0


@contextmanager
def recorded() -> Iterator[list[tuple[Plan, PlanContext]]]:
    """The plans that are made meanwhile, each with what it was made of."""
    made: list[tuple[Plan, PlanContext]] = []
    tells = pipeline.with_reasons

    def told(plan: Plan, setting: PlanContext) -> Plan:
        plan = tells(plan, setting)
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
