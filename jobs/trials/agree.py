"""Whether the halves of a rule admit the same plans: its statements, its violations and its text in MiniZinc."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .text import admitted_by_text
from .trial import PlanOf, Trial

STATED, JUDGED, WRITTEN = "its statements", "its violations", "its text in MiniZinc"


def against_violations(trials: Sequence[Trial]) -> Iterator[str]:
    """The first plan of each trial that the statements admit and the violations blame, or the other way round."""
    for trial in trials:
        stated = trial.admitted_by_statements()
        ends = trial.rule.allowances(trial.options) or (trial.options,)
        judged = [trial.admitted_by_violations(options) for options in ends]
        yield from differing(trial, STATED, stated, JUDGED, frozenset.intersection(*judged), frozenset.union(*judged))


def against_text(trials: Sequence[Trial]) -> Iterator[str]:
    """The first plan of each trial that the text in MiniZinc admits and the statements do not, or the other way round.

    Raises
    ------
    InputError
        If MiniZinc is not installed, or finds a mistake in the text.
    """
    for trial in trials:
        stated = trial.admitted_by_statements()
        yield from differing(trial, WRITTEN, admitted_by_text(trial), STATED, stated, stated)


def differing(
    trial: Trial, one: str, admitted: frozenset[PlanOf], other: str, least: frozenset[PlanOf], most: frozenset[PlanOf]
) -> Iterator[str]:
    """A line for each of the two ways to differ: with the first plan of it, and how many there are."""
    for who, not_who, plans in ((one, other, admitted - most), (other, one, least - admitted)):
        if plans:
            said = "admits" if who == WRITTEN else "admit"
            says_not = "does" if not_who == WRITTEN else "do"
            yield f"{who} {said} {trial.said(min(plans))}; {not_who} {says_not} not ({_like_it(len(plans))})"


def _like_it(count: int) -> str:
    return "the only such plan" if count == 1 else f"one of {count} such plans"
