"""The Python side of `locks.mzn`."""

from __future__ import annotations

from kerfwise.encoder.minizinc_data import Fields, number_set, numbers
from kerfwise.rules.catalogue.locks import Locks, LocksOptions
from kerfwise.rules.minizinc.twin import Twin, TwinCase


class LocksTwin(Twin[LocksOptions]):
    """Orders, positions and entries that are locked."""

    def data(self, case: TwinCase, options: LocksOptions) -> Fields:
        number = {name: k + 1 for name, k in case.facts.nest.index.items()}
        count = len(case.facts.already_cut)
        ends = {"first": 1, "last": case.facts.n}
        locks = [lock for lock in options.locks if lock.contour in number]
        orders = [
            (number[lock.contour], number[lock.before]) for lock in locks if lock.contour and lock.before in number
        ]
        places = [
            (number[lock.contour], ends[place] if isinstance(place, str) else place - count)
            for lock in locks
            if lock.contour and (place := lock.place_among(case.facts.n + count))
        ]
        out = {s.candidate + 1 for s in Locks().excluded(case.facts, options)}
        return [
            ("n_lock_orders", str(len(orders))),
            ("lock_first", numbers(i for i, _ in orders)),
            ("lock_second", numbers(j for _, j in orders)),
            ("n_lock_places", str(len(places))),
            ("lock_contour", numbers(i for i, _ in places)),
            ("lock_position", numbers(k for _, k in places)),
            ("lock_excludes", number_set(out)),
        ]
