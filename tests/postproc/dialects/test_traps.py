"""What would cut air or metal without a word on a control: each trap has a test here, on a whole program.

- GRBL's M4 is dark at rest, and its M3 behind a G0: such pierces are told.
- Marlin is not offered, and its waits in milliseconds and its inline power are told.
- EIA programs for a mapped Phoenix use G20 and G21 for moves, M04 and M06 for the torch, M07 for the marker's end.
- Burny's torch words are those of others the other way round.
- A drawing for a control that cuts every layer holds nothing but torch paths.
- Controls whose process tables are the machine's are claimed nowhere.
"""

from __future__ import annotations

import re
from pathlib import Path

import pyogrio.raw
import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.postproc.dialects import dialect_names, load_dialect
from kerfwise.postproc.nc.ordered_drawings import write_dxf
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.postproc.dialects.reading import with_dialect
from kerfwise.tests.postproc.plans import cut_of, good_cuts, plan_of, plate, profile

GRBL = with_dialect(profile(), "grbl")
EIA_HEAD = "G21\nG90\nG40\n"


def written(dialect: str) -> str:
    plant = with_dialect(profile(), dialect)
    return write_program(plan_of(plate(), good_cuts(plate()), plant), plate(), plant)


def judged(old: str, new: str) -> CheckResult:
    """The verdict on the plate's program for GRBL, with a sequence of blocks in the place of another everywhere."""
    text = written("grbl")
    damaged = re.sub(old, new, text, flags=re.MULTILINE)
    assert damaged != text
    return check_program(plate(), damaged, GRBL)


def test_the_program_for_grbl_is_sound() -> None:
    assert check_program(plate(), written("grbl"), GRBL).broken() == ()


def test_under_grbl_m4_at_rest_pierces_nothing() -> None:
    assert judged(r"^M3 S1000\n(G4 .*)\nM4 S1000", r"M4 S1000\n\1").broken() == ("pierce-delay",)


def test_under_grbl_m3_behind_a_rapid_pierces_nothing() -> None:
    assert judged(r"^G1 F\d+\nM3 S1000", "M3 S1000").broken() == ("pierce-delay",)


def test_marlins_waits_in_milliseconds_are_told() -> None:
    broken = judged(r"^G4 P([\d.]+)", lambda wait: f"G4 P{float(wait[1]) * 1000:g}").broken()  # type: ignore[arg-type]
    assert broken == ("pierce-delay",)


@pytest.mark.parametrize(("old", "new"), [(r"^G4 P", "G4 S"), (r"^M4 S", "M4 I S")])
def test_marlins_seconds_and_inline_power_are_refused(old: str, new: str) -> None:
    with pytest.raises(InputError) as caught:
        judged(old, new)
    assert caught.value.line is not None


def test_marlin_waits_in_seconds_and_puts_the_beam_out_before_each_travel() -> None:
    """P would be milliseconds; what M3 lights burns on in travel, too."""
    drawn, plant = nest(200, 120, part("A", rect(40, 30, 60, 50))), with_dialect(profile(), "marlin")
    text = write_program(plan_of(drawn, [cut_of(drawn.contour("A.outer"), 0.1, "cw")], plant), drawn, plant)
    assert "G4 S0.5" in text
    assert "M5\n; HOME\nG0 X0 Y0\n" in text
    assert check_program(drawn, text, plant).broken() == ()
    with pytest.raises(InputError, match="P without a word that uses it"):
        check_program(drawn, text.replace("G4 S0.5", "G4 P0.5"), plant)
    with pytest.raises(InputError, match="X without a word that uses it: expected a motion word"):
        check_program(drawn, text.replace("\nG1 X", "\nX", 2), plant)  # it goes nowhere by such a line
    late = text.replace("M5\n; HOME\nG0 X0 Y0\n", "; HOME\nG0 X0 Y0\nM5\n")
    assert "torch-off-travel" in check_program(drawn, late, plant).broken()


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("G20 X5 Y5\nM04\nG21 X15 F600\nM06", "X without a word that uses it"),  # moves by G20 and G21
        ("G00 X5 Y5\nM04\nG01 X15 F600\nM06", "M04 is not understood"),
        ("G00 X5 Y5\nM07\nG01 X15 F600\nM06", "M06 is not understood"),
    ],
)
def test_a_program_for_a_mapped_phoenix_is_refused(body: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as caught:
        read_nc(f"{EIA_HEAD}{body}\nM02\n", control=CONTROLS["eia"])
    assert caught.value.line is not None


def test_a_line_by_g21_behind_a_rapid_is_a_rapid_with_the_torch_on() -> None:
    program = read_nc(f"{EIA_HEAD}G00 X5 Y5\nM07\nG21 X15 F600\nM08\nM02\n", control=CONTROLS["eia"])
    assert program.hot_rapids


def test_m07_does_not_end_a_mark() -> None:
    """Where M07 puts a marker out, that is mapped; as it stands M07 lights the torch."""
    program = read_nc(f"{EIA_HEAD}G00 X5 Y5\nM09\nG01 X15 F600\nM07\nG00 X0\nM02\n", control=CONTROLS["eia"])
    assert any("is started while" in fault.text for fault in program.faults)


def test_burnys_torch_words_the_other_way_round_are_told() -> None:
    drawn, burny = nest(200, 120, part("A", rect(40, 30, 60, 50))), with_dialect(profile(), "burny")
    plan = plan_of(drawn, [cut_of(drawn.contour("A.outer"), 0.1, "cw")], burny)
    text = write_program(plan, drawn, burny)
    swapped = re.sub(r"\bM0?([34])\b", lambda word: f"M0{7 - int(word[1])}", text)
    assert swapped != text
    assert check_program(drawn, text, burny, plan=plan).broken() == ()
    assert "every-contour-once" in check_program(drawn, swapped, burny, plan=plan).broken()


def test_a_drawing_holds_a_polyline_a_cut_and_nothing_that_is_not_to_be_cut(tmp_path: Path) -> None:
    """Where a control cuts every layer, a frame of the sheet or a line of travel would be cut."""
    plan = plan_of(plate(), good_cuts(plate()), profile())
    (tmp_path / "out.dxf").write_text(write_dxf(plan, plate(), profile()), newline="")
    _, _, shapes, columns = pyogrio.raw.read(tmp_path / "out.dxf", columns=["Layer"])
    layer = {"outer": "CUT_OUTER", "hole": "CUT_HOLE", "mark": "MARK"}
    assert list(columns[0]) == [layer[planned.kind] for planned in plan.cuts]
    assert len(shapes) == len(plan.cuts) == len(plate().contours)


@pytest.mark.parametrize("maker", ["trumpf", "bystronic"])
def test_nothing_is_claimed_of_controls_whose_process_tables_are_the_machines(maker: str) -> None:
    told = [
        text for name in dialect_names() for text in (name, load_dialect(name).title, *load_dialect(name).verified_by)
    ]
    told += [text for name, control in CONTROLS.items() for text in (name, control.title)]
    assert not [text for text in told if maker in text.lower()]
