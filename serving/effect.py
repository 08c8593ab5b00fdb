"""What other values of rules would bring on a nest: it is planned with them and without, with the same work."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from kerfwise.encoder.errors import RulesConflict
from kerfwise.jobs.checking import check_made
from kerfwise.jobs.given import Given
from kerfwise.jobs.listening import Listener, OnProgress
from kerfwise.jobs.main_job import plan_nest
from kerfwise.jobs.no_plan import NoPlan
from kerfwise.jobs.solve_options import options_for
from kerfwise.models.engines.solution import MEMORY_GB
from kerfwise.models.plan.plan import Plan

from .conflicts import first_told
from .edits import edited
from .figures import figures_of
from .wanted import Wanted, already_of, given_of

EFFECT_WORK = 1.0
"""Work for each of the two plans: a first look, that is proven only for small nests."""


@dataclass(frozen=True)
class _Planned:
    """A plan with the nest and profile it is of, or why there is none; `whole` where nobody has ended it early."""

    given: Given
    plan: Plan | None
    text: str = ""
    whole: bool = True


@dataclass
class Effects:
    """Plans with other values and without; the last one without is kept, for the next question is mostly of it."""

    heard: Callable[[], OnProgress]
    _before: tuple[str, _Planned] | None = field(default=None)

    def effect(
        self, wanted: Wanted, values: Sequence[tuple[str, str, str]], memory_gb: float = MEMORY_GB
    ) -> dict[str, Any]:
        """Figures `before` and `after` side by side, None where there is no plan, and then why, as `text`.

        Both have `breaches` by rule, as the profile before judges them: so it is seen what a rule that is switched off
        no longer forbids. `values` are rules, keys and values, as `with_rule_values` takes them.
        """
        before = self._planned_before(wanted, memory_gb)
        changes = [{"set": f"rules.{rule}.{key}", "to": value} for rule, key, value in values]
        text, _ = edited(wanted, before.given, changes)
        after = self._planned(replace(wanted, job_text=text), memory_gb)
        told = {"before": _figures(before.plan, before.given), "after": _figures(after.plan, before.given)}
        return told | {"text": "; ".join(one.text for one in (before, after) if one.text)}

    def _planned_before(self, wanted: Wanted, memory_gb: float) -> _Planned:
        if self._before is None or self._before[0] != wanted.key or not self._before[1].whole:
            self._before = wanted.key, self._planned(wanted, memory_gb)
        return self._before[1]

    def _planned(self, wanted: Wanted, memory_gb: float) -> _Planned:
        given = given_of(wanted)
        limits = options_for(given.nest, given.profile, work=EFFECT_WORK, memory_gb=memory_gb)
        listener = Listener(self.heard())
        try:
            done = plan_nest(given, limits, already=already_of(wanted, given), listener=listener)
        except NoPlan as no_plan:
            return _Planned(given, None, first_told(no_plan, given.job), whole=not listener.stopped)
        except RulesConflict as error:
            return _Planned(given, None, str(error))
        return _Planned(given, done.made.plan, whole=not listener.stopped)


def _figures(plan: Plan | None, judged_by: Given) -> dict[str, Any] | None:
    if plan is None:
        return None
    broken = {judged.id: len(judged.violations) for judged in check_made(judged_by, plan).rules if judged.violations}
    return {**figures_of(plan), "breaches": broken}
