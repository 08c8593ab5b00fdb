"""A dialect whose words the control does not know, or knows as something else, is refused by the word and its place."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc import dialects
from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.dialects import dialect_names, load_dialect
from kerfwise.postproc.verdict.dialect_read_back import read_back, trusted_dialect
from kerfwise.rules.profile.load import load_profile, shipped_profiles

FOLDER = Path(dialects.__file__).parent


@pytest.mark.parametrize("name", dialect_names())
def test_shipped_dialects_read_back(name: str) -> None:
    read_back(load_dialect(name), name)


@pytest.mark.parametrize("name", shipped_profiles())
def test_shipped_profiles_have_a_dialect_that_reads_back(name: str) -> None:
    assert trusted_dialect(load_profile(name)).control in CONTROLS


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("torch_on: M3 S1", "torch_on: M07", "torch_on: 'M07' does not start the torch"),
        ("torch_on: M3 S1", "torch_on: M64 P0", "torch_on: 'M64 P0' starts what marks"),
        ("torch_on: M3 S1", "torch_on: M62 P0", "torch_on: 'M62 P0' cannot be read: M62"),
        ("torch_on: M3 S1", "torch_on: LASER ON", "torch_on: 'LASER ON' cannot be read"),
        ("torch_on: M3 S1", "torch_on: M3", "torch_on: of 'M3' the check says: tool .* without S1"),
        ("torch_off: M5", "torch_off: M9", "torch_off: 'M9' does not stop the torch: it is still on at 'G0 X60 Y5'"),
        ("mark_on: M64 P0", "mark_on: M8", "mark_on: 'M8' does not start the marking tool"),
        ("mark_off: M65 P0", "mark_off: M9", "mark_off: 'M9' does not stop the marking tool"),
        ("rapid: G0", "rapid: G1", "rapid: 'G1 X20 Y10' cannot be read"),
        ("line: G1", "line: G0", "line: "),
        ("arc_cw: G2", "arc_cw: G3", "arc_cw: "),
        ("arc_ccw: G3", "arc_ccw: G02.1", "arc_ccw: 'G02.1 X40"),
        ("arc_centre: relative", "arc_centre: absolute", "arc_ccw: "),
        ("feed: F{mm_min}", "feed: S{mm_min}", "line: 'G1 X30 Y10 S750' cannot be read"),
        ("dwell: G4 P{seconds}", "dwell: G4 P9{seconds}", "dwell: a wait of 1.5 s is read as one of 91.5 s"),
        ("comment: ({text})", "comment: ';;{text}'", ""),
        ("comment: ({text})", "comment: 'G1 {text}'", "comment: 'G1 KERFWISE"),
        ("  - G90 G17 G40 G49 G80 G91.1 G94\n", "", "header: "),
        ("  - G21", "  - G20", "header: it leaves the control in inches"),
        ("  - M2\n", "  - M5\n", "footer: "),
    ],
)
def test_a_word_that_does_something_else_is_named_with_its_place(
    old: str, new: str, message: str, tmp_path: Path
) -> None:
    text = (FOLDER / "linuxcnc.yaml").read_text(encoding="utf-8")
    assert old in text
    file = tmp_path / "shop.yaml"
    file.write_text(text.replace(old, new), encoding="utf-8")
    if not message:
        read_back(load_dialect(str(file)), str(file))
        return
    with pytest.raises(InputError) as refused:
        read_back(load_dialect(str(file)), str(file))
    key = message.partition(":")[0]
    line = next(k for k, row in enumerate(file.read_text().splitlines(), 1) if row.startswith(f"{key}:"))
    at = refused.value.line
    assert str(refused.value.file) == str(file)
    assert at in (line, line + 1)  # a list begins on the line after its key
    assert refused.match(message)
