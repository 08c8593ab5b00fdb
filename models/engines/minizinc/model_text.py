"""The main model: the sequence, what is asked of it, and what a plan costs."""

from __future__ import annotations

from collections.abc import Sequence

from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.rules.minizinc.twin import MODELS
from kerfwise.rules.statements import EXEMPTION_MM

from .asked import AskedArray, include

GOAL = "solve :: tightest_first :: restart_luby(250) minimize besides + excuse * excuses;"


def model_text(asked: Sequence[AskedArray], goal: str = GOAL) -> str:
    """MiniZinc text that states what is asked, hard or at its price.

    Examples
    --------
    >>> asked = [AskedArray('include "a.mzn";', "a_holds", None), AskedArray('include "b.mzn";', "b_holds", 0.5)]
    >>> print(model_text(asked).partition("sequence.mzn")[2])  # doctest: +ELLIPSIS
    ";
    include "a.mzn";
    include "b.mzn";
    <BLANKLINE>
    % Hard: every statement holds.
    constraint forall(a_holds);
    <BLANKLINE>
    % Soft: what each breach costs, in µm of idle travel.
    var int: besides :: add_to_output;
    constraint besides = idle_travel + 500 * breaches(b_holds);
    ...
    """
    hard = [a for a in asked if a.weight_mm is None]
    excused = [a for a in asked if a.weight_mm == EXEMPTION_MM and not a.most_ms]
    soft = [a for a in asked if a not in hard and a not in excused]
    return "\n".join(
        [
            include(MODELS / "sequence.mzn"),
            *dict.fromkeys(a.source for a in asked),
            "",
            "% Hard: every statement holds.",
            *(_constraint(a) for a in hard if a.name),
            "",
            "% Soft: what each breach costs, in µm of idle travel.",
            "var int: besides :: add_to_output;",
            _sum("constraint besides", "idle_travel", [_cost(a) for a in soft]),
            "",
            "% Hard, but excused where nothing else is left; an excuse costs more than any plan does besides.",
            "var int: excuses :: add_to_output;",
            _sum("constraint excuses", "0", [f"breaches({a.name})" for a in excused]),
            _sum("int: excuse", "1 + longest_travel", [_most(a) for a in soft]),
            "",
            goal,
            "",
        ]
    )


def _constraint(a: AskedArray) -> str:
    return f"constraint forall(ms in {a.name})(ms = 0);" if a.most_ms else f"constraint forall({a.name});"


def _cost(a: AskedArray) -> str:
    """What an array of a soft rule costs: a price for each breach, or for each millisecond that is missing."""
    return f"{_price(a)} * {'sum' if a.most_ms else 'breaches'}({a.name})"


def _most(a: AskedArray) -> str:
    """What it can cost at most."""
    return f"{_price(a) * (a.most_ms or 1)} * length({a.name})"


def _price(a: AskedArray) -> int:
    weight_mm = a.weight_mm or 0.0
    return round(weight_mm) if a.most_ms else round(weight_mm * UM_PER_MM)


def _sum(declared: str, first: str, terms: Sequence[str]) -> str:
    return f"{declared} = {' + '.join([first, *terms])};"
