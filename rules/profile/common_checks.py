"""What of common cuts does not go with the machine and the material."""

from __future__ import annotations

from collections.abc import Iterator

from kerfwise.encoder.tolerance import tolerance_mm

from .cuts_section import Common
from .machine_section import MACHINE_WAITS, Machine
from .material_section import Material


def wrong_common(common: Common, machine: Machine, material: Material) -> Iterator[tuple[tuple[str, ...], str]]:
    """Where the mistake stands in a profile, by its keys, and what it is."""
    if common.shortest_mm is None:
        return
    if common.gap_tolerance_mm > tolerance_mm(material.kerf_mm):
        yield (
            ("cuts", "common", "gap_tolerance"),
            f"cuts.common.gap_tolerance: {common.gap_tolerance_mm:g} mm is more than a torch may be off at this kerf, "
            f"{tolerance_mm(material.kerf_mm):g} mm",
        )
    if machine.kerf_start and machine.process == "oxyfuel" and machine.edge_preheat_s <= 0:
        yield (
            ("cuts", "common"),
            "cuts.common: a flame has to heat the edge of a kerf before it cuts on from there: give "
            "machine.edge_preheat, such as 7 s, or say machine.kerf_start: false",
        )
    if machine.kerf_start and machine.pierce_dwell == "machine":
        yield (("machine", "kerf_start"), f"machine.kerf_start: {MACHINE_WAITS}")
