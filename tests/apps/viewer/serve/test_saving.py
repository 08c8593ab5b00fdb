"""What a session writes: the same bytes as the command line, and nothing over what somebody else has changed."""

from __future__ import annotations

import json
from pathlib import Path

import httpx
import pytest

from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.tests.apps.viewer.serve.served import SMALL, Open, Served, command_line, saved_files

pytestmark = pytest.mark.slow


JOB = "# of the night shift\norder: '4711'  # the order\nlocks:\n  - B.outer before C.outer  # as ever\n"


BROKEN = SMALL.replace("[[130, 20], [210, 20], [210, 100], [130, 100]]", "[[90, 20], [210, 20], [210, 100], [90, 100]]")


@pytest.mark.parametrize("job", [None, JOB])
def test_what_is_saved_is_what_the_command_line_writes(opened: Open, job: str | None) -> None:
    tab = opened(job=job)
    tab.edit({"lock": "no link C.outer"}, {"lock": "B position 3"}, {"set": "rules.heat-lag.weight", "to": "80 mm"})
    told = tab.solved()
    saved = saved_files(tab)
    assert sorted(saved) == ["job.yaml", "nc", "plan.json", "svg"]
    assert b"heat-lag.weight: 80 mm" in saved["job.yaml"]
    if job is not None:
        assert saved["job.yaml"].decode().startswith(JOB)
    for name in ("nc", "plan.json", "svg"):
        tab.nest.with_name(f"{tab.nest.stem}.{name}").unlink()
    command_line(tab.nest.parent, told["alternatives"][0]["command"])
    again = {name: tab.nest.with_name(f"{tab.nest.stem}.{name}").read_bytes() for name in saved}
    assert again == saved


def test_a_plan_that_goes_on_from_the_one_before_is_made_again_from_it(opened: Open) -> None:
    """After an edit the engines begin where the plan at hand leads: no plan comes out dearer than what was shown."""
    tab = opened(json.dumps(make_sheet(1, 12)), "plate.json")
    tab.solved(work=0.2)
    page = tab.get("page")
    order = [page["nest"]["contours"][cut["contour"]]["id"] for cut in page["sides"][0]["cuts"]]
    moves = (tab.get("move", contours=name, place=place) for place, name in enumerate(order[:-1], 2))
    tab.edit(*({"lock": line} for line in next(one for one in moves if one["lawful"])["locked"]))
    told = tab.solved(work=0.2)
    shown = [one for one in told["alternatives"] if one["run"] == 2]
    assert shown[-1]["stage"] == "final"
    costs = [one["figures"]["objective_mm"] for one in shown]
    assert costs[-1] == min(costs)
    assert shown[-1]["command"].endswith(" --start plate.start.plan.json --work 0.2")
    saved = saved_files(tab)
    assert json.loads(saved["start.plan.json"])["nest"]["file"] == "plate.json"
    for name in ("nc", "plan.json"):
        tab.nest.with_name(f"plate.{name}").unlink()
    command_line(tab.nest.parent, shown[-1]["command"])
    assert {name: tab.nest.with_name(f"plate.{name}").read_bytes() for name in saved} == saved


def test_a_plan_that_was_made_without_a_job_file_is_made_again_once_one_is_saved(opened: Open) -> None:
    tab = opened()
    tab.solved()
    tab.edit({"lock": "C first"})
    tab.solved()
    tab.post("save")
    assert tab.post("back", to=1)["fits"] is False
    assert "small.job.yaml was saved since" in tab.post("save", 422)["message"]
    told = tab.solved()
    saved = saved_files(tab)
    assert saved["job.yaml"] == b""
    command_line(tab.nest.parent, told["alternatives"][2]["command"])
    again = {name: tab.nest.with_name(f"{tab.nest.stem}.{name}").read_bytes() for name in saved}
    assert again == saved


