"""kerfwise batch: as a planner runs it, killed, started twice, given what cannot be."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from kerfwise.tests.apps.batch.nests import write_nests
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.tools.amount import full
from kerfwise.tests.tools.killing import COUNTED

BATCH = ("batch", "in", "-o", "out", "--work", "0.2", "-p", "a=plasma-carbon-steel", "-p", "b=laser-amg3m-1mm")
KILLED = f"""
{COUNTED}
import multiprocessing.spawn  # knows the interpreter from here on
from kerfwise.cli import main
from kerfwise.apps.batch import reports as papers, run, store
from kerfwise.postproc import output_files as files
sys.executable = ""  # no process beside it goes on: a kill ends all, as a power cut does
store.write_files = papers.write_files = run.write_files = counted(files.write_files)
main()
"""
"""Killed before the writing of so many sets of files: those of each nest, each machine's work sheets, the index."""
KILLED_IN_WRITING = KILLED.replace(
    "store.write_files = papers.write_files = run.write_files =", "os.replace ="
).replace("files.write_files", "os.replace")
"""Killed before so many files have taken their places."""
DIES = """
from kerfwise.cli import main
from kerfwise.apps.batch import run
from kerfwise.tests.commands.dies import dies_at_one
run.plan_task = dies_at_one
main()
"""
"""The process that plans the nest `one` is killed."""


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["gone", "-o", "out"], "gone: there is no such file or folder"),
        (["letter.txt", "-o", "out"], "letter.txt: no nest ends so: expected a folder, or a file in .dxf, .json, .svg"),
        (["empty", "-o", "out"], "empty: holds no nest"),
        (["in"], "Missing option '-o'"),
        (["-o", "out"], "Missing argument 'IN…'"),
        (["in", "-o", "in"], "in: is read from, and cannot be the folder of the programs"),
        (["in", "-o", "letter.txt"], "letter.txt: this is a file: give the batch a folder with -o"),
        (["in", "-o", "."], ".: holds files that no batch wrote"),
        (["in", "-o", "out", "-p", "no-such"], "no-such"),
        (["in", "-o", "out", "-p", "../x=plasma-carbon-steel"], "'../x' is no name for a machine"),
        (["in", "-o", "out", "-p", "A=laser-wood", "-p", "a=laser-wood"], "two machines have the name 'a'"),
        (["in", "-o", "out", "--jobs", "0"], "--jobs"),
        (["in", "-o", "out", "--jobs", "2", "--scheduler", "tcp://127.0.0.1:1"], "--jobs is for this machine"),
        (["in", "-o", "out", "--time-limit", "soon"], "--time-limit"),
        (["in", "-o", "out", "--tidy", "--watch"], "--tidy is for one run"),
    ],
)
def test_what_cannot_be_is_one_message(given: list[str], said: str) -> None:
    write_nests(Path("in"), ("one",))
    Path("empty").mkdir()
    Path("letter.txt").write_text("x")
    ended = kerfwise("batch", *given)
    assert ended.code == 2, ended.out
    assert said in ended.err
    assert "Traceback" not in ended.err
    assert not Path("out").exists()


@pytest.mark.slow
def test_a_folder_on_two_machines() -> None:
    write_nests(Path("in"), ("one", "two", "off the sheet"))
    ended = kerfwise(*BATCH, "--jobs", 1)
    assert (ended.code, ended.err) == (1, ""), "quiet in a pipe"
    rows = ended.out.splitlines()
    assert [row.split()[:3] for row in rows[1:3]] == [["a", "2", "1"], ["b", "2", "1"]]
    assert rows[3].startswith("The nest cannot be cut as it is drawn. Mend the drawing")
    assert rows[-2:] == ["4 of 6 planned", f"index: {Path('out', 'index.html')}"]
    again = kerfwise(*BATCH)
    assert (again.code, again.out.splitlines()[-2]) == (1, "4 of 6 planned, 6 finished before")
    Path("in", "off the sheet.json").unlink()
    assert kerfwise(*BATCH).code == 0


