"""Which files are nests, and which names they get."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from kerfwise.apps.batch.tasks import Source, name_sources, sources_in
from kerfwise.encoder.errors import InputError
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