def test_a_dropped_drawing_is_kept_once_it_can_be_cut(client: httpx.Client, served: Served, tmp_path: Path) -> None:
    name = f"{tmp_path.name}.json"
    answer = client.post("/api/drop", params={"name": name}, content=BROKEN)
    told = answer.json()
    assert (answer.status_code, told["kind"]) == (422, "input")
    assert any(problem["contours"] for problem in told["problems"]["lines"])
    assert told["problems"]["page"]["alert"] == [1, 2]
    assert not (served.server.folder.path / name).exists()
    answer = client.post("/api/drop", params={"name": name}, content=SMALL)
    assert (answer.status_code, answer.json()["nest"]) == (201, name)
    assert (served.server.folder.path / name).read_text(encoding="utf-8") == SMALL
    assert client.post("/api/drop", params={"name": name}, content=SMALL).status_code == 201
    assert "another file" in client.post("/api/drop", params={"name": name}, content=SMALL + " ").json()["message"]


def test_nothing_is_written_over_what_changed_on_disk(opened: Open) -> None:
    tab = opened(job="quantity: 2\n")
    tab.edit({"lock": "C.outer last"})
    tab.solved()
    job = tab.nest.with_name("small.job.yaml")
    job.write_text("quantity: 3\n", encoding="utf-8")
    assert "has changed on disk" in tab.post("save", 422)["message"]
    assert job.read_text(encoding="utf-8") == "quantity: 3\n"
    assert not tab.nest.with_name("small.nc").exists()
    tab.nest.write_text(SMALL + "\n", encoding="utf-8")
    assert "the nest has changed on disk" in tab.post("save", 422)["message"]
    tab.edit({"lock": "B.outer cw"})  # it is read again meanwhile, and the plan is the old one still
    assert tab.post("back", 200, to=1)["fits"] is False
    assert "the nest has changed on disk" in tab.post("save", 422)["message"]
    tab.nest.unlink()
    for what, said in (("save", {}), ("edit", {"changes": []})):
        assert tab.post(what, 422, **said)["message"] == "there is no such file"


def test_nothing_is_written_where_a_link_leads_out_of_the_folder(opened: Open, served: Served) -> None:
    tab = opened()
    tab.solved()
    outside = served.server.folder.path.parent / "mine.txt"
    outside.write_text("mine", encoding="utf-8")
    tab.nest.with_name("small.nc").symlink_to(outside)
    assert "leads out of the folder" in tab.post("save", 422)["message"]
    assert outside.read_text(encoding="utf-8") == "mine"
    assert not tab.nest.with_name("small.plan.json").exists()


def test_the_old_plan_takes_no_place_of_another_nests(opened: Open) -> None:
    tab = opened()
    tab.solved()
    tab.post("cut", upto=2)
    tab.solved()
    before = tab.nest.with_name("small.before.plan.json")
    before.write_text('{"nest": {"file": "small.dxf"}}', encoding="utf-8")
    assert "is of small.dxf" in tab.post("save", 422)["message"]
    assert "small.dxf" in before.read_text(encoding="utf-8")


def test_a_profile_that_changed_on_disk_judges_the_moves_of_its_plans(
    opened: Open, served: Served, tmp_path: Path
) -> None:
    plant = served.server.folder.path / f"{tmp_path.name}.yaml"
    strength = "based_on: plasma-carbon-steel\nrules:\n  level-ahead: {strength: %s}\n"
    plant.write_text(strength % "hard", encoding="utf-8")
    tab = opened(job=f"profile: {plant.as_posix()}\n")
    tab.solved()
    assert "level-ahead" in tab.get("move", contours="C", place=3)["text"]
    plant.write_text(strength % "off", encoding="utf-8")
    tab.state()
    assert "the profile has changed on disk" in tab.post("save", 422)["message"]
    assert not tab.nest.with_name("small.nc").exists()
    tab.solved()
    tab.state()
    tab.post("save")
    assert tab.nest.with_name("small.nc").exists()
    assert "level-ahead" not in tab.get("move", contours="C", place=3)["text"]
