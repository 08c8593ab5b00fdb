"""What sessions hold, kept on disk as it is made: after a crash, a restart or a reload nothing that was shown is lost.

Below the state folder of the user, not beside the nests: `viewer/FOLDER/NEST/` has `session.json`, which says what is
wanted and shown, and a file for every plan. Each is written whole or not at all, and before any page is told of it.
"""

from __future__ import annotations

import contextlib
import difflib
import hashlib
import json
import os
import secrets
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, fields, replace
from io import BytesIO
from pathlib import Path
from typing import Any

from kerfwise.encoder.files import only_ours

from .plan_request import PlanRequest
from .session import Alternative, Packed, Session

FORMAT, SESSION = "kerfwise-viewer/1", "session.json"
INTERRUPTED = "the planning was interrupted: press Plan to take it up again"
PLAN, PAGE, FILES = "plan.json", "page.z", "files/"
"""What a plan's file holds: what a list says of it, its page, and its files."""
MOST_BYTES = 256_000_000
"""No kept file of a sound session is larger."""


def state_folder() -> Path | None:
    """Where sessions are kept: `$KERFWISE_STATE`, else `kerfwise` in `$XDG_STATE_HOME` or `~/.local/state`.

    On Windows it is below `%LOCALAPPDATA%`. None where there is no such place.
    """
    if named := os.environ.get("KERFWISE_STATE"):
        return Path(named)
    home = os.environ.get("LOCALAPPDATA" if sys.platform == "win32" else "XDG_STATE_HOME")
    try:
        return (Path(home) if home else Path.home() / ".local" / "state") / "kerfwise"
    except RuntimeError:
        return None


class NotPrivate(Exception):
    """A folder that others may write is no place for what is trusted afterwards."""


def private_folder(path: Path) -> Path:
    """A folder of this user alone, made where it is not there.

    Raises OSError if it cannot be made; NotPrivate if it is another user's, or others may write it.
    """
    path.mkdir(mode=0o700, parents=True, exist_ok=True)
    if not only_ours(path):
        raise NotPrivate(f"{path} may be written by others")
    return path


def write_whole(path: Path, data: bytes) -> None:
    """Write a private file whole, or leave what is there; it is on disk once this comes back."""
    handle, beside = tempfile.mkstemp(prefix=".", dir=path.parent)  # only its owner reads it
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(beside, path)
        with contextlib.suppress(OSError):  # Windows has no such thing
            folder = os.open(path.parent, os.O_RDONLY)
            try:
                os.fsync(folder)
            finally:
                os.close(folder)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(beside)
        raise


