"""Answers about a nest that are kept as long as the nest lives, and go with it."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar, cast

from .nest import Nest

Of = ParamSpec("Of")
AnswerT = TypeVar("AnswerT")


def kept_with_nest(
    most: int,
) -> Callable[[Callable[Concatenate[Nest, Of], AnswerT]], Callable[Concatenate[Nest, Of], AnswerT]]:
    """Has a function of a nest keep its last answers, `most` of them a nest, on the nest itself.

    The other arguments are given by position and are hashable.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import nest
    >>> @kept_with_nest(most=1)
    ... def size(plate, times):
    ...     print("asked")
    ...     return times * plate.sheet.polygon.area
    >>> plate = nest(30, 20)
    >>> size(plate, 1), size(plate, 1)
    asked
    (600.0, 600.0)
    """

    def keeping(function: Callable[Concatenate[Nest, Of], AnswerT]) -> Callable[Concatenate[Nest, Of], AnswerT]:
        @wraps(function)
        def answer(nest: Nest, /, *args: Of.args, **kwargs: Of.kwargs) -> AnswerT:
            assert not kwargs, "given by position, since answers are kept by position"
            answers = nest.kept.setdefault(function, OrderedDict())
            if args in answers:
                answers.move_to_end(args)
            else:
                answers[args] = function(nest, *args, **kwargs)
                if len(answers) > most:
                    answers.popitem(last=False)
            return cast(AnswerT, answers[args])

        return answer

    return keeping
