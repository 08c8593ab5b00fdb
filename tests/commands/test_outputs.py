"""Files and exit code are the same whatever becomes of what is printed, and no file is lost to another."""

from __future__ import annotations

import contextlib
import errno
import io
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.cli import main
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.commands.test_boundary import PLAIN
from kerfwise.tests.tools.amount import rows

EXAMPLES = Path(package.__file__).parent / "examples" / "nests"
SOLVE = ("solve", "plain.json", "--work", "0.1")
WRITTEN = ["plain.nc", "plain.plan.json", "plain.svg"]


@pytest.fixture(autouse=True)
def nest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "plain.json"
    path.write_text(json.dumps(PLAIN))
    return path


class Fails(io.StringIO):
    """A stream that takes no more from some write on."""

    def __init__(self, moment: int, error: OSError) -> None:
        super().__init__()
        self.left, self.error = moment, error

    def write(self, text: str) -> int:
        if self.left <= 0:
            raise self.error
        self.left -= 1
        return super().write(text)


def code_with(out: io.StringIO, err: io.StringIO, *argv: str) -> int:
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), pytest.raises(SystemExit) as end:
        main(list(argv))
    assert isinstance(end.value.code, int)
    return end.value.code


GONE, FULL = BrokenPipeError(errno.EPIPE, "Broken pipe"), OSError(errno.ENOSPC, "No space left")
MOMENTS = [(0, GONE), (3, FULL), (4, FULL), (1, FULL), (5, GONE), (9, GONE)]
"""Those that always run: before anything is printed, the last that is told and the first that is not, and between."""
LATER = [(moment, error) for moment in range(12) for error in (GONE, FULL) if (moment, error) not in MOMENTS]


@pytest.mark.parametrize(("moment", "error"), rows([*MOMENTS, *LATER], len(MOMENTS)))
def test_what_is_printed_decides_nothing(moment: int, error: OSError, tmp_path: Path) -> None:
    err = io.StringIO()
    assert code_with(Fails(moment, error), err, *SOLVE) == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["plain.json", *WRITTEN]
    assert ("No space left" in err.getvalue()) == (error.errno == errno.ENOSPC and moment < 4)
    for stream in (Fails(moment, error), None):
        assert code_with(stream, stream, "check", "plain.json", "plain.nc") == 0  # type: ignore[arg-type]
    turned = (tmp_path / "plain.nc").read_text().replace("M3 $0 S1", "M5 $0", 1)
    (tmp_path / "broken.nc").write_text(turned)
    assert code_with(Fails(moment, error), Fails(0, error), "check", "plain.json", "broken.nc") in (1, 2)


STREAMS = (
    ("engines", ">/dev/full", 0),
    ("engines", ">/dev/full 2>/dev/full", 0),
    ("engines", ">&- 2>&- <&-", 0),
    ("engines", "| head -c 1 >/dev/null", 0),
    ("facts plain.json", ">/dev/full", 2),
    ("facts plain.json", ">/dev/full 2>&-", 2),
    ("facts plain.json", "2>&- | head -c 1 > /dev/null", 0),
)
"""`facts` prints what it makes, `engines` only tells."""


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="Linux")
@pytest.mark.parametrize(("argv", "redirected", "code"), STREAMS)
def test_real_streams_that_take_nothing(argv: str, redirected: str, code: int, tmp_path: Path) -> None:
    """Python's own last flush included."""
    line = f"set -o pipefail; {sys.executable} -m kerfwise.cli {argv} {redirected}"
    ended = subprocess.run(["bash", "-c", line], capture_output=True, text=True, check=False)
    assert ended.returncode == code, ended
    assert "Traceback" not in ended.stderr
    assert "Exception ignored" not in ended.stderr
    assert sorted(p.name for p in tmp_path.iterdir()) == ["plain.json"]


@pytest.mark.slow
def test_a_closed_stream_gives_its_number_to_no_file(tmp_path: Path) -> None:
    line = f"{sys.executable} -m kerfwise.cli {' '.join(SOLVE)} >&- 2>&-"
    assert subprocess.run(["bash", "-c", line], check=False).returncode == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["plain.json", *WRITTEN]
    assert "holds" not in (tmp_path / "plain.nc").read_text()
    assert kerfwise("check", "plain.json", "plain.nc").code == 0


