"""Kernels are there before a clock starts."""

from __future__ import annotations

from typing import Any, cast

from kerfwise.models.engines.ideals import kernels
from kerfwise.models.engines.warm_up import load_kernels


def _signatures() -> list[object]:
    return list(cast(Any, kernels.sweep).dispatcher.signatures)


def test_the_sweep_is_loaded_for_cheap_plans_and_dear_ones_with_a_bound_and_without() -> None:
    load_kernels()
    loaded = len(_signatures())
    assert loaded >= 4
    load_kernels()
    assert len(_signatures()) == loaded