class KeptSessions:
    """The sessions of one served folder, below a state folder; None keeps nothing.

    `why_not` says why nothing can be kept; "" where it is.
    """

    def __init__(self, state: Path | None, served: Path, trust: bool = False) -> None:
        self._served, self._trust, self.why_not = served, trust, ""
        self._folder: Path | None = None
        self._files: dict[tuple[str, int], Path] = {}
        self._aside: dict[str, str] = {}
        name = hashlib.sha256(os.fsencode(served)).hexdigest()[:16]
        try:
            if state is None:
                self.why_not = "this server was started to keep nothing"
            else:
                private_folder(state)
                self._folder = private_folder(state / "viewer" / name)
        except (OSError, NotPrivate) as error:
            self.why_not = getattr(error, "strerror", None) or str(error)

    def told(self, key: str = "") -> dict[str, Any]:
        """Whether plans and edits are kept, and where, and what was set aside of a session, as JSON."""
        aside = self._aside.get(key, "")
        return {"ok": not self.why_not, "where": str(self._folder or ""), "why": self.why_not, "aside": aside}

    def read_own(self, name: str) -> dict[str, Any]:
        """What is kept of the folder itself, such as its port."""
        return {} if self._folder is None else _json_in(self._folder / name)

    def keep_own(self, name: str, data: Mapping[str, Any]) -> None:
        """Keep something of the folder itself."""
        if self._folder is not None:
            self._write(self._folder / name, json.dumps(data).encode())

    def keep_plan(self, session: Session, plan: Alternative) -> None:
        """Keep a plan that was made, in place of what was kept of it here before."""
        if (folder := self._of(session.id)) is None:
            return
        fields_kept = {
            f.name: getattr(plan, f.name) for f in fields(plan) if f.name not in ("files", "page", "wanted", "kept")
        }
        fields_kept |= {"figures": dict(plan.figures), "wanted": _request_told(plan.wanted)}
        buffer = BytesIO()
        with zipfile.ZipFile(buffer, "w") as archive:  # what is packed is stored as it is
            archive.writestr(PLAN, json.dumps(fields_kept))
            archive.writestr(PAGE, plan.page.data)
            for name, packed in plan.files.items():
                archive.writestr(FILES + name, packed.data)
        path = folder / f"plan-{plan.number}-{secrets.token_hex(4)}.zip"
        if self._write(path, buffer.getvalue()):
            if (before := self._files.pop((session.id, plan.number), None)) is not None:
                _remove(before)
            self._files[session.id, plan.number] = path

    def forget_plan(self, session: Session, number: int) -> None:
        """Keep a plan no longer."""
        if (folder := self._of(session.id)) is not None:
            for path in folder.glob(f"plan-{number}-*.zip"):
                _remove(path)

    def keep(self, session: Session) -> None:
        """Keep what is wanted and shown; a file that cannot be read is set aside before the first time."""
        if (folder := self._of(session.id)) is None or not self._set_aside(session.id, folder / SESSION):
            return
        data = {
            "format": FORMAT,
            "nest": session.name,
            "wanted": _request_told(session.wanted),
            "on_disk": session.on_disk,
            "seen": session.seen,
            "changed_job": session.changed_job,
            "shown": session.shown,
            "state": "" if session.current is None else session.current.state,
            "made": session.made,
            "runs": session.runs,
            "saved": session.saved,
            "planning": session.solving is not None,
            "kept": [one.number for one in session.alternatives if one.kept],
        }
        self._write(folder / SESSION, json.dumps(data).encode())

    def _set_aside(self, key: str, path: Path) -> bool:
        """Rename a session that is damaged, or of another version; whether nothing is lost now if it is written."""
        if key in self._aside:
            return True
        beside = path.with_name(f"session.damaged-{secrets.token_hex(4)}.json")
        is_lost = (path.exists() or path.is_symlink()) and not self._session(key)
        try:
            if is_lost:
                path.replace(beside)
        except OSError as error:
            self.why_not = error.strerror or str(error)
            return False
        self._aside[key] = str(beside) if is_lost else ""
        return True

    def nest_of(self, key: str) -> str | None:
        """The name of the nest whose session is kept under a key."""
        name = self._session(key).get("nest")
        return name if isinstance(name, str) else None

    def load(self, key: str, nest: Path) -> KeptSession | None:
        """The kept session of a nest; None where there is none. What is damaged of it is left where it is, unread."""
        folder = self._of(key, make=False)
        if folder is None or not folder.is_dir():
            return None
        data = self._session(key)
        kept = {number for number in data.get("kept", ()) if isinstance(number, int)}
        plans = [replace(one, kept=one.number in kept) for one in self._plans(folder, nest)]
        if not data and not plans:
            return None
        wanted = _request_of(data["wanted"], nest, self._trust) if data else plans[-1].wanted
        numbers = [one.number for one in plans]
        return KeptSession(
            wanted,
            data.get("on_disk"),
            data.get("seen"),
            data.get("changed_job"),
            plans,
            data["shown"] if data.get("shown") in numbers else max(numbers, default=0),
            max([*numbers, data.get("made", 0)]),
            max([*(one.run for one in plans), data.get("runs", 0)]),
            data.get("saved"),
            INTERRUPTED if data.get("planning") else "",
        )

    def state_of(self, key: str) -> str:
        """The state of the plan that was shown last, as `Alternative.state`; "" where there is none."""
        return str(self._session(key).get("state", ""))

    def plans_kept(self, key: str) -> int:
        """How many plans are kept under a key."""
        folder = self._of(key, make=False)
        return 0 if folder is None else sum(1 for _ in folder.glob("plan-*.zip"))

    def _plans(self, folder: Path, nest: Path) -> Iterator[Alternative]:
        def number(path: Path) -> int:
            digits = path.name.split("-")[1]
            return int(digits) if digits.isdecimal() else 0

        seen: set[int] = set()
        for path in sorted(folder.glob("plan-*-*.zip"), key=number):
            with contextlib.suppress(OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile):
                if path.stat().st_size > MOST_BYTES:
                    continue
                with zipfile.ZipFile(path) as archive:
                    data = json.loads(archive.read(PLAN))
                    names = [name for name in archive.namelist() if name.startswith(FILES)]
                    data["files"] = {name.removeprefix(FILES): Packed(archive.read(name)) for name in names}
                    data["page"] = Packed(archive.read(PAGE))
                data["wanted"] = _request_of(data["wanted"], nest, self._trust)
                data |= {"broken": tuple(data["broken"]), "notes": tuple(data["notes"])}
                plan = Alternative(**data)
                while plan.number in seen:  # two servers have planned the same nest
                    plan = replace(plan, number=max(seen) + 1)
                seen.add(plan.number)
                yield plan

    def _session(self, key: str) -> dict[str, Any]:
        folder = self._of(key, make=False)
        data = {} if folder is None else _json_in(folder / SESSION)
        return data if data.get("format") == FORMAT and _is_sound(data) else {}

    def _of(self, key: str, make: bool = True) -> Path | None:
        if self._folder is None or not key.isalnum():
            return None
        folder = self._folder / key
        if make and not folder.is_dir():
            try:
                private_folder(folder)
            except (OSError, NotPrivate) as error:
                self.why_not = getattr(error, "strerror", None) or str(error)
                return None
        return folder

    def _write(self, path: Path, data: bytes) -> bool:
        try:
            write_whole(path, data)
            self.why_not = ""
        except OSError as error:
            self.why_not = error.strerror or str(error)
        return not self.why_not