def test_every_file_that_is_read_is_kept(tmp_path: Path) -> None:
    (tmp_path / "control.yaml").write_text(kerfwise("dialects", "show", "linuxcnc-qtplasmac").out)
    (tmp_path / "far.yaml").write_text("based_on: plasma-carbon-steel\n")
    (tmp_path / "near.yaml").write_text("based_on: far.yaml\nname: near\n")
    (tmp_path / "rule.mzn").write_text("constraint true;\n")
    profile = tmp_path / "plant.yaml"
    profile.write_text(
        "based_on: near.yaml\nname: plant\nmachine: {dialect: control.yaml}\n"
        "own_rules:\n  - {file: rule.mzn, why: it is so, strength: off}\n"
    )
    assert kerfwise(*SOLVE, "-p", profile).code == 0
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    read = ("plain.json", "plant.yaml", "near.yaml", "far.yaml", "control.yaml", "rule.mzn")
    for name in read:
        os.symlink(name, f"{name}.svg")
        for argv in (
            (*SOLVE, "-p", profile, "-o", name),
            (*SOLVE, "-p", profile, "--plan", name),
            (*SOLVE, "-p", profile, "-o", "x.nc", "--picture", f"{name}.svg"),
            (*SOLVE, "-p", profile, "-o", "x.nc", "--conflict-picture", f"{name}.svg"),
            ("plot", "plain.json", "-p", profile, "-o", f"{name}.svg"),
        ):
            ended = kerfwise(*argv)
            assert (ended.code, "is read from" in ended.err) == (2, True), (argv, ended)
        os.unlink(f"{name}.svg")
    os.symlink("plain.plan.json", "plan.svg")
    assert "is read from" in kerfwise("plot", "plain.json", "plain.plan.json", "-p", profile, "-o", "plan.svg").err
    os.unlink("plan.svg")
    os.symlink("plain.json", "facts.json")
    assert "is read from" in kerfwise("facts", "plain.json", "-o", "facts.json").err
    os.unlink("facts.json")
    os.symlink("plain.nc", "heat.png")
    assert "is read from" in kerfwise("heat", "plain.json", "plain.nc", "-o", "heat.png").err
    os.unlink("heat.png")
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_nests_of_one_stem_do_not_take_each_others_files(tmp_path: Path) -> None:
    assert kerfwise(*SOLVE).code == 0
    assert kerfwise(*SOLVE).code == 0  # of the same nest, they are the next generation
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    (tmp_path / "plain.dxf").write_bytes((EXAMPLES / "e1x_6.dxf").read_bytes())
    for gone, left in ((), "plain.plan.json"), (("plain.plan.json",), "plain.nc"), (("plain.nc",), "plain.svg"):
        for name in gone:
            (tmp_path / name).unlink()
        ended = kerfwise("solve", "plain.dxf", "--work", "0.1")
        assert ended.code == 2
        assert f"{left}: is " in ended.err
        assert "name the outputs" in ended.err
        assert (tmp_path / left).read_bytes() == before[tmp_path / left]
    assert kerfwise("solve", "plain.dxf", "--work", "0.1", "-o", "plain.nc").code == 0


def test_a_drawing_beside_a_nest_of_its_name_is_no_picture_to_write_over(tmp_path: Path) -> None:
    drawn = (EXAMPLES / "marked.svg").read_bytes()
    (tmp_path / "plain.svg").write_bytes(drawn)
    ended = kerfwise(*SOLVE)
    assert (ended.code, "plain.svg: is no picture of plain.json" in ended.err) == (2, True)
    assert (tmp_path / "plain.svg").read_bytes() == drawn


def test_a_first_plan_is_written_before_its_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    before_picture: list[str] = []

    def interrupted(*given: object) -> bytes:
        before_picture.extend(sorted(path.name for path in Path().glob("plain.*")))
        raise KeyboardInterrupt

    monkeypatch.setattr("kerfwise.commands.page_picture.planned_picture", interrupted)
    ended = kerfwise(*SOLVE, "--first")
    assert (ended.code, before_picture) == (130, ["plain.json", "plain.nc", "plain.plan.json"])
    assert ended.out.endswith("written: plain.nc, plain.plan.json\n")
    assert kerfwise("check", "plain.json", "plain.nc").code == 0