def made() -> dict[str, bytes]:
    """Every file of the batch, but for what is left of a write that was killed."""
    found = (path for path in Path("out").rglob("*") if path.is_file() and not path.name.startswith(".kerfwise-"))
    return {str(path): path.read_bytes() for path in found}


MOMENTS = ((KILLED_IN_WRITING, 12), (KILLED, 6), (KILLED, 2), (KILLED, 7), (KILLED_IN_WRITING, 3))
"""The second is between the two PDFs, the fourth before the index."""


@pytest.mark.parametrize("moments", [MOMENTS[:1], full(MOMENTS[1:])], ids=["one", "others"])
@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="SIGKILL")
def test_killed_at_some_moment_and_started_again(moments: tuple[tuple[str, int], ...]) -> None:
    write_nests(Path("in"), ("one", "off the sheet"))
    sheets = (*BATCH, "--sheets")
    assert kerfwise(*sheets).code == 1
    whole = made()
    assert len(whole) == 2 * 5 + 2 + 2 * 2 + 3 + 1
    for program, moment in moments:
        shutil.rmtree("out")
        command = [sys.executable, "-c", program, str(moment), *sheets]
        assert subprocess.run(command, capture_output=True, check=False).returncode == -signal.SIGKILL
        for left in Path("out").rglob(".kerfwise-moves.json"):  # as if some time had gone by
            os.utime(left, (time.time() - 100, time.time() - 100))
        left_over = len(list(Path("out").rglob("*.batch.json")))
        ended = kerfwise(*sheets)
        assert ended.code == 1, ended.err
        assert made() == whole
        finished = [row for row in ended.out.splitlines() if row.startswith("2 of 4 planned")]
        assert finished == [f"2 of 4 planned, {left_over} finished before" if left_over else "2 of 4 planned"]
    Path("in", "one.job.yaml").write_text("order: A-77\n")
    command = [sys.executable, "-c", KILLED, "2", *sheets]
    assert subprocess.run(command, capture_output=True, check=False).returncode == -signal.SIGKILL
    assert not list(Path("out").glob("*.pdf")), "nobody cuts by an old sheet"


@pytest.mark.full
@pytest.mark.skipif(os.name != "posix", reason="SIGINT")
def test_watched_until_ctrl_c() -> None:
    write_nests(Path("in"), ("one",))
    heard = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"  # ignored in the background
    program = f"{heard}; from kerfwise.cli import main; main()"
    command = [sys.executable, "-c", program, "batch", "in", "-o", "out", "--work", "0.2", "--watch"]
    running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    patience = threading.Timer(600, running.kill)
    patience.start()
    assert running.stdout is not None
    rounds = []
    for line in running.stdout:
        if " planned" in line and not line.startswith("machine"):
            rounds.append(line.strip())
            if len(rounds) == 2:
                break
            write_nests(Path("in"), ("two",))
    running.send_signal(signal.SIGINT)
    _, err = running.communicate()
    patience.cancel()
    assert rounds == ["1 of 1 planned", "2 of 2 planned, 1 finished before"]
    assert (running.returncode, err.strip()) == (130, "")
    assert sorted(path.stem for path in Path("out").rglob("*.nc")) == ["one", "two"]


@pytest.mark.skipif(os.name != "posix", reason="SIGKILL")
@pytest.mark.full
def test_a_process_that_is_killed_is_a_fault_of_one_nest_with_a_report() -> None:
    write_nests(Path("in"), ("one", "two"))
    command = [sys.executable, "-c", DIES, "batch", "in", "-o", "out", "--work", "0.2", "--jobs", "1"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 70, ended.stderr
    assert "1 of 2 planned" in ended.stdout
    (said,) = ended.stderr.splitlines()
    assert said.startswith(
        "one on plasma-carbon-steel: a fault of kerfwise itself: Died: the process that worked on it"
    )
    assert len(list(Path().glob("kerfwise-fault-*.txt"))) == 1
    assert kerfwise("batch", "in", "-o", "out", "--work", "0.2").code == 0
