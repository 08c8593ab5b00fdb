"""Output files: named after the nest, written whole, all of them or none; among them the remnant as a sheet."""

from __future__ import annotations

import contextlib
import html
import io
import json
import os
import re
import secrets
import shutil
import stat
import tempfile
import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import is_file, is_folder, is_there
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.json_nest import dxf_in_mm
from kerfwise.encoder.readers.read import SUFFIXES
from kerfwise.encoder.scrap import remnant_of
from kerfwise.rules.profile.values import ProfileValues

# Output files appear whole, all of them or none: written beside their places, which they then take one by one.


def expect_folders(paths: Iterable[Path]) -> None:
    """Say at once, and not after the work is done, that a file has no folder to be in.

    Raises InputError naming the file.
    """
    for path in paths:
        try:
            has_folder = path.parent.is_dir() and path.resolve().parent.is_dir()
        except (OSError, ValueError, RuntimeError) as error:  # too long, a NUL, a link to itself
            raise InputError(f"cannot write: no file can have this name ({error})", file=path) from None
        if not has_folder:
            raise InputError(f"cannot write: there is no folder {str(path.parent)!r}", file=path)


def expect_outputs(outputs: Iterable[Path], inputs: Iterable[Path]) -> None:
    """Say at once that files cannot be written, or that one would take the place of another, or of what is read.

    Raises InputError naming the file.
    """
    read = {place for path in inputs if (place := _resolved(path)) is not None}
    written: set[Path] = set()
    for path in outputs:
        expect_folders([path])
        place = path.resolve()
        if path.name == "-":
            raise InputError("cannot write: nothing goes to standard output; give the name of a file", file=path)
        _expect_regular(path)
        if place in read or _same_file(path, read):
            raise InputError("would be written over, and is read from: give the output another name", file=path)
        if place in written:
            raise InputError("two outputs have this name: give each its own", file=path)
        written.add(place)


def _expect_regular(path: Path) -> None:
    """Refuse what is there and no regular file: a folder, a device, a pipe."""
    try:
        kind = path.stat().st_mode
    except FileNotFoundError:
        return
    except (OSError, ValueError) as error:
        raise InputError(f"cannot write: no file can have this name ({_words(error)})", file=path) from None
    if stat.S_ISDIR(kind):
        raise InputError("cannot write: this is a folder; give the name of a file", file=path)
    if not stat.S_ISREG(kind):
        raise InputError("cannot write: this is a device or a pipe; give the name of a file", file=path)


def _resolved(path: Path) -> Path | None:
    """Where a file really is; None for a name that no file can have."""
    try:
        return path.resolve()
    except (OSError, ValueError, RuntimeError):
        return None


def _same_file(path: Path, others: Iterable[Path]) -> bool:
    """Whether a file is one of others by another name: a second name on disk, or other capitals where these are one."""
    if not is_there(path):
        return False
    for other in others:
        with contextlib.suppress(OSError):
            if os.path.samefile(path, other):
                return True
    return False


def expect_place(folder: Path) -> None:
    """Say at once that a folder cannot be made.

    Raises InputError if there is no folder to make it in, or a file is in its place.
    """
    expect_folders([folder])
    if is_there(folder) and not is_folder(folder):
        raise InputError("cannot make a folder there: it is a file", file=folder)


