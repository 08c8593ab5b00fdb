"""What MiniZinc has compiled, kept between runs by content: the same rule on the same nest is compiled once.

It is kept in the folder `kerfwise/rules` of the user's cache. What cannot be read or written there is done without.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
import zlib
from functools import cache
from pathlib import Path

from kerfwise.encoder.sealed_files import DamagedFile, read_sealed, write_sealed
from kerfwise.rules.minizinc.trial import version_of

from .compiler import HERE, Compiled, compile_model, minizinc_program
from .model_file import ModelFile, files_read

MOST_FILES = 2000
MOST_BYTES = 200_000_000
"""What is kept at the most; the oldest goes first."""


def compiled(file: ModelFile, text: str) -> Compiled:
    """MiniZinc text that includes the rule file, compiled, or what was kept of it.

    Raises
    ------
    InputError
        As `compile_model`; mistakes are not kept.
    """
    maker, folder = _maker(minizinc_program()), cache_folder()
    if folder is None:
        return compile_model(text, file.path)
    key = _key(file, text)
    path = folder / f"{key}.flat"
    if (known := _read(path, maker)) is not None:
        return known
    made = compile_model(text, file.path)
    if _key(file, text) != key:  # somebody has just changed a file
        return made
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        write_sealed(path, maker, zlib.compress(json.dumps([made.flat, made.printed]).encode(), 3))
        _leave_room(folder)
    return made


def cache_folder() -> Path | None:
    """Where compiled rules are kept: below `$XDG_CACHE_HOME`, else `~/.cache`; on Windows below `%LOCALAPPDATA%`.

    None where there is no such place.
    """
    home = os.environ.get("LOCALAPPDATA" if sys.platform == "win32" else "XDG_CACHE_HOME")
    try:
        return (Path(home) if home else Path.home() / ".cache") / "kerfwise" / "rules"
    except RuntimeError:
        return None


def _key(file: ModelFile, text: str) -> str:
    """The digest of a model and of the files that it reads, wherever these lie."""
    for place in (file.path.resolve(), HERE):
        text = text.replace(place.as_posix(), "")
    said = "\0".join([text, *files_read(file).values()])
    return hashlib.sha256(said.encode("utf-8", "surrogatepass")).hexdigest()


@cache
def _maker(program: str) -> bytes:
    """The digest of what compiles: MiniZinc's version, and kerfwise's own model files."""
    own = [path.read_text(encoding="utf-8") for path in sorted([*HERE.rglob("*.mzn"), HERE.parent / _FACTS])]
    return hashlib.sha256("\0".join([version_of(program), *own]).encode()).digest()


_FACTS = Path("minizinc", "facts.mzn")


def _read(path: Path, maker: bytes) -> Compiled | None:
    with contextlib.suppress(DamagedFile, ValueError, zlib.error, OSError):
        content = read_sealed(path, maker)
        if content is not None:
            flat, printed = json.loads(zlib.decompress(content))
            os.utime(path)
            return Compiled(flat, tuple((name, value) for name, value in printed))
    return None


def _leave_room(folder: Path) -> None:
    """Remove what was not used for longest, where there is too much."""
    found = []
    for path in folder.glob("*.flat"):
        with contextlib.suppress(OSError):
            found.append((path.stat().st_mtime, path.stat().st_size, path))
    size, count = sum(size for _, size, _ in found), len(found)
    for _, own, path in sorted(found):
        if count <= MOST_FILES and size <= MOST_BYTES:
            return
        with contextlib.suppress(OSError):
            path.unlink()
        size, count = size - own, count - 1
