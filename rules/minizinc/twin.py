"""What stands beside a rule's model file: the data it reads, and what else of the rule MiniZinc must be told."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Generic, TypeVar

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.minizinc_data import Fields
from kerfwise.encoder.nest import Nest

from . import __path__ as _path

MODELS = Path(_path[0])
"""The files that the rules' model files stand on."""
CATALOGUE = MODELS.parent / "catalogue"
"""A folder for each rule, which has its model file."""
OptionsT = TypeVar("OptionsT")


@dataclass(frozen=True, slots=True)
class TwinCase:
    """One nest under one profile; `linked` are moves (from, to) with the torch on, by candidates counted from 1."""

    facts: Facts
    home_mm: Point
    linked: tuple[tuple[int, int], ...] = ()


@dataclass(frozen=True, slots=True)
class Further:
    """An array that a rule asks for beside `<rule>_holds`: its model file, its name and the price of each breach.

    With `most_ms` it is of milliseconds that are missing, at most so many each, and the price is that of a second.
    """

    file: Path
    name: str
    weight_mm: float | None
    most_ms: int = 0


class Twin(Generic[OptionsT]):
    """The Python side of a rule's model file; a rule whose file reads facts alone needs none.

    What the check cannot know of, by `measured`, no other file can read in the rule's place.
    """

    def of_nest(self, nest: Nest, options: OptionsT) -> Fields:
        """Names and values of what the file reads beside the facts, where facts and check have it from the nest."""
        return []

    def data(self, case: TwinCase, options: OptionsT) -> Fields:
        """Names and values of what the file reads beside the facts: the options, and what only this rule looks at."""
        return self.of_nest(case.facts.nest, options)

    def measured(self, nest: Nest, cuts: CutSequence, options: OptionsT) -> Fields:
        """The same for the check, which measures it from the nest and the cuts."""
        return self.of_nest(nest, options)

    def further(self, options: OptionsT, weight_mm: float | None) -> Iterable[Further]:
        """Arrays beside `<rule>_holds`; `weight_mm` is that of the rule, None where it is hard."""
        return ()


def rule_file(rule: str) -> Path:
    """The model file that states the rule of that id, whether there is one or not."""
    return CATALOGUE / _name(rule) / f"{_name(rule)}.mzn"


@cache
def twin_of(rule: str) -> Twin[Any]:
    """The Python side of that model file: the one class in the module of the same name, if there is one.

    Examples
    --------
    >>> type(twin_of("heat-lag")).__name__, type(twin_of("zone-order")).__name__
    ('HeatLagTwin', 'Twin')
    """
    if not (CATALOGUE / _name(rule) / "model_data.py").is_file():
        return Twin()
    module = importlib.import_module(f"kerfwise.rules.catalogue.{_name(rule)}.model_data")
    (cls,) = (
        cls
        for _, cls in inspect.getmembers(module, inspect.isclass)
        if issubclass(cls, Twin) and cls.__module__ == module.__name__
    )
    return cls()


def _name(rule: str) -> str:
    return rule.replace("-", "_")
