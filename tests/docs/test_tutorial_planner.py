"""docs/tutorial-planner.md: each command runs as it stands there, in order, and prints what stands below it.

`python -m kerfwise.tests.docs.test_tutorial_planner` goes through the page in a folder of its own and makes its picture
again.
"""

from __future__ import annotations

import os
import re
import shlex
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise import load_profile, read_nest
from kerfwise.examples import gen_morning
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.metal.plant import plant
from kerfwise.tests.metal.simulate import simulate

ROOT = Path(package.__file__).resolve().parent
PAGE = (ROOT / "docs" / "tutorial-planner.md").read_text(encoding="utf-8")
PICTURE = ROOT / "docs" / "tutorial-planner.svg"
PROGRAMS = {
    f"out/{machine}/{nest}.nc"
    for machine in ("plasma", "laser")
    for nest in gen_morning.drawings()
    if (machine, nest) != ("plasma", "rib")
}
"""The ribs are for the laser alone."""
_BLOCK = re.compile(r"^```(yaml|console)\n(.*?)^```", re.MULTILINE | re.DOTALL)
_NAMED = re.compile(r"`([\w./]+\.yaml)`")


def blocks() -> Iterator[tuple[str, str]]:
    """What is done, in order: the name of a file with its text, or a command with what it prints."""
    for block in _BLOCK.finditer(PAGE):
        if block[1] == "yaml":
            yield _NAMED.findall(PAGE[: block.start()])[-1], block[2]
        else:
            for part in re.split(r"^(?=\$ )", block[2], flags=re.MULTILINE)[1:]:
                command, _, printed = part.partition("\n")
                yield command, printed


def run(command: str, arguments: list[str]) -> str:
    """What a command of the page prints, with its exit code where that is not 0."""
    if command == "kerfwise":
        ended = kerfwise(*arguments)
        return ended.out + (f"[exit code {ended.code}]\n" if ended.code else "")
    assert (command, arguments[0]) == ("python", "kerfwise/examples/gen_morning.py")
    drawn = gen_morning.draw(Path(arguments[1]), mended="--mended" in arguments)
    return f"{drawn} drawings in {arguments[1]}\n"


def missing(shown: str, printed: str) -> str:
    """The first piece of what is shown that was not printed there; pieces are apart by a line with three points."""
    at = 0
    for k, piece in enumerate(re.split(r"^…\n", shown, flags=re.MULTILINE)):
        found = printed.find(piece, at)
        if found < 0 or (k == 0 and found > 0):
            return piece
        at = found + len(piece)
    return "" if at == len(printed) else printed[at:]


def walk() -> Iterator[tuple[str, str, str]]:
    """Go through the page in this folder: each command, what the page shows, and what was printed."""
    for what, text in blocks():
        if what.startswith("$ "):
            command, *arguments = shlex.split(what[2:])
            yield what, text, run(command, arguments)
        else:
            Path(what).parent.mkdir(exist_ok=True)
            Path(what).write_text(text, encoding="utf-8")


def of_batch() -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in Path("out").rglob("*") if path.is_file()}


def burnt(name: str) -> list[str]:
    """What the simulation finds in a program of the batch, which other processes made."""
    machine, program = Path(name).parts[-2:]
    profile = load_profile(f"plants/{machine}.yaml")
    drawn = read_nest(Path("nests", program).with_suffix(".dxf"), profile=profile)
    return [str(found) for found in simulate(drawn, Path(name).read_text(encoding="utf-8"), **plant(profile))]


@pytest.mark.slow
def test_the_whole_page_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    before: dict[str, bytes] = {}
    walked = []
    for command, shown, printed in walk():
        assert missing(shown, printed) == "", f"{command}\n{printed}"
        before, last = of_batch(), before
        walked.append(command)
    assert len(walked) == PAGE.count("\n$ ") == 9
    assert before == last, "the second run changes nothing"
    assert {Path(name).name for name in before if name.endswith(".pdf")} == {"plasma.pdf", "laser.pdf"}
    assert Path("both.svg").read_text(encoding="utf-8") == PICTURE.read_text(encoding="utf-8")
    assert {name: burnt(name) for name in before if name.endswith(".nc")} == {name: [] for name in PROGRAMS}


def test_the_script_is_run_as_a_reader_does(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.MonkeyPatch.context() as patched:
        patched.chdir(tmp_path)
        for more, said in (([], "10 drawings in nests\n"), (["--mended"], "2 drawings in nests\n")):
            patched.setattr(sys, "argv", ["gen_morning.py", "nests", *more])
            gen_morning.main()
            assert capsys.readouterr().out == said
    assert len(list((tmp_path / "nests").glob("*.dxf"))) == 10


def test_the_drawings_are_the_same_each_time(tmp_path: Path) -> None:
    for folder in ("a", "b"):
        gen_morning.draw(tmp_path / folder)
    assert all(path.read_bytes() == (tmp_path / "b" / path.name).read_bytes() for path in (tmp_path / "a").iterdir())


@pytest.mark.parametrize(
    ("shown", "printed", "left"),
    [
        ("a\nb\n", "a\nb\n", ""),
        ("a\n…\nc\n", "a\nb\nc\n", ""),
        ("…\nc\n", "a\nb\nc\n", ""),
        ("a\n", "a\nb\n", "b\n"),
        ("b\n", "a\nb\n", "b\n"),
        ("c\n…\na\n", "a\nb\nc\n", "c\n"),
    ],
)
def test_what_is_shown_and_not_printed_is_found(shown: str, printed: str, left: str) -> None:
    assert missing(shown, printed) == left


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for _, _, said in walk():
            print(said, end="")
        PICTURE.write_bytes(Path("both.svg").read_bytes())
