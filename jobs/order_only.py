"""Burns that make no nest, in an order of less travel: rules on contours say nothing of them, geometry does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.components import strong_components
from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.encoder.geometry.segment import Point
from kerfwise.models.engines.solution import Progress, SolveOptions
from kerfwise.models.routing import Instance, solve_instance
from kerfwise.postproc.old.orders import orders_between
from kerfwise.postproc.old.pieces import TakenApart

from .old_program import OldJob


@dataclass(frozen=True, slots=True)
class Routed:
    """The order of the burns, from 0, and whether no other that keeps what must come first has less travel."""

    order: tuple[int, ...]
    proven: bool
    why: str = ""


def route(job: OldJob, apart: TakenApart, limits: SolveOptions, progress: Progress | None = None) -> Routed:
    """The shortest travel through all burns, each as it is, from home to where the program ends."""
    burns, pieces = apart.burns, apart.pieces
    n = len(pieces)
    orders = orders_between(burns, pieces, job.profile.material.kerf_mm)
    stays = tuple(range(n))
    if n < 2:
        return Routed(stays, True)
    component = strong_components(n, orders)
    if len(set(component.tolist())) < n:
        return Routed(stays, False, "what lies inside and what touches contradict the old order: it stays as it is")
    home = job.profile.machine.home
    last = job.old.program
    tail = last.rapids[-len(last.homing_mm)][1] if last.homing_mm else None
    starts, ends = np.array([piece.start for piece in pieces]), np.array([piece.end for piece in pieces])
    cost = np.zeros((n + 1, n + 1), dtype=np.int64)
    cost[0, 1:] = _um(home, starts)
    cost[1:, 0] = 0 if tail is None else _um(ends, tail)
    cost[1:, 1:] = _um(ends[:, None], starts)
    np.fill_diagonal(cost, 0)
    instance = Instance(job.name, cost, tuple((k,) for k in range(n + 1)), orders + 1, start=0, closed=True)
    answer = solve_instance(instance, limits, progress)
    if not answer.tour:
        return Routed(stays, False, "no order was found within the limit: it stays as it is")
    return Routed(tuple(vertex - 2 for vertex in answer.tour[1:]), answer.proven)


def _um(one: Floats | Point, other: Floats | Point) -> Ints:
    """Distances between points (…, 2) in mm, whole µm."""
    return np.asarray(np.rint(np.linalg.norm(np.subtract(one, other), axis=-1) * UM_PER_MM), dtype=np.int64)
