"""Many tasks side by side: what all of them ask for next is answered in one go, as the geometry library likes it."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Sequence
from typing import Any, TypeVar

DoneT = TypeVar("DoneT")

Many = Callable[[Sequence[Any]], Iterable[Any]]
"""Answers many questions at once, each by itself."""
Asking = Generator[tuple[Many, Any], Any, DoneT]
"""A task that yields who answers and what it asks, and is sent the answer."""


def all_asked(tasks: Sequence[Asking[DoneT]]) -> list[DoneT]:
    """What every task comes to.

    Examples
    --------
    >>> def squares(numbers):
    ...     return [k * k for k in numbers]
    >>> def fourth_power(k):
    ...     square = yield squares, k
    ...     return (yield squares, square)
    >>> all_asked([fourth_power(2), fourth_power(3)])
    [16, 81]
    """
    done: dict[int, DoneT] = {}
    answers: dict[int, Any] = dict.fromkeys(range(len(tasks)))
    while answers:
        asked: dict[Many, dict[int, Any]] = {}
        for k, answer in answers.items():
            try:
                many, question = tasks[k].send(answer)
            except StopIteration as end:
                done[k] = end.value
            else:
                asked.setdefault(many, {})[k] = question
        answers = {}
        for many, questions in asked.items():
            answers |= dict(zip(questions, many(list(questions.values())), strict=True))
    return [done[k] for k in range(len(tasks))]
