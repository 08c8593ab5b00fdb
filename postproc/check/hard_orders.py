"""The orders that the hard rules ask for, by their own geometry, as numbers: large nests have hundreds of thousands."""

from __future__ import annotations

from functools import cached_property
from itertools import chain

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import RuleSetting

from .each_torch import asked_of, torch_of_each


class HardOrders:
    """Pairs of contours, the first of which must be cut before the second, of every hard rule of a profile.

    Contours are numbered as in `names`: those that are cut come first, in the order of their cuts.
    """

    def __init__(self, nest: Nest, cuts: CutSequence, profile: Profile) -> None:
        self.nest, self.cuts, self.profile = nest, cuts, profile

    @cached_property
    def hard(self) -> dict[str, RuleSetting]:
        """The hard rules."""
        return {rule: s for rule, s in self.profile.settings().items() if s.strength == "hard"}

    @cached_property
    def names(self) -> list[str]:
        """Contour ids by number: those that are cut, and behind them others that orders name."""
        _ = self.by_rule
        return list(self._number)

    @cached_property
    def at(self) -> Ints:
        """The position of each contour's cut, from 1 on; 0 where it is not cut."""
        at = self.cuts.positions()
        return np.fromiter((at.get(name, 0) for name in self.names), np.int64, len(self.names))

    @cached_property
    def by_rule(self) -> dict[str, Ints]:
        """Rule → the orders that it asks for, (k, 2) numbers."""
        book, torches = self.profile.rulebook(), torch_of_each(self.cuts)
        found = {}
        for name, setting in self.hard.items():
            rule = book[name]
            pairs = list(rule.pairs(self.nest, self.cuts, setting.options))
            if torches and rule.of_each_torch:
                pairs = [pair for pair in pairs if asked_of(rule, pair, torches)]
            numbers = map(self._number.__getitem__, chain.from_iterable(pairs))
            found[name] = np.fromiter(numbers, np.int64, 2 * len(pairs)).reshape(-1, 2)
        return found

    def of_cut(self) -> tuple[Ints, list[str]]:
        """The orders between contours that are cut, each once, (k, 2), and the rule of each: the firmest that asks."""
        book = self.profile.rulebook()
        rules, size = sorted(self.hard, key=lambda name: book[name].gives_way), len(self.cuts.positions())
        pairs = np.concatenate([np.empty((0, 2), np.int64), *(self.by_rule[name] for name in rules)])
        rule = np.repeat(np.arange(len(rules)), [len(self.by_rule[name]) for name in rules])
        cut = np.flatnonzero((pairs < size).all(axis=1))
        _, first = np.unique(pairs[cut, 0] * size + pairs[cut, 1], return_index=True)
        kept = cut[np.sort(first)]
        return pairs[kept], [rules[k] for k in rule[kept].tolist()]

    @cached_property
    def _number(self) -> _Numbers:
        return _Numbers({name: k for k, name in enumerate(self.cuts.positions())})


class _Numbers(dict[str, int]):
    """Numbers of names; a new name has the next one."""

    def __missing__(self, name: str) -> int:
        self[name] = number = len(self)
        return number
