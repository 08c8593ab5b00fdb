"""All that a plant's rule in Python needs: `from kerfwise.rule_kit import …`.

What stands here stays: other modules of kerfwise may move, and what they hold may change its name. A rule that imports
from here alone goes on working. `kerfwise rules new NAME --python` writes such a rule, and docs/rule-kit.md lists what
there is.

Examples
--------
>>> from kerfwise.rule_kit import Case, in_order, nest, part, rect
>>> plate = nest(300, 100, part("A", rect(10, 10, 60, 60)), part("B", rect(90, 10, 60, 60)))
>>> in_order(plate, "B.outer A.outer").positions()
{'B.outer': 1, 'A.outer': 2}
"""

from __future__ import annotations

from kerfwise.encoder.candidates.candidate import Candidate, LeadOptions
from kerfwise.encoder.cut import Cut, CutSequence, Direction, Side
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.facts import Column, FactOptions, Facts
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Ids, Kind, Nest, Part, Sheet
from kerfwise.rules.case import Case, circle, cut, in_order, nest, part, rect
from kerfwise.rules.judging.metal import host_holes, places
from kerfwise.rules.options.kind import Choice, Flag, Number, Text
from kerfwise.rules.options.option import NoOptions, option
from kerfwise.rules.options.quantities import DURATION, ENERGY, LENGTH, LENGTH_BY_THICKNESS, SPEED, TEMPERATURE, OrWord
from kerfwise.rules.rule import (
    Forced,
    NoGoodIds,
    OrderRule,
    Plant,
    Rule,
    RuleSetting,
    Strength,
    TemperatureLimit,
    Violation,
)
from kerfwise.rules.statements import (
    About,
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Enough,
    Forbid,
    Lag,
    Move,
    NoGood,
    Pick,
    Precede,
    Statement,
    Steps,
)

__all__ = [
    "DURATION",
    "ENERGY",
    "LENGTH",
    "LENGTH_BY_THICKNESS",
    "SPEED",
    "TEMPERATURE",
    "About",
    "AtLeast",
    "Before",
    "Candidate",
    "Case",
    "Choice",
    "Column",
    "Contiguous",
    "Contour",
    "Crossing",
    "Curve",
    "Cut",
    "CutSequence",
    "Direction",
    "Enough",
    "FactOptions",
    "Facts",
    "Flag",
    "Forbid",
    "Forced",
    "Ids",
    "InputError",
    "Kind",
    "Lag",
    "LeadOptions",
    "Move",
    "Nest",
    "NoGood",
    "NoGoodIds",
    "NoOptions",
    "Number",
    "OrWord",
    "OrderRule",
    "Part",
    "Pick",
    "Plant",
    "Point",
    "Precede",
    "Rule",
    "RuleSetting",
    "Sheet",
    "Side",
    "Statement",
    "Steps",
    "Strength",
    "TemperatureLimit",
    "Text",
    "Violation",
    "circle",
    "cut",
    "host_holes",
    "in_order",
    "nest",
    "option",
    "part",
    "places",
    "rect",
]
