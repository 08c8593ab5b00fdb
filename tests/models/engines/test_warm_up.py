"""Kernels are there before a clock starts."""

from __future__ import annotations

from typing import Any, cast

from kerfwise.models.engines.ideals import doubled, kernels
from kerfwise.models.engines.warm_up import load_kernels


def _signatures(kernel: object) -> list[Any]:
    return list(cast(Any, kernel).dispatcher.signatures)


def test_the_sweeps_are_loaded_for_cheap_plans_and_dear_ones() -> None:
    load_kernels()
    sweeps = kernels.sweep, doubled.sweep_both
    loaded = [_signatures(kernel) for kernel in sweeps]
    for signatures in loaded:
        assert {str(moves.types[0].dtype) for moves, *_ in signatures} == {"int32", "int64"}
    load_kernels()
    assert [_signatures(kernel) for kernel in sweeps] == loaded
