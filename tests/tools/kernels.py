"""Compile every kernel that the tests use, or find it compiled: `python -m kerfwise.tests.tools.kernels`.

Numba keeps machine code on disk. Test processes that start at the same time with an empty cache would each compile all
of it; so it is done once before they start.
"""

from __future__ import annotations

from kerfwise.apps.bench.bench_child import load_kernels
from kerfwise.models.physics.heat.simulate import simulate
from kerfwise.rule_kit import nest, part, rect
from kerfwise.rules.profile.plant_sections import Heat
from kerfwise.tests.models.physics.heat.paths import along


def main() -> None:
    """Run each kernel on something small."""
    load_kernels()
    plate = nest(100, 100, part("P", rect(20, 20, 60, 60)))
    for model in ("physical", "logical"):
        simulate(plate, along([(20, 20), (80, 20)], 0.0, 1.0), Heat(model=model), 6.0)


if __name__ == "__main__":
    main()
