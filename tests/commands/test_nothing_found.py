"""Where nothing was found, solve says what was tried and what to try; who follows that has a plan."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.tests.commands.run_cli import kerfwise


def test_the_advice_after_nothing_was_found_leads_to_a_plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    nest, profile = tmp_path / "nest.json", tmp_path / "plant.yaml"
    sheet = {"format": "kerfwise-nest/1", "units": "mm", **make_sheet(7, 24)}
    nest.write_text(json.dumps(sheet), encoding="utf-8")
    profile.write_text(
        "based_on: plasma-carbon-steel\nrules:\n  heat-lag: {strength: hard, lag_cuts: 2, heat_radius: 30 mm}\n",
        encoding="utf-8",
    )
    base = ("solve", nest, "-p", profile, "-o", tmp_path / "nest.nc")
    done = kerfwise(*base, "--work", "0.001")
    assert done.code == 1
    assert "\n  tried: all engines for work 0.001, then for a contradiction among the hard rules" in done.err
    said = re.search(r"\n  try: (--work \d+), which counts work and not the clock", done.err)
    assert said is not None, done.err
    assert "or --relax (in Python relax=True), which lets the cheapest hard rules give way" in done.err
    assert not (tmp_path / "nest.nc").exists()
    followed = kerfwise(*base, *said[1].split())
    assert followed.code == 0, followed.err
    assert "ok: every hard rule holds" in followed.out
