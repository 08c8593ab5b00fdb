"""Plans, profiles and job files that a hand has changed: what matters is told, and nothing ends in a traceback."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml

from kerfwise import InputError, load_profile, read_nest
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.nest_job.request import inputs_for
from kerfwise.jobs.programs import check_made
from kerfwise.models.plan.read_plan import plan_in
from kerfwise.tests.fuzz.inputs import seeds
from kerfwise.tests.mutations.tree_mutants import tree_mutants

FREE = re.compile(
    r"because|\.why|^nest\.file|^profile\.name|^solve\.(engine|seed|seconds|found_by|proved_by|excuses|status)"
    r"|^solve\.\w+: key dropped|^time\.(model|nc_blocks|idle_share)|key dropped$|members? (turned round|doubled)$"
    r"|^prices\.breaches\.\*\.(rule|contours)|\.zone: |^totals\.heat|lead_\w+\.\*\.\*: "
    r"|\.entry\.\*: of another row|\.lead_out: member dropped"
)
"""No program is made from these: texts, how a plan was found, what is left unsaid, zones still in turn, an
entry a kerf from where the torch joins, the one point of a lead-out that there is not."""
LARGE = [pytest.mark.full, pytest.mark.slow]
COUNTS = pytest.mark.parametrize("count", [60, pytest.param(1500, marks=LARGE)])


@pytest.fixture(autouse=True)
def in_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def _untold(count: int) -> Iterator[str]:
    """Changes of a plan that nobody tells."""
    Path("nest.json").write_bytes(seeds.nest_bytes("rich"))
    given, file = Inputs(read_nest(Path("nest.json")), load_profile()), Path("made.plan.json")
    text = seeds.made("rich")[1].decode()
    for what, tree in tree_mutants(json.loads(text), count, "plan"):
        changed, notes = json.dumps(tree), list[str]()
        file.write_text(changed)
        try:
            if plan_in(changed).to_json() == plan_in(text).to_json():
                continue
            result = check_made(given, file, notes.append)
        except InputError:
            continue
        notes += [text for text in result.warnings if "the plan says" in text]
        if result.ok and not notes:
            yield what


@COUNTS
def test_what_matters_of_a_changed_plan_is_told(count: int) -> None:
    assert [what for what in _untold(count) if not FREE.search(what)] == []


@COUNTS
def test_a_changed_profile_is_refused_or_another(count: int) -> None:
    for name in ("own", "plasma-carbon-steel", "laser-st10kp-2mm"):
        tree = seeds.profile_tree(name)
        file = Path("plant.yaml")
        file.write_text(yaml.safe_dump(tree, sort_keys=False))
        sha256 = load_profile(file).sha256
        for what, changed in tree_mutants(tree, count // 3, name):
            file.write_text(yaml.safe_dump(changed, sort_keys=False))
            told = "plant.yaml"
            try:
                other = load_profile(file).sha256
            except InputError as error:
                told, other = str(error), ""
            assert "plant.yaml" in told, what
            assert other != sha256, what


@COUNTS
def test_a_changed_job_file_is_refused_or_another(count: int) -> None:
    Path("plant.yaml").write_text("name: plant\nbased_on: plasma-carbon-steel\n")
    Path("nest.json").write_bytes(seeds.nest_bytes("plain"))
    Path("nest.plan.json").write_bytes(seeds.made("plain")[1])
    job, shas = Path("nest.job.yaml"), dict[str, str]()
    for what, changed in (("none", seeds.JOB), *tree_mutants(seeds.JOB, count, "job")):
        job.write_text(yaml.safe_dump(changed, sort_keys=False))
        told = "nest.json"
        try:
            made_with = inputs_for(Path("nest.json")).profile.for_one_nest
            shas[what] = "" if made_with is None else made_with.sha256
        except InputError as error:
            told = str(error)
        assert re.search(r"nest\.job\.yaml|nest\.plan\.json|plant\.yaml|nest\.json", told), what
    assert len(shas) > 1
    assert all(sha256 and (what == "none" or sha256 != shas["none"]) for what, sha256 in shas.items())
