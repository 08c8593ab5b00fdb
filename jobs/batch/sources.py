"""The nests of a batch: the files that are found, and a name for each in the folder of the batch."""

from __future__ import annotations

import os
import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from kerfwise.encoder.contents import is_file, is_folder
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.readers.read import SUFFIXES

_OWN = re.compile(rb'"format":\s*"kerfwise-(?!nest/)|<g id="sheet">')
"""What stands at the top of a file that kerfwise wrote and that is no nest: a plan, a picture."""
_HEAD_BYTES = 4000


@dataclass(frozen=True, slots=True)
class Source:
    """The file of a nest, and the name that it would have in the folder of the batch: its place, without the ending."""

    file: Path
    name: str


def sources_in(given: Iterable[Path], out: Path) -> tuple[Source, ...]:
    """Every nest among files and folders, once: in the order in which they are given, in folders by their names.

    In a folder a nest is a file that ends as one. Hidden files, plans and pictures that kerfwise wrote are passed over,
    and `out` where it lies in the folder. A folder that is given is read, also where it is `out` or lies in it.

    Raises
    ------
    InputError
        If there is no such file or folder, or a file is of another kind.
    """
    found: dict[Path, Source] = {}
    for place in given:
        if is_folder(place):
            of_place: Iterable[Source] = _under(place, out)
        elif not is_file(place):
            raise InputError("there is no such file or folder", file=place)
        elif place.suffix.lower() not in SUFFIXES:
            raise InputError(f"no nest ends so: expected a folder, or a file in {', '.join(SUFFIXES)}", file=place)
        else:
            of_place = [Source(place.resolve(), place.stem)]
        for source in of_place:
            found.setdefault(source.file, source)
    return tuple(found.values())


def _under(folder: Path, out: Path) -> Iterator[Source]:
    beside, found = out.resolve(), []
    for place, folders, files in os.walk(folder):
        here = Path(place)
        folders[:] = sorted(name for name in folders if name[0] != "." and (here / name).resolve() != beside)
        found += [here / name for name in files if name[0] != "." and Path(name).suffix.lower() in SUFFIXES]
    for file in sorted(found):
        if not _is_own(file):
            yield Source(file.resolve(), file.relative_to(folder).with_suffix("").as_posix())


def _is_own(file: Path) -> bool:
    try:
        with file.open("rb") as opened:
            return _OWN.search(opened.read(_HEAD_BYTES)) is not None
    except OSError:  # gone, or not to be read: the batch says so
        return False


def named(sources: Iterable[Source], before: Mapping[str, Path]) -> dict[str, Source]:
    """The sources by the names that they get, no two of which are one file name anywhere.

    A name that another file has already is given with -2, -3, … behind it. `before` are the names that an earlier run
    gave: a file keeps its name, and takes none whose file is still there.

    Examples
    --------
    >>> a, b = Source(Path("monday/a.dxf"), "a"), Source(Path("tuesday/a.dxf"), "a")
    >>> [(name, source.file.parent.name) for name, source in named([a, b], {}).items()]
    [('a', 'monday'), ('a-2', 'tuesday')]
    """
    sources = tuple(sources)
    had = {file: name for name, file in before.items()}
    kept = {source.file: had[source.file] for source in sources if source.file in had}
    taken = {_alike(name) for name, file in before.items() if file in kept or is_file(file)}
    names: dict[str, Source] = {}
    for source in sources:
        name, number = kept.get(source.file, source.name), 1
        while source.file not in kept and _alike(name) in taken:
            number += 1
            name = f"{source.name}-{number}"
        taken.add(_alike(name))
        names[name] = source
    return names


def _alike(name: str) -> str:
    """One text for all names that some system takes for one."""
    return unicodedata.normalize("NFC", name).casefold()
