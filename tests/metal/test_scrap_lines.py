"""Programs by hand that cut up a skeleton: a faultless one, and ones with a known fault each."""

from __future__ import annotations

from dataclasses import replace

from kerfwise.rule_kit import nest
from kerfwise.tests.metal.hand_made import CUTS, KERF_MM, Blocks, program, sheet, straight
from kerfwise.tests.metal.simulate import simulate

NEST = replace(sheet(), scrap=nest(200, 100, scrap=[[(80, 0), (80, 100)], [(142, 45), (200, 45)]]).scrap)


def found(*lines: tuple[str, Blocks]) -> list[tuple[str, tuple[str, ...]]]:
    return [(f.kind, f.contours) for f in simulate(NEST, program([*CUTS, *lines]), KERF_MM)]


ONE = ("scrap1", straight((80, 0), (80, 100)))
OTHER = ("scrap2", straight((200, 45), (142, 45)))


def test_a_faultless_program_has_no_findings() -> None:
    assert found(ONE, OTHER) == []


def test_a_line_left_out_or_cut_in_part_is_found() -> None:
    assert found(ONE) == [("left-uncut", ("scrap2",))]
    assert found(ONE, ("scrap2", straight((200, 45), (170, 45)))) == [("left-uncut", ("scrap2",))]


def test_a_line_into_a_part_is_found() -> None:
    kinds = {kind for kind, _ in found(ONE, ("scrap2", straight((200, 45), (139, 45))))}
    assert "part-eroded" in kinds
