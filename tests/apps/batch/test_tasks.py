"""Which files are nests, and which names they get."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from kerfwise import InputError
from kerfwise.apps.batch.tasks import (
    LOOK_S,
    SETTLED_S,
    Machines,
    Settling,
    Source,
    keep_on,
    machine_of,
    name_sources,
    sources_in,
    watch,
)
from kerfwise.tests.apps.batch.nests import write_nests


def names(given: list[Path], out: Path) -> list[str]:
    return [source.name for source in sources_in(given, out)]


def test_nests_of_folders_and_files_each_once_and_nothing_else(tmp_path: Path) -> None:
    folder = write_nests(tmp_path / "in", ("one", "more/four"))
    (folder / "one.plan.json").write_text('{\n "format": "kerfwise-plan/1",\n "nest": {}}')
    (folder / "one.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg"><title>one</title><g id="sheet"></g></svg>'
    )
    (folder / "drawn.SVG").write_text("<svg/>")
    (folder / ".hidden.json").write_text("{}")
    (folder / "letter.txt").write_text("no nest")
    (folder / "out").mkdir()
    (folder / "out" / "one.json").write_text("{}")
    assert names([folder], folder / "out") == ["drawn", "more/four", "one"]
    assert names([folder / "one.json", folder], folder / "out") == ["one", "drawn", "more/four"]
    assert names([folder / "more"], tmp_path / "elsewhere") == ["four"]


@pytest.mark.parametrize(
    ("name", "said"), [("gone.json", "there is no such file or folder"), ("a.txt", "no nest ends so")]
)
def test_what_is_no_nest_is_refused_where_it_is_named(name: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("")
    with pytest.raises(InputError, match=said):
        sources_in([tmp_path / name], tmp_path / "out")


def files(tmp_path: Path, *names: str) -> list[Source]:
    found = []
    for name in names:
        file = tmp_path / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(name)
        found.append(Source(file, file.stem))
    return found


def test_no_two_nests_have_one_name(tmp_path: Path) -> None:
    given = files(tmp_path, "mon/a.dxf", "tue/a.dxf", "tue/A.json", "tue/a-2.dxf", "wed/ä.dxf", "wed/a\u0308.svg")
    made = name_sources(given, {})
    assert list(made) == ["a", "a-2", "A-3", "a-2-2", "ä", "a\u0308-2"]
    assert list(made.values()) == given


def test_a_nest_keeps_the_name_that_it_had(tmp_path: Path) -> None:
    first, second = files(tmp_path, "mon/a.dxf", "tue/a.dxf")
    assert name_sources([first, second], {"a": second.file}) == {"a-2": first, "a": second}
    assert name_sources([first], {"a": second.file}) == {"a-2": first}, (
        "the other nest is not in this run, but is still there"
    )
    os.unlink(second.file)
    assert name_sources([first], {"a": second.file}) == {"a": first}, "the folder has moved: it is the same nest"


def test_a_file_is_settled_when_size_and_time_have_stood() -> None:
    settling, file = Settling(), Path("a.dxf")
    assert settling.settled({file: (10, 1)}, 0.0) == {}
    assert settling.settled({file: (20, 1)}, SETTLED_S) == {}, "it has grown"
    assert settling.settled({file: (20, 2)}, 2 * SETTLED_S) == {}, "it was written again"
    assert settling.settled({file: (20, 2)}, 3 * SETTLED_S) == {file: (20, 2)}
    assert settling.settled({}, 4 * SETTLED_S) == {}
    assert settling.settled({file: (20, 2)}, 5 * SETTLED_S) == {}, "it was gone meanwhile"


class Ends(Exception):
    """Ends a watch."""


class Time:
    """A clock that goes on while somebody sleeps; something happens at each look."""

    def __init__(self, happens: list[Callable[[], object]]) -> None:
        self.now_s, self.happens = 0.0, happens

    def sleep(self, seconds: float) -> None:
        self.now_s += seconds
        if not self.happens:
            raise Ends
        self.happens.pop(0)()


def nothing() -> None:
    pass


def test_each_change_is_a_round(tmp_path: Path) -> None:
    a, b = tmp_path / "a.dxf", tmp_path / "b.dxf"
    looks = int(SETTLED_S / LOOK_S)
    wait: list[Callable[[], object]] = [nothing] * (looks + 1)
    happens: list[Callable[[], object]] = [
        lambda: a.write_text("half"),
        lambda: a.write_text("whole"),
        *wait,
        lambda: b.write_text("b"),
        *wait,
        lambda: os.utime(a, (1, 1)),
        *wait,
        a.unlink,
        *wait,
    ]
    time, rounds = Time(happens), []

    def arrived(files: frozenset[Path]) -> None:
        rounds.append(({file.name for file in files}, a.read_text() if a.exists() else ""))

    with pytest.raises(Ends):
        watch(lambda: tmp_path.glob("*.dxf"), arrived, clock=lambda: time.now_s, sleep=time.sleep)
    assert rounds == [
        ({"a.dxf"}, "whole"),
        ({"a.dxf", "b.dxf"}, "whole"),
        ({"a.dxf", "b.dxf"}, "whole"),
        ({"b.dxf"}, ""),
    ]


def test_a_profile_that_is_broken_meanwhile_is_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "a.dxf").write_text("a")
    plant = tmp_path / "plant.yaml"
    good = "based_on: plasma-carbon-steel\nname: plant\n"
    plant.write_text(good)
    wait: list[Callable[[], object]] = [nothing] * (int(SETTLED_S / LOOK_S) + 1)
    time = Time(
        [*wait, lambda: plant.write_text(f"{good}rulez: 1\n"), *wait, lambda: plant.write_text(f"{good}\n"), *wait]
    )
    told: list[str] = []
    rounds: list[tuple[int, str]] = []

    def one_round(sources: object, machines: Machines) -> None:
        rounds.append((len(sources), machines.named[0].sha256))  # type: ignore[arg-type]

    monkeypatch.setattr("kerfwise.apps.batch.tasks.watch", lambda files, arrived: watch(
        files, arrived, clock=lambda: time.now_s, sleep=time.sleep))  # fmt: skip
    with pytest.raises(Ends):
        keep_on(
            [tmp_path / "in"], tmp_path / "out", Machines((machine_of("m", str(plant), False),)), one_round, told.append
        )  # type: ignore[arg-type]
    assert [text.partition(": ")[0] for text in told] == [f"{plant}:3:1"]
    assert len({sha256 for _, sha256 in rounds}) == 2
    assert rounds[0][0] == rounds[-1][0] == 1


def test_a_profile_that_a_job_file_names_is_looked_at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "a.dxf").write_text("a")
    (tmp_path / "in" / "a.job.yaml").write_text("profile: ../plant.yaml\n")
    plant, other = tmp_path / "plant.yaml", tmp_path / "other.yaml"
    good = "based_on: plasma-carbon-steel\nname: plant\n"
    plant.write_text(good)
    other.write_text(good)
    wait: list[Callable[[], object]] = [nothing] * (2 * int(SETTLED_S / LOOK_S) + 3)
    happens = [
        *wait,
        lambda: plant.write_text(f"{good}# again\n"),
        *wait,
        lambda: (tmp_path / "in" / "a.job.yaml").write_text("profile: ../other.yaml\n"),
        *wait,
        lambda: plant.write_text(good),  # nobody names it any more
        *wait,
        lambda: other.write_text(f"{good}rulez: 1\n"),
        *wait,
        lambda: other.write_text(good),
        *wait,
    ]
    happened, rounds = len(happens), list[int]()
    time = Time(happens)

    def one_round(sources: object, machines: Machines) -> None:
        rounds.append(len(happens))

    monkeypatch.setattr("kerfwise.apps.batch.tasks.watch", lambda files, arrived: watch(
        files, arrived, clock=lambda: time.now_s, sleep=time.sleep))  # fmt: skip
    with pytest.raises(Ends):
        keep_on([tmp_path / "in"], tmp_path / "out", Machines(), one_round, print)  # type: ignore[arg-type]
    each = len(wait) + 1
    after = [happened - left for left in rounds]
    assert [k // each for k in after] == [0, 1, 2, 4, 5], "one after each change, and none after that of plant.yaml"
