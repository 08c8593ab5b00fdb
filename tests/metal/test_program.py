"""The judge's reader of programs against LinuxCNC's own interpreter."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.tests.metal.hand_made import CUTS, HEAD, TAIL, program
from kerfwise.tests.metal.program import Program, UnreadableProgram, read_program
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.amount import examples

GOLDEN = Path(__file__).parents[1] / "postproc" / "nc" / "golden"


def agree(text: str) -> Program:
    """Both readers see the same tools, points, lengths and idle moves."""
    own, machine = read_program(text), canon.run(text)
    assert machine.error is None
    assert machine.warnings == []
    assert [p.tool for p in own.paths] == [b.tool for b in machine.burns]
    for path, burn in zip(own.paths, machine.burns, strict=True):
        assert np.allclose(path.points[[0, -1]], [burn.points[0], burn.points[-1]], atol=1e-9)
        length = float(np.hypot(*np.diff(path.points, axis=0).T).sum())
        assert length == pytest.approx(burn.length_mm, rel=1e-3, abs=1e-3)
        assert shared_mm(path.points, burn.points) < 0.02
    assert np.allclose(np.array(own.idle), np.array(machine.rapids), atol=1e-9)
    return own


def shared_mm(a: object, b: object) -> float:
    """The furthest that one of two paths goes from the other, mm."""
    import shapely

    first, second = (shapely.LineString(p) if len(p) > 1 else shapely.Point(p[0]) for p in (a, b))  # type: ignore[arg-type]
    return float(shapely.hausdorff_distance(first, second))


@pytest.mark.linuxcnc
@pytest.mark.parametrize("name", sorted(p.name for p in GOLDEN.glob("*.ngc")))
def test_the_project_s_programs_are_read_as_linuxcnc_reads_them(name: str) -> None:
    assert agree((GOLDEN / name).read_text()).paths


@pytest.mark.linuxcnc
def test_the_programs_by_hand_are_read_as_linuxcnc_reads_them() -> None:
    own = agree(program())
    assert [(p.order, p.label, p.tool) for p in own.paths] == [
        (k, name, int(".mark" in name)) for k, (name, _) in enumerate(CUTS, 1)
    ]
    assert own.resumed_after is None
    assert read_program(program(head=["(RESUME AFTER CUT 7)"])).resumed_after == 7


def test_a_marking_tool_on_an_output_is_read() -> None:
    text = "\n".join([*HEAD, "G0 X1 Y1", "M64 P0", "G1 X5 F100", "M65 P0", "G0 X9", "M3 S1", "G1 X8", "M5", "M2"])
    assert [(p.tool, p.points.tolist()) for p in read_program(text).paths] == [
        (1, [[1, 1], [5, 1]]),
        (0, [[9, 1], [8, 1]]),
    ]


COORDINATES = st.integers(-500, 500).map(lambda v: v / 10)


@st.composite
def moves(draw: st.DrawFn) -> list[str]:
    """Lines and arcs one after the other from the origin; every arc's end lies on its circle to 0.0001 mm."""
    blocks, at = [], (0.0, 0.0)
    for _ in range(draw(st.integers(1, 6))):
        if draw(st.booleans()):
            at = (draw(COORDINATES), draw(COORDINATES))
            blocks.append(f"G1 X{at[0]} Y{at[1]}")
            continue
        i, j = draw(COORDINATES.filter(lambda v: abs(v) > 1)), draw(COORDINATES)
        turn = draw(st.integers(1, 36)) * math.tau / 36
        centre, radius = (at[0] + i, at[1] + j), math.hypot(i, j)
        angle = math.atan2(-j, -i) + turn
        at = (round(centre[0] + radius * math.cos(angle), 4), round(centre[1] + radius * math.sin(angle), 4))
        blocks.append(f"G{draw(st.sampled_from('23'))} X{at[0]:.4f} Y{at[1]:.4f} I{i} J{j}")
    return blocks


@pytest.mark.slow
@pytest.mark.linuxcnc
@given(moves())
@examples(25)
def test_any_row_of_lines_and_arcs_is_read_as_linuxcnc_reads_it(blocks: list[str]) -> None:
    agree("\n".join([*HEAD, "F1000", "M3 $0 S1", *blocks, "M5 $0", *TAIL]))


def test_a_difference_would_be_noticed() -> None:
    text = program()
    turned = text.replace("G3 X52.0 Y45 I-7.0 J0", "G3 X38.0 Y45 I-7.0 J0", 1)
    assert turned != text
    right, wrong = read_program(text).paths[1], read_program(turned).paths[1]
    assert shared_mm(right.points, wrong.points) > 1


@pytest.mark.parametrize("block", ["G20", "G41 D1", "X1 Y1", "G1 X1 Q", "G92 X0", "M7", "M3 $0 S1", "G1 X[1+1]"])
def test_what_is_not_known_is_refused(block: str) -> None:
    with pytest.raises(UnreadableProgram, match="line 7"):
        read_program("\n".join([*HEAD, "M3 $0 S1", block, "M5 $0", *TAIL]))


def test_a_torch_left_on_is_refused() -> None:
    with pytest.raises(UnreadableProgram, match="ends with the torch on"):
        read_program("\n".join([*HEAD, "M3 $0 S1", "G1 X5 F100", "M2"]))
