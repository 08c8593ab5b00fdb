"""What is written does not depend on where: the same nest and job file in two folders give the same files."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.tests.commands.run_cli import kerfwise

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"
JOB = 'profile: laser-st10kp-2mm\nquantity: 4\nlocks: ["part#1.hole1 first"]\nset: {leads.lead_in: 3 mm}\n'
FILES = "made.nc", "made.json", "made.html"


@pytest.mark.slow
def test_files_of_a_nest_with_a_job_are_the_same_in_every_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program, plan, picture = FILES
    found = []
    for folder in (tmp_path / "one", tmp_path / "another" / "place"):
        folder.mkdir(parents=True)
        monkeypatch.chdir(folder)
        shutil.copyfile(NEST, "nest.json")
        Path("nest.job.yaml").write_text(JOB, encoding="utf-8")
        done = kerfwise("solve", "nest.json", "--work", "1", "-o", program, "--plan", plan, "--picture", picture)
        assert done.code == 0, done.err
        found.append([Path(name).read_bytes() for name in FILES])
    assert found[0] == found[1]
