"""Files take the place of others all together: what is to be done is written down first, and then done to the end.

A set of files cannot be renamed in one step, so whoever is killed between two of them would leave a program of one
generation beside a plan of another. Here a list of the moves is written first, beside the files; from then on whoever
comes by brings it to the end: a process of its own, which a kill of the command does not reach, the command itself, and
else the next command that reads or writes there. The list is also what keeps two commands from moving at once. Where
the files lie in several folders, each has the list.

This file is run as a program by that process, without the rest of kerfwise: it imports nothing of it.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterable, Sequence

BESIDE = ".kerfwise-"
"""What the name of a new content begins with, beside its place."""
LIST = ".kerfwise-moves.json"
PATIENCE_S = 10.0
"""How long another's list may stand before it is taken over: moving takes milliseconds."""
HELPER_S = 10.0

FileMove = tuple[str, str, "str | None"]
"""The new content beside its place, the place, and a second name of what stands there now (None where nothing does)."""


_KILLED = (
    "a command was killed while it put this file and others in their places, and they cannot be put right: read one of "
    "them as a user who may write there"
)


class Unsettled(OSError):
    """What a killed command has begun cannot be brought to its end: files are of two generations."""


def swap(moves: Sequence[FileMove]) -> None:
    """Make every move, or none.

    Raises
    ------
    OSError
        If a place cannot be taken, for instance because another program holds the file open; all is as before then.
    """
    if len(moves) == 1:
        os.replace(*moves[0][:2])
        sync_folders(moves)
        return
    lists = sorted({os.path.join(os.path.dirname(os.path.abspath(place)), LIST) for _, place, _ in moves})
    written: list[str] = []
    try:
        for path in lists:  # in one order for all commands, so that no two wait for each other
            write_list(path, moves)
            written.append(path)
    except BaseException:
        remove(written)
        raise
    try:
        if not _helped(lists[0]):
            make(moves)
    except OSError:
        undo(moves)
        raise
    except BaseException:
        make(moves)
        raise
    finally:
        remove([*lists, *(before for _, _, before in moves)])


def settle(place: str) -> None:
    """Before a file is read: wait for a command that is just moving there, or bring to its end what a killed one began.

    Raises
    ------
    Unsettled
        If that cannot be done, and the file is one of those.
    """
    path = os.path.join(os.path.dirname(os.path.abspath(place)), LIST)
    since_s = time.monotonic()
    while os.path.lexists(path) and _age_s(path) <= PATIENCE_S and time.monotonic() - since_s <= PATIENCE_S:
        time.sleep(0.01)
    if not os.path.lexists(path):
        return
    try:
        take_over(path)
    except OSError as error:
        if _is_listed(place, path):
            raise Unsettled(f"{_KILLED} ({error.strerror})") from None


def write_list(path: str, moves: Sequence[FileMove]) -> None:
    """Write the list of moves, once no other is in its place; one that stands too long is taken over.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    since_s = time.monotonic()
    while True:
        try:
            handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
            break
        except FileExistsError:
            if time.monotonic() - since_s > PATIENCE_S or _age_s(path) > PATIENCE_S:
                take_over(path)
                if os.path.lexists(path):
                    raise FileExistsError(errno.EEXIST, "this is in the way, and cannot be removed", path) from None
            time.sleep(0.01)
    try:
        with os.fdopen(handle, "w", encoding="utf-8", errors="surrogateescape", newline="\n") as file:
            json.dump([[_absolute(name) for name in move] for move in moves], file, ensure_ascii=False)
            file.write("\n")  # says that the list is whole
            file.flush()
            os.fsync(file.fileno())
    except BaseException:
        remove([path])
        raise
    sync_folders(moves)


def _is_listed(place: str, path: str) -> bool:
    try:
        return os.path.abspath(place) in (there for _, there, _ in read_list(path))
    except (OSError, ValueError):
        return False


def take_over(path: str) -> None:
    """Bring to its end what another command has begun; what it has only written down has not begun."""
    try:
        moves = read_list(path)
    except (OSError, ValueError):
        moves = []
    if any(not os.path.exists(new) for new, _, _ in moves):
        make(moves)
        remove(before for _, _, before in moves)
    else:
        remove(new for new, _, _ in moves)
    remove([path])


def read_list(path: str) -> list[FileMove]:
    """The moves of a list.

    Raises
    ------
    OSError
        If there is none.
    ValueError
        If it is not whole.
    """
    with open(path, encoding="utf-8", errors="surrogateescape") as file:
        text = file.read()
    if not text.endswith("\n"):
        raise ValueError("the list is not whole")
    rows = json.loads(text)
    if not (isinstance(rows, list) and all(map(_is_own, rows))):
        raise ValueError("the list is not of kerfwise")
    return [(new, place, before) for new, place, before in rows]


def _is_own(row: object) -> bool:
    """Whether a move is one that kerfwise writes down: to a place in the same folder. Lists are found, not given."""
    if not (isinstance(row, list) and len(row) == 3 and isinstance(row[1], str) and isinstance(row[0], str)):
        return False
    folder = os.path.dirname(row[1])
    return all(
        isinstance(name, str) and os.path.dirname(name) == folder and os.path.basename(name).startswith(BESIDE)
        for name in (row[0], row[2])
        if name is not None
    )


def make(moves: Sequence[FileMove]) -> None:
    """Make the moves that are still to be made.

    Raises
    ------
    OSError
        If one cannot be made.
    """
    for new, place, _ in moves:
        with contextlib.suppress(FileNotFoundError):  # made already
            os.replace(new, place)
    sync_folders(moves)


def remove(paths: Iterable[str | None]) -> None:
    """Take files away, where they are still there."""
    for path in paths:
        if path is not None:
            with contextlib.suppress(OSError):
                os.unlink(path)


def undo(moves: Iterable[FileMove]) -> None:
    """Put back what stood there before the moves that were made."""
    for new, place, before in moves:
        if os.path.exists(new):
            continue
        with contextlib.suppress(OSError):
            if before is None:
                os.unlink(place)
            else:
                os.replace(before, place)


def sync_folders(moves: Iterable[Sequence[str | None]]) -> None:
    """Have the names on disk, where the system can."""
    for folder in sorted({os.path.dirname(os.path.abspath(str(move[1]))) for move in moves}):
        with contextlib.suppress(OSError):
            handle = os.open(folder, os.O_RDONLY)
            try:
                os.fsync(handle)
            finally:
                os.close(handle)


def _helped(path: str) -> bool:
    """Whether a process of its own has made the moves; False where there can be none, or it has died of something."""
    python = sys.executable or ""
    if not os.path.basename(python).lower().startswith(("python", "pypy")):
        return False
    try:
        with subprocess.Popen(
            [python, "-I", "-S", os.path.abspath(__file__), path],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),  # the same on Windows
        ) as helper:
            return helper.wait(HELPER_S) == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


def _age_s(path: str) -> float:
    try:
        return time.time() - os.stat(path).st_mtime
    except OSError:
        return 0.0


def _absolute(path: str | None) -> str | None:
    return path if path is None else os.path.abspath(path)


if __name__ == "__main__":
    try:
        make(read_list(sys.argv[1]))
    except (OSError, ValueError):
        sys.exit(1)
