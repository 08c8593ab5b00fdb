"""Routes as timed paths: where the torch burns, and when, by the plan that would be made of a route and its clock."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from kerfwise.encoder.cut import Cut
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.physics.heat.timed_path import TimedPath, TorchOn
from kerfwise.models.physics.motion import Motion
from kerfwise.models.physics.time_and_cost import motion_of
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import Statement, by_kind
from kerfwise.rules.stating.state_rules import Stated

from .gantry import completed
from .heat_path import path_of_plan

_NOTHING_ASKED = Stated((), ())
_LIMITS = SolveOptions(work=1.0)
"""Of the way through the holes of a pierce pass."""


class RoutePaths:
    """The torch's paths by routes of candidates.

    Parameters
    ----------
    facts, profile
        The nest with its candidates, and how it is cut.
    stated
        Its rules, which say what may be linked.
    """

    def __init__(self, facts: Facts, profile: Profile, stated: Stated) -> None:
        self._facts, self._profile = facts, profile
        kinds = by_kind(stated.statements)
        links: tuple[Statement, ...] = (*kinds.link, *kinds.idle_travel, *kinds.lag) if kinds.link else ()
        self._linked = Stated(links, ())
        self._alone: dict[int, tuple[Cut, tuple[TorchOn, ...], Motion]] = {}

    def of(self, route: Sequence[int]) -> TimedPath:
        """The path of candidates cut in this order, as a simulation of their plan has it.

        A contour with a bevel is burnt once, as it is drawn, in the time of all its passes.
        """
        return self._path(self._plan(route, self._linked))

    def burn(self, number: int, now_s: float, at: Point) -> tuple[tuple[TorchOn, ...], float]:
        """What one candidate burns that is cut next, the torch being at a point at a time; and when it is done.

        At the feed of a whole program with it. Nothing is burnt for a mark, and over tabs.
        """
        if number not in self._alone:
            self._alone[number] = self._first(number)
        cut, burns, motion = self._alone[number]
        later_s = now_s + motion.travel_s(math.dist(at, cut.pierce)) - cut.start_s
        return tuple(replace(burn, at_s=burn.at_s + later_s) for burn in burns), cut.end_s + later_s

    def _first(self, number: int) -> tuple[Cut, tuple[TorchOn, ...], Motion]:
        """A candidate's cut as the first of a program with all contours, what it burns, and how the machine moves."""
        facts, own = self._facts, self._facts.candidates[number].contour
        others = [int(first) for contour, first in enumerate(facts.first[:-1]) if contour != own]
        plan = self._plan([number, *others], _NOTHING_ASKED)
        name = facts.nest.contours[own].id
        cut = next(planned.cut for planned in plan.burns if planned.cut.contour == name)
        burns = tuple(burn for burn in self._path(plan).burns if burn.contour == name and burn.at_s[0] >= cut.start_s)
        return cut, burns, motion_of(self._profile, 0 if plan.time is None else plan.time.nc_blocks)

    def _plan(self, route: Sequence[int], stated: Stated) -> Plan:
        solution = Solution(tuple(route), 0.0, None, "feasible", "", "", 0.0)
        plan = make_plan(self._facts, self._profile, stated, solution, "portfolio", _LIMITS.seed)
        return completed(plan, self._facts, self._profile, stated, solution, _LIMITS)

    def _path(self, plan: Plan) -> TimedPath:
        return path_of_plan(plan, self._facts.whole_nest, self._profile, along_contours=True)
