"""What a drawing's neighbours may hold and a stranger may send: nothing of it hangs the server or shows other files."""

from __future__ import annotations

import json
import os
import signal
from pathlib import Path

import httpx
import pytest

from kerfwise.tests.apps.viewer.serve.served import SMALL, Open, Served, Tab

SECRET = "root-of-all-secrets"
LIKE_A_RULE = f"constraint {SECRET};\n"


@pytest.fixture
def outside(served: Served, tmp_path: Path) -> Path:
    """A folder that is not served, with files that hold a secret."""
    folder = tmp_path / "outside"
    folder.mkdir()
    for name in ("secret", "secret.yaml", "secret.job.yaml"):
        (folder / name).write_text(f"{SECRET}: [unclosed\n", encoding="utf-8")
    (folder / "secret.mzn").write_text(LIKE_A_RULE, encoding="utf-8")
    (folder / "secret.csv").write_text(f"{SECRET};{SECRET}\n", encoding="utf-8")
    return folder


def write(folder: Path, name: str, text: str) -> None:
    folder.mkdir(exist_ok=True)
    (folder / name).write_text(text, encoding="utf-8")


FILES = {
    "a profile": ("profile: {to}/secret.yaml\n", {}),
    "a profile of no suffix": ("profile: {to}/secret\n", {}),
    "a profile by a link": ("profile: link/secret.yaml\n", {}),
    "a profile in a folder above": ("profile: ../../outside/secret.yaml\n", {}),
    "a profile that is not there": ("profile: {to}/nothing.yaml\n", {}),
    "what a profile is based on": ("profile: ours.yaml\n", {"ours.yaml": "based_on: {to}/secret.yaml\n"}),
    "a dialect": ("set:\n  machine.dialect: {to}/secret.yaml\n", {}),
    "a dialect of a profile": ("profile: ours.yaml\n", {"ours.yaml": "machine:\n  dialect: {to}/secret.yaml\n"}),
    "a model": ("profile: ours.yaml\n", {"ours.yaml": "models: [{to}/secret.mzn]\n"}),
    "what a model includes": (
        "profile: ours.yaml\n",
        {"ours.yaml": "models: [rule.mzn]\n", "rule.mzn": 'include "{to}/secret.mzn";\n% Ours.\nconstraint true;\n'},
    ),
}


@pytest.mark.parametrize("case", FILES)
def test_other_files_are_neither_read_nor_shown(
    served: Served, client: httpx.Client, tmp_path: Path, outside: Path, case: str
) -> None:
    job, beside = FILES[case]
    folder = served.server.folder.path / tmp_path.name
    write(folder, "small.json", SMALL)
    write(folder, "small.job.yaml", job.replace("{to}", str(outside)))
    for name, text in beside.items():
        write(folder, name, text.replace("{to}", str(outside)))
    (folder / "link").symlink_to(outside)
    told = refusal(client, f"{tmp_path.name}/small.json")
    assert SECRET not in json.dumps(told)
    assert "it lies outside of the folder that is served" in told


def refusal(client: httpx.Client, nest: str) -> str:
    """Why a nest is not opened, or, as some files are read for the program alone, not planned."""
    answer = client.post("/api/open", json={"nest": nest})
    told = answer.json()
    if answer.status_code == 422:
        return str(told["message"])
    tab = Tab(client, told["id"], told["version"], Path(nest))
    assert SECRET not in answer.text
    return str(tab.solved()["problem"])


def test_a_job_file_that_an_undo_sends_reads_no_other_files(opened: Open, outside: Path) -> None:
    """What it may name is what one on disk may; a list of lists within lists is no job, and none is waited for."""
    tab = opened()
    before = tab.state()
    bombs = "a: &a [x]\n" + "".join(
        f"{one}: &{one} [*{two}, *{two}, *{two}]\n" for one, two in zip("bcdefghi", "abcdefgh", strict=True)
    )
    for text in (
        f"profile: {outside}/secret.yaml\n", "[" * 50_000, bombs,
        "x" * 1_000_001, "\x00", "locks: !!python/object:os.system [x]\n",
    ):  # fmt: skip
        answer = tab.client.post(f"/api/{tab.id}/back", json={"version": before["version"], "to": 0, "job_text": text})
        assert (answer.status_code, answer.json()["kind"]) == (422, "input"), text[:40]
        assert SECRET not in answer.text
    assert tab.state()["job_text"] == before["job_text"]


