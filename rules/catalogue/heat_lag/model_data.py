"""The Python side of `heat_lag.mzn`."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely

from kerfwise.encoder.minizinc_data import Fields, numbers_from_1
from kerfwise.encoder.nest import Nest
from kerfwise.rules.catalogue.heat_lag import HeatLagOptions
from kerfwise.rules.minizinc.twin import Further, Twin, rule_file


class HeatLagTwin(Twin[HeatLagOptions]):
    """Near contours of different parts, and the seconds between them in a file of their own."""

    def of_nest(self, nest: Nest, options: HeatLagOptions) -> Fields:
        near = heating_pairs(nest, options.heat_radius_mm)
        lag: Fields = [("heat_lag_ms", str(round(options.lag_s * 1000)))] if options.lag_s > 0 else []
        return [
            ("heat_lag_cuts", str(options.lag_cuts)),
            ("n_heat_near", str(len(near))),
            ("heat_near_one", numbers_from_1(i for i, _ in near)),
            ("heat_near_other", numbers_from_1(j for _, j in near)),
            *lag,
        ]

    def further(self, options: HeatLagOptions, weight_mm: float | None) -> Iterator[Further]:
        if options.lag_s > 0:
            yield Further(
                rule_file("heat-lag").with_name("heat_lag_seconds.mzn"),
                "heat_lag_missing_ms",
                weight_mm,
                round(options.lag_s * 1000),
            )


def heating_pairs(nest: Nest, radius_mm: float) -> list[tuple[int, int]]:
    """Contours of different parts, cut through, that are nearer than the radius, in order."""
    cut = [(k, c) for k, c in enumerate(nest.contours) if c.shapes_part]
    lines = np.array([c.line for _, c in cut], dtype=object)
    one, other = shapely.STRtree(lines).query(lines, "dwithin", distance=radius_mm)
    near = (one < other) & (shapely.distance(lines[one], lines[other]) < radius_mm - 1e-6)
    pairs = ((cut[a], cut[b]) for a, b in zip(one[near].tolist(), other[near].tolist(), strict=True))
    return sorted((i, j) for (i, a), (j, b) in pairs if a.part != b.part)
