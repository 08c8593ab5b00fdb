"""Contours as people name them (an id, a part, `#7` for a cut of the last plan), and the locks on them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.options.yaml_positions import wrong_at
from kerfwise.rules.profile.lock_text import lines_of

_NUMBER = re.compile(r"#([1-9]\d{0,8})")
_NAMED = ("contour", "part", "place", "reason")
"""Fields of a lock that decide nothing by themselves."""


@dataclass(frozen=True, slots=True)
class OnNest:
    """One decision of a lock, on the contours of a nest: locks with their ids, and what is decided of which.

    Two locks cannot both stand where they decide the same, or say the contrary: `decides` are (key, of what), `orders`
    the pairs of which the first is cut before the second.
    """

    said: Lock
    locks: tuple[Lock, ...]
    decides: frozenset[tuple[str, object]]
    orders: frozenset[tuple[str, str]] = frozenset()

    def against(self, other: OnNest) -> bool:
        """Whether it decides what another lock decides too."""
        contrary = any((then, first) in self.orders for first, then in other.orders)
        return contrary or not self.decides.isdisjoint(other.decides)


class Names:
    """Finds the contours of a nest by the names that locks have for them.

    `by_number` says which contour a number such as #7 is. `numbered` is what was found so.
    """

    def __init__(self, nest: Nest, by_number: Callable[[str], str]) -> None:
        self._nest, self._by_number = nest, by_number
        self.numbered: dict[str, str] = {}

    def on_nest(self, lock: Lock) -> Iterator[OnNest]:
        """A lock on the contours that it is about, each thing that it decides for itself.

        Raises
        ------
        InputError
            If there is no such contour, part or cut, with the nearest name, or the lock is about one contour and names
            a part of several: at the place of the lock.
        """
        try:
            for one in _single(lock):
                yield self._one(one)
        except InputError as error:
            raise wrong_at(lock.place, f"lock {next(lines_of(lock))!r}: {error.message}") from None

    def _one(self, lock: Lock) -> OnNest:
        if lock.zone is not None:
            part = self._part(lock.part or "")
            return OnNest(lock, (replace(lock, part=part),), frozenset({("zone", part)}))
        name = lock.contour or ""
        found = self._contours(name)
        if lock.before is not None:
            return _orders(lock, found, self._contours(lock.before))
        if lock.position is not None:
            return self._placed(lock, name, found)
        if lock.tab is not None:
            found = [c for c in found if c.kind == "outer"] or found
        if lock.direction is not None and len(found) > 1:
            found = [c for c in found if c.encloses]
        if lock.entry is not None:
            found = [_only(name, found, "entered there")]
        key = next(f.name for f in fields(lock) if f.name not in _NAMED and getattr(lock, f.name) is not None)
        return OnNest(lock, tuple(replace(lock, contour=c.id) for c in found), frozenset((key, c.id) for c in found))

    def _placed(self, lock: Lock, name: str, found: list[Contour]) -> OnNest:
        """A position: the first and last of all can be a whole part; then each of its contours is, among the others."""
        place = lock.place_among(len(self._nest.contours))
        decides: set[tuple[str, object]] = {("position", c.id) for c in found} | {("at", place)}
        if place not in ("first", "last"):
            _only(name, found, f"cut {place} in order")
            return OnNest(lock, (replace(lock, contour=found[0].id),), frozenset(decides))
        others = [c for c in self._nest.contours if c not in found]
        first, then = (found, others) if place == "first" else (others, found)
        made = _orders(replace(lock, position=None), first, then)
        locks = made.locks if len(found) > 1 else (replace(lock, contour=found[0].id),)
        return OnNest(lock, locks, frozenset(decides), made.orders)

    def _contours(self, name: str) -> list[Contour]:
        nest = self._nest
        number = _NUMBER.fullmatch(name)
        if name in nest.index:
            return [nest.contour(name)]
        if name in nest.part_of:
            return list(nest.part_of[name])
        if number is None:
            if name in nest.left_out:
                raise InputError(f"{name} is left out as a small hole (small_holes.under: skip)")
            raise InputError(unknown("contour or part", name, (*nest.part_of, *nest.index)))
        cut = self._by_number(name)
        if cut not in nest.index:
            raise InputError(f"{name} is {cut} in the last plan, which the nest does not have")
        self.numbered[name] = cut
        return [nest.contour(cut)]

    def _part(self, name: str) -> str:
        if name in self._nest.part_of:
            return name
        if name in self._nest.index or _NUMBER.fullmatch(name):
            return self._contours(name)[0].part
        raise InputError(unknown("part", name, self._nest.part_of))


def _single(lock: Lock) -> Iterator[Lock]:
    """A lock of several decisions as one for each."""
    keys = [f.name for f in fields(lock) if f.name not in _NAMED and getattr(lock, f.name) is not None]
    bare = Lock(contour=lock.contour, part=lock.part, place=lock.place, reason=lock.reason)
    return (replace(bare, **{key: getattr(lock, key)}) for key in keys)


def _orders(lock: Lock, first: list[Contour], then: list[Contour]) -> OnNest:
    pairs = [(a.id, b.id) for a in first for b in then]
    if twice := next((a for a, b in pairs if a == b), None):
        raise InputError(f"{twice} cannot be cut before itself: {lock.contour} and {lock.before} both have it")
    return OnNest(lock, tuple(replace(lock, contour=a, before=b) for a, b in pairs), frozenset(), frozenset(pairs))


def _only(name: str, found: list[Contour], what: str) -> Contour:
    if len(found) > 1:
        raise InputError(f"{name} has {_listed(found)}: say which of them is {what}")
    return found[0]


def _listed(contours: list[Contour]) -> str:
    shown = ", ".join(c.id for c in contours[:5]) + (", …" if len(contours) > 5 else "")
    return f"{len(contours)} contours ({shown})"