def _remove(path: Path) -> None:
    with contextlib.suppress(OSError):
        path.unlink()


@dataclass(frozen=True, slots=True)
class KeptSession:
    """What is kept of a session, as `Session` has it."""

    wanted: PlanRequest
    on_disk: str | None
    seen: dict[str, Any] | None
    changed_job: dict[str, Any] | None
    alternatives: list[Alternative]
    shown: int
    made: int
    runs: int
    saved: dict[str, Any] | None
    problem: str

    def into(self, session: Session) -> None:
        """Have a session go on where this one was."""
        for name in ("alternatives", "shown", "made", "runs", "saved", "changed_job"):
            setattr(session, name, getattr(self, name))
        session.seen = self.seen or session.seen


def _json_in(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(path.read_bytes())
    except (OSError, ValueError):
        return {}
    return data if isinstance(data, dict) else {}


_KEPT_TYPES: Mapping[str, tuple[type, ...]] = {
    "nest": (str,), "on_disk": (str, type(None)), "seen": (dict, type(None)), "changed_job": (dict, type(None)),
    "shown": (int,), "state": (str,), "made": (int,), "runs": (int,), "saved": (dict, type(None)), "kept": (list,),
}  # fmt: skip
_WANTED_TYPES: Mapping[str, tuple[type, ...]] = {
    "job_text": (str, type(None)), "repair": (bool,), "old_plan": (str, type(None)), "upto": (int,)
}  # fmt: skip


def _is_sound(data: dict[str, Any]) -> bool:
    """Whether a session has what this version keeps; a damaged one, or another version's, opens no nest otherwise."""
    wanted = data.get("wanted")
    return isinstance(wanted, dict) and all(
        isinstance(held.get(name, ...), types)
        for held, expected in ((data, _KEPT_TYPES), (wanted, _WANTED_TYPES))
        for name, types in expected.items()
    )


def _request_told(wanted: PlanRequest) -> dict[str, Any]:
    data = asdict(wanted)
    for name in ("nest", "trust", "profile_now"):  # these are as the next server has them
        del data[name]
    return data


def _request_of(data: Mapping[str, Any], nest: Path, trust: bool) -> PlanRequest:
    return PlanRequest(str(nest), data["job_text"], data["repair"], data["old_plan"], data["upto"], trust)


# What was changed outside while nobody looked.


def nest_differences(seen: Mapping[str, Any] | None, opened: Mapping[str, Any]) -> dict[str, Any] | None:
    """The parts that a drawing has gained, lost or has otherwise since it was seen, as JSON; None where it is the same.

    Both have `sha256` of the file, and `shapes` that tell the sheet ("") and the parts by their geometry.
    """
    if seen is None or seen["sha256"] == opened["sha256"]:
        return None
    old, new = seen["shapes"], opened["shapes"]
    return {
        "what": "nest",
        "parts": {
            "added": [name for name in new if name and name not in old],
            "removed": [name for name in old if name and name not in new],
            "changed": [name for name in new if name and name in old and old[name] != new[name]],
        },
        "sheet": old.get("") != new.get(""),
    }


def job_difference(changed: Mapping[str, Any] | None) -> dict[str, Any] | None:
    """Where the job file on disk and the one that is kept here differ, line by line, as JSON; None where neither was
    changed beside the other."""
    if changed is None:
        return None
    disk, kept = ((changed[side] or "").splitlines() for side in ("disk", "kept"))
    lines = [line for line in difflib.ndiff(disk, kept) if line[:2] in ("- ", "+ ")]
    return {"what": "job", "lines": lines, **{key: changed[key] for key in ("using", "unsaved", "why")}}
