"""Kernels are there before a clock starts."""

from __future__ import annotations

from typing import Any, cast

from kerfwise.apps.bench.bench_child import load_kernels
from kerfwise.models.engines.ideals import kernels


def _signatures(kernel: object) -> list[Any]:
    return list(cast(Any, kernel).dispatcher.signatures)


def test_the_sweep_is_loaded_for_cheap_plans_and_dear_ones() -> None:
    load_kernels()
    loaded = _signatures(kernels.sweep)
    assert {str(layer.fields["values"][0].dtype) for _, layer, *_ in loaded} == {"int32", "int64"}
    load_kernels()
    assert _signatures(kernels.sweep) == loaded
