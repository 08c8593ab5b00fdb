"""What a judge says of a rule that is broken, in contour ids; statements have no part in it."""

from __future__ import annotations

from dataclasses import dataclass, field

from kerfwise.encoder.nest import Ids


@dataclass(frozen=True, slots=True)
class Violation:
    """A rule broken: the contour ids, a sentence, and the positions (from 1) of the cuts that break it.

    Where it is the place of one contour among others that is wrong, `orders` are the pairs of ids (before, after) that
    would have to be turned round. `asked` are the contours that what is broken is about, where these are more.
    """

    rule: str
    contours: tuple[str, ...]
    text: str
    cuts: tuple[int, ...] = ()
    orders: tuple[Ids, ...] = field(default=(), compare=False)
    asked: tuple[str, ...] = field(default=(), compare=False)


@dataclass(frozen=True, slots=True)
class NoGoodIds:
    """At no moment are all of `out` cut while all of `left` are still in: found from geometry, in contour ids."""

    out: tuple[str, ...]
    left: tuple[str, ...]
    sentence: str
