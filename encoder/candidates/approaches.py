"""Ways to join contours: a joint, a direction and a lead to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.cut import Direction
from kerfwise.encoder.nest import Kind

from .joints import Joints, Outline
from .lead_shapes import Leads


@dataclass(frozen=True, eq=False, slots=True)
class Ways:
    """Joints with a direction each: `ccw`, and the unit vector `along` (m, 2) that the torch leaves the joint in."""

    joints: Joints
    ccw: Bools
    along: Floats

    def __len__(self) -> int:
        return len(self.ccw)

    def take(self, rows: Bools | Ints) -> Ways:
        """Some of the rows."""
        return Ways(self.joints.take(rows), self.ccw[rows], self.along[rows])


def ways(joints: Joints, outlines: Mapping[int, Outline], directions: Mapping[Kind, tuple[Direction, ...]]) -> Ways:
    """Each joint in all directions that its kind of contour may be cut in."""
    outer = np.array([outlines[k].contour.kind == "outer" for k in joints.contour.tolist()], dtype=np.bool_)
    row, ccw = [], []
    kinds: dict[Kind, Bools] = {"outer": outer, "hole": ~outer}
    for kind, of_kind in kinds.items():
        for direction in directions[kind]:
            rows = np.flatnonzero(of_kind)
            row.append(rows)
            ccw.append(np.full(len(rows), direction == "ccw"))
    rows, turns = np.concatenate([np.zeros(0, np.int64), *row]), np.concatenate([np.zeros(0, np.bool_), *ccw])
    order = np.argsort(rows, kind="stable")
    rows, turns = rows[order], turns[order]
    taken = joints.take(rows)
    # Counter-clockwise the waste of an outer contour is to the right, that of a hole to the left.
    side = np.where(turns == outer[rows], 1.0, -1.0)[:, None]
    along = side * np.column_stack([-taken.out[:, 1], taken.out[:, 0]])
    return Ways(taken, turns, along)


@dataclass(frozen=True, eq=False, slots=True)
class Approaches:
    """Ways with the lead of each; `edge` where it comes in from the edge of the sheet."""

    ways: Ways
    leads: Leads
    edge: Bools

    def take(self, rows: Bools | Ints) -> Approaches:
        """Some of the rows."""
        return Approaches(self.ways.take(rows), self.leads.take(rows), self.edge[rows])

    @staticmethod
    def joined(several: Sequence[Approaches]) -> Approaches:
        """All rows of several, in order of contour, entry, direction and kind."""
        ways = Ways(
            Joints.joined([a.ways.joints for a in several]),
            np.concatenate([a.ways.ccw for a in several]),
            np.concatenate([a.ways.along for a in several]),
        )
        leads = Leads.joined([a.leads for a in several])
        together = Approaches(ways, leads, np.concatenate([a.edge for a in several]))
        joints = ways.joints
        return together.take(np.lexsort((together.edge, ways.ccw, joints.entry_mm, joints.contour)))
