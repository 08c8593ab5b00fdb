"""Judges a tour by the instance's own numbers alone: nothing of the problem that the engines saw is used."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from .instance import Instance


def judge_tour(instance: Instance, tour: Sequence[int]) -> tuple[int, str]:
    """Cost of a tour (vertices numbered from 1, the start first), and what is wrong with it, "" for nothing."""
    vertices = [v - 1 for v in tour]
    if not all(0 <= v < len(instance.cost) for v in vertices):
        return 0, "there is no such vertex"
    cluster_of = {v: k for k, members in enumerate(instance.clusters) for v in members}
    visited = [cluster_of[v] for v in vertices]
    if vertices[:1] != [instance.start]:
        return 0, f"the tour does not begin at vertex {instance.start + 1}"
    if sorted(visited) != list(range(len(instance.clusters))):
        return 0, "a cluster is not visited once"
    place = np.argsort(visited)
    late = instance.orders[place[instance.orders[:, 0]] > place[instance.orders[:, 1]]]
    steps = [*pairwise(vertices), *([(vertices[-1], instance.start)] if instance.closed else [])]
    cost = sum(int(instance.cost[a, b]) for a, b in steps)
    if len(late):
        a, b = late[0].tolist()
        return cost, f"cluster {a + 1} must come before cluster {b + 1}"
    return cost, ""
