"""What is asked of some of the contours alone, so that a stretch need not look through what is asked of all."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.problem import Problem, SoftGroup
from kerfwise.rules.statements import Lag


class ByContour:
    """The statements of a problem by contour."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._conditions: defaultdict[int, list[Condition]] = defaultdict(list)
        self._groups: defaultdict[int, list[SoftGroup]] = defaultdict(list)
        self._lags: defaultdict[int, list[Lag]] = defaultdict(list)
        rows = problem.crossings
        reached = np.append(problem.site_contour, problem.n)[rows.reach]
        self._rows = np.argsort(reached, kind="stable")
        self._row_from = np.searchsorted(reached[self._rows], np.arange(problem.n + 1))
        for condition in problem.conditions:
            self._conditions[condition.contour].append(condition)
        for group in problem.soft_groups:
            self._groups[group.contours[0]].append(group)
        for lag in problem.lags:
            for contour in (lag.first, lag.second):
                self._lags[contour].append(lag)

    def of(self, contours: Iterable[int]) -> Problem:
        """The problem with those conditions, soft groups and lags alone that are about some of these contours.

        Of soft groups those whose contours are all among them, of crossings those on the way to them.
        """
        chosen = dict.fromkeys(contours)
        kept = np.concatenate([self._rows[self._row_from[c] : self._row_from[c + 1]] for c in chosen])
        lags = {id(lag): lag for c in chosen for lag in self._lags[c]}
        return replace(
            self._problem,
            conditions=tuple(condition for c in chosen for condition in self._conditions[c]),
            soft_groups=tuple(g for c in chosen for g in self._groups[c] if chosen.keys() >= set(g.contours)),
            lags=tuple(lags.values()),
            crossings=self._problem.crossings.only(kept),
        )
