"""The Python side of `level_ahead.mzn`."""

from __future__ import annotations

from collections.abc import Set
from dataclasses import replace

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.rules.minizinc.twin import Fields, Twin, pairs_without
from kerfwise.rules.options.option import NoOptions


class LevelAheadTwin(Twin[NoOptions]):
    """Orders that are dropped leave the fact that they are stated over."""

    drops_orders = True

    def measured(self, nest: Nest, cuts: CutSequence, options: NoOptions) -> Fields:
        return []

    def without(self, facts: Facts, dropped: Set[tuple[int, int]]) -> Facts:
        return replace(facts, level_ahead=pairs_without(facts.level_ahead, dropped))