def test_a_job_file_that_is_a_link_is_not_read(
    served: Served, client: httpx.Client, tmp_path: Path, outside: Path
) -> None:
    folder = served.server.folder.path / tmp_path.name
    write(folder, "small.json", SMALL)
    (folder / "small.job.yaml").symlink_to(outside / "secret.job.yaml")
    answer = client.post("/api/open", json={"nest": f"{tmp_path.name}/small.json"})
    assert answer.status_code == 422
    assert SECRET not in answer.text
    assert "a link that leads out of the folder" in answer.json()["message"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no such files")
@pytest.mark.parametrize(
    ("job", "beside"),
    [
        ("profile: pipe.yaml\n", ""),
        ("profile: ours.yaml\n", "based_on: pipe.yaml\n"),
        ("profile: ours.yaml\n", "machine:\n  dialect: pipe.yaml\n"),
        ("profile: ours.yaml\n", "models: [pipe.mzn]\n"),
        ("profile: /dev/zero\n", ""),
        ("profile: folder.yaml\n", ""),
    ],
)
def test_a_pipe_holds_nobody_up(served: Served, client: httpx.Client, tmp_path: Path, job: str, beside: str) -> None:
    folder = served.server.folder.path / tmp_path.name
    write(folder, "small.json", SMALL)
    write(folder, "small.job.yaml", job)
    write(folder, "ours.yaml", beside)
    (folder / "folder.yaml").mkdir()
    for name in ("pipe.yaml", "pipe.mzn", "pipe.json"):
        os.mkfifo(folder / name)
    told = refusal(client, f"{tmp_path.name}/small.json")
    assert "not read: it" in told or "there is no file" in told
    assert client.post("/api/open", json={"nest": f"{tmp_path.name}/pipe.json"}).status_code == 422
    (folder / "small.job.yaml").unlink()
    os.mkfifo(folder / "small.job.yaml")
    answer = client.post("/api/open", json={"nest": f"{tmp_path.name}/small.json"})
    assert answer.status_code == 200  # a job file is a file


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no such files")
def test_a_pipe_in_the_place_of_a_job_file_or_an_output_holds_nobody_up(opened: Open) -> None:
    """The job file is what somebody has edited here; whether a pipe is written over or refused, it is not read."""
    tab = opened()
    tab.solved()
    os.mkfifo(tab.nest.with_name("small.job.yaml"))
    tab.edit({"lock": "C.outer last"})
    assert tab.solved()["problem"] == ""
    for name in ("small.plan.json", "small.nc", "small.svg"):
        os.mkfifo(tab.nest.with_name(name))
    answer = tab.client.post(f"/api/{tab.id}/save", json={"version": tab.version})
    assert answer.status_code in (200, 422), answer.text
    assert tab.state()["locked"] == ["C.outer last"]


@pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="Windows cannot stop a process")
def test_a_question_has_a_limit_of_time(opened: Open, served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is given up, and the next one is answered by another process."""
    tab = opened()
    tab.solved()
    tab.get("why", contour="C.outer")  # nothing else is asked of the process any more
    os.kill(served.server.desk.pid or os.getpid(), signal.SIGSTOP)
    monkeypatch.setattr("kerfwise.apps.viewer.serve.server.ANSWERED_S", 0.05)
    answer = tab.client.post("/api/open", json={"nest": f"{tab.nest.parent.name}/{tab.nest.name}", "repair": True})
    assert (answer.status_code, answer.json()["kind"]) == (422, "slow")
    monkeypatch.undo()
    assert tab.get("why", contour="C.outer")["text"]


def test_a_list_says_how_many_it_leaves_out(served: Served, client: httpx.Client, tmp_path: Path) -> None:
    folder = served.server.folder.path / tmp_path.name
    folder.mkdir()
    for k in range(700):
        (folder / f"many{k}.dxf").touch()
    served.listed(*(f"{tmp_path.name}/many{k}.dxf" for k in range(700)))
    seen: list[str] = []
    while True:
        told = client.get("/api/nests", params={"find": f"{tmp_path.name}/MANY", "from": len(seen)}).json()
        if not told["complete"]:
            continue
        seen += told["nests"]
        if told["left"] == 0:
            break
    assert told["found"] == 700
    assert seen == [f"{tmp_path.name}/many{k}.dxf" for k in range(700)]
    assert all(row["size"] == 0 and row["plans"] == 0 for row in told["rows"])


def test_what_is_answered_names_no_other_drawing(opened: Open) -> None:
    """A name that looks like an option is none on the command line that the viewer shows."""
    tab = opened(SMALL, "-x.json")
    assert tab.solved()["alternatives"][0]["command"].startswith("kerfwise solve ./-x.json")
    assert json.loads(tab.client.get(f"/api/{tab.id}/state").text)["nest"].endswith("/-x.json")
