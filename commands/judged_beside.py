"""The check of a plan of many contours, in a process of its own while the program is written and read back.

What the rules measure of the nest alone takes twice as long as to judge a plan by it, and is done while the plan is
made. Whatever goes wrong in the process, there is no verdict from it, and the plan is judged where it is asked for.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.process_beside import Beside, Hear
from kerfwise.models.plan.plan import Plan
from kerfwise.pipeline import Promise
from kerfwise.postproc.check import CheckResult, check_cuts
from kerfwise.postproc.verdict.check_plan import check_plan, handed_on, taken_over
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.registry import RULES

from .page_picture import is_worth_a_process


class JudgedBeside(Beside):
    """The verdict on a plan that is going to be made; its process begins and ends with the context.

    Rules of the plant, which may do anything, and temperatures, which are simulated, are left to the process that asks.
    """

    def __init__(self, nest: Nest, profile: Profile) -> None:
        super().__init__(_judge, nest, profile)
        self._nest, self._profile = nest, profile
        shipped = all(RULES.get(name) is rule for name, rule in profile.rulebook().items())
        self.pays = is_worth_a_process(nest) and shipped and profile.temperature_limit() is None

    def begin(self, plan: Plan) -> Promise | None:
        """Judge a plan; what comes of it is asked for later."""
        if not self.tell(plan):
            return None

        def verdict() -> CheckResult | None:
            answer = self.answer()
            return None if answer is None else taken_over(answer, self._nest, plan, self._profile)

        return verdict


def _judge(hear: Hear, nest: Nest, profile: Profile) -> Iterator[object]:
    """What the process does."""
    with contextlib.suppress(Exception):  # of no cuts nothing is found, but what is measured of the nest stays with it
        check_cuts(nest, CutSequence(()), profile)
    yield handed_on(check_plan(nest, hear(), profile))