def make_folder(path: Path, parents: bool = False) -> None:
    """Make a folder, unless it is there, and with `parents` those that it is in.

    Raises InputError if it cannot be made.
    """
    try:
        path.mkdir(parents=parents, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot make a folder there: {error.strerror}", file=path) from None


def write_files(contents: Mapping[Path, str | bytes]) -> None:
    """Write all files, or none: each is written beside its place, and all take their places once they are on disk.

    A link is followed: the file that it leads to is written. Files of data (.json), such as the plan, come last, in the
    order given: where the command is killed between two of its files, a new plan says that the program is new, too.
    Raises InputError if a folder does not exist or may not be written, the disk is full, or a place is no regular file.
    """
    moves: list[_Move] = []
    try:
        for path, content in sorted(contents.items(), key=lambda item: item[0].suffix.lower() == ".json"):
            _expect_regular(path)
            place = path.resolve()
            _clear(place.parent)
            data = content if isinstance(content, bytes) else content.encode("utf-8")
            handle, name = tempfile.mkstemp(prefix=BESIDE, dir=place.parent)
            moves.append((name, str(place), None))
            with os.fdopen(handle, "wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            os.chmod(name, 0o666 & ~_umask())
        if len(moves) > 1:
            for k, (name, there, _) in enumerate(moves):
                moves[k] = (name, there, _second_name(Path(there)))
        _take_places(moves)
    except UnicodeEncodeError as error:
        wrong = escape_text(error.object[error.start : error.end])
        raise InputError(f"cannot write: {wrong} is half a character, which no file can hold", file=path) from None
    except (OSError, ValueError) as error:
        named = getattr(error, "filename2", None) or path
        raise InputError(f"cannot write: {_words(error)}", file=named) from None
    finally:
        for new, _, before in moves:
            _remove(new)
            _remove(before)


BESIDE = ".kerfwise-"
"""What the name of a new content begins with, beside its place."""
_Move = tuple[str, str, "str | None"]
"""The new content beside its place, the place, and a second name of what stands there now (None where nothing does)."""
_LEFT_S = 86400.0
"""What a command that was killed left beside its files is cleared away by another a day later."""


def _take_places(moves: Sequence[_Move]) -> None:
    """Put every new content in its place; where one cannot be, all is as before."""
    try:
        for new, place, _ in moves:
            os.replace(new, place)
    except BaseException:
        for new, place, before in moves:
            if not os.path.exists(new):
                with contextlib.suppress(OSError):
                    os.unlink(place) if before is None else os.replace(before, place)
        raise
    for folder in sorted({os.path.dirname(place) for _, place, _ in moves}):  # have the names on disk, if it can be
        with contextlib.suppress(OSError):
            handle = os.open(folder, os.O_RDONLY)
            try:
                os.fsync(handle)
            finally:
                os.close(handle)


def _remove(name: str | None) -> None:
    if name is not None:
        with contextlib.suppress(OSError):
            os.unlink(name)


def _second_name(place: Path) -> str | None:
    """A second name for what stands at a place, so that it can be put back; None where nothing does."""
    for _ in range(100):
        name = place.parent / f"{BESIDE}{secrets.token_hex(6)}"
        try:
            os.link(place, name)
        except FileNotFoundError:
            return None
        except FileExistsError:
            continue
        except OSError:  # a file system without second names
            shutil.copy2(place, name)
        return str(name)
    raise OSError("no free name beside it")


def _clear(folder: Path) -> None:
    for left in folder.glob(f"{BESIDE}*"):
        with contextlib.suppress(OSError):
            if time.time() - max(left.stat().st_mtime, left.stat().st_ctime) > _LEFT_S:
                left.unlink()


def _words(error: OSError | ValueError) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


# The remnant that a program saves, as a sheet to nest parts on: JSON and DXF, its lower left corner at the origin.

LAYER = "SHEET"


def remnant_names(program: str | Path, profile: ProfileValues) -> tuple[Path, ...]:
    """The files that stand beside a program which saves a remnant; none where the profile asks for none.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from kerfwise.rules.profile.sections import Cuts, Scrap
    >>> from kerfwise.rules.profile.load import load_profile
    >>> plant = replace(load_profile(), cuts=Cuts(scrap=Scrap(remnant="right")))
    >>> [str(name) for name in remnant_names("out.nc", plant)], remnant_names("out.nc", load_profile())
    (['out.remnant.json', 'out.remnant.dxf'], ())
    """
    if profile.cuts.scrap.remnant is None:
        return ()
    file = Path(program)
    return file.with_name(f"{file.stem}.remnant.json"), file.with_name(f"{file.stem}.remnant.dxf")


def remnant_files(program: str | Path, nest: Nest, profile: ProfileValues) -> Mapping[Path, str]:
    """The remnant of a nest in each of these files; none where the profile asks for none.

    Raises InputError if nothing is left to save.
    """
    names, side = remnant_names(program, profile), profile.cuts.scrap.remnant
    if side is None:
        return {}
    width, height = (round(mm, 3) for mm in remnant_of(nest, profile.material.kerf_mm, side).size_mm)
    return dict(zip(names, (_json(width, height), _dxf(width, height)), strict=True))


def _json(width_mm: float, height_mm: float) -> str:
    sheet = {"width": width_mm, "height": height_mm}
    return json.dumps({"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": []}) + "\n"


def _dxf(width_mm: float, height_mm: float) -> str:
    from ezdxf.addons.r12writer import r12writer  # loaded by those who ask for a drawing only

    text = io.StringIO(newline="")
    with r12writer(text) as drawing:
        corners = [(0.0, 0.0), (width_mm, 0.0), (width_mm, height_mm), (0.0, height_mm)]
        drawing.add_polyline_2d(corners, closed=True, layer=LAYER)
    return dxf_in_mm(text.getvalue())


# Files that are named after the nest because nobody named them: they take no place of what is made of another.

_OF = re.compile(rb"\(NEST (.*) SHA256 ", re.IGNORECASE)
_OUTPUT_HEAD_BYTES = 2000


def output_names(nest: Path) -> tuple[str, str, str]:
    """Names of the program, the plan and the picture of a nest.

    Examples
    --------
    >>> output_names(Path("nests/plate.dxf")), output_names(Path("plate.svg"))[2]
    (('plate.nc', 'plate.plan.json', 'plate.svg'), 'plate.plan.svg')
    """
    beside = f"{nest.stem}.plan.svg" if nest.suffix.lower() == ".svg" else f"{nest.stem}.svg"
    return f"{nest.stem}.nc", f"{nest.stem}.plan.json", beside


def expect_own(nest: Path, program: Path, plan: Path, picture: Path) -> None:
    """Refuse to write over the program, plan or picture of another nest: NEST.dxf and NEST.json give the same names.

    Raises InputError naming the file that is there, and the nest it is of.
    """
    for path, made_of, alike in (
        (plan, _plan_of(plan), lambda name: name),
        (program, _program_of(program), lambda name: Path(name).suffix),
    ):
        if made_of is not None and alike(made_of).lower() != alike(escape_text(nest.name)).lower():
            raise InputError(f"is of {made_of}, and {nest.name} would take its place: {_HOW}", file=path)
    if is_file(picture) and not _is_picture_of(nest, picture):
        raise InputError(f"is no picture of {nest.name}, and one would take its place: {_HOW}", file=picture)


_HOW = "name the outputs (-o, --plan, --picture), or move it away"


def _plan_of(path: Path) -> str | None:
    """The file name of the nest that a plan is of; None where there is no plan that says so."""
    try:
        name = json.loads(path.read_bytes() if is_file(path) else b"")["nest"]["file"]  # a pipe may never end
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return None
    return name if isinstance(name, str) and name else None


def _program_of(path: Path) -> str | None:
    """The same of a program, where its head names a file of another kind: its characters may be fewer than names have.

    Where the kinds are the same so are the names, for the program is named after the nest.
    """
    found = _OF.search(_head(path))
    if found is None:
        return None
    name = found.group(1).decode("ascii", "replace")
    return name if Path(name).suffix.lower() in SUFFIXES else None


def _is_picture_of(nest: Path, path: Path) -> bool:
    head = _head(path).decode("utf-8", "replace")
    title = re.search("<title>(.*?)</title>", head)
    return '<g id="sheet">' in head and title is not None and escape_text(nest.name) in html.unescape(title.group(1))


def _head(path: Path) -> bytes:
    try:
        if not is_file(path):
            return b""
        with path.open("rb") as file:
            return file.read(_OUTPUT_HEAD_BYTES)
    except OSError:
        return b""
