"""The profile editor's half of the server: which profile may be written, and that it is written whole or not at all."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import MOST_BYTES_OF_YAML, is_file, read_named
from kerfwise.postproc.output_files import write_files

from .job_edits import expect_keys
from .server import Server
from .session import Session, Stale
from .worker import Died, Refused

MOST_VALUES = 200
Values = Sequence[tuple[str, str, str]]


async def profile_told(server: Server, session: Session) -> dict[str, Any]:
    """The session's profile with its rules, whether it may be written here, and if not, why not."""
    answer: dict[str, Any] = await server.asked("profile", wanted=session.wanted)
    why_not = _why_not(server, answer)
    return {**answer, "file": _shown(server, Path(answer["path"])), "writable": not why_not, "why_not": why_not}


async def write_profile(server: Server, session: Session, body: dict[str, Any]) -> dict[str, Any]:
    """Write values into the profile, or into a new one that is based on it, and plan by that from now on.

    Raises InputError, Refused if the profile lies where nothing is written, was changed meanwhile, or cannot say this.
    Then it is as it was.
    """
    values, new, version = values_of(body.get("changes")), body.get("as"), session.version
    if new is not None and not isinstance(new, str):
        raise InputError("as: expected the name of a file")
    before = await profile_told(server, session)
    if new is None and not before["writable"]:
        raise InputError(before["why_not"])
    if new is None and body.get("sha256") != before["sha256"]:
        raise InputError(f"{before['file']} has changed since it was shown: look at it again")
    written = await server.asked("profile_text", wanted=session.wanted, values=values, new=new)
    session.expect(version)
    path, data = Path(written["path"]), written["text"].encode("utf-8")
    if new is not None and not path.resolve().is_relative_to(server.folder.path):
        raise InputError("a new profile is written in the folder that is served only")
    _write(path, data, written["sha256"])
    sha256 = hashlib.sha256(data).hexdigest()
    if new is None:
        await _read_again(server, path, sha256)
    else:
        await _want_anew(server, session, path)
    return {"file": _shown(server, path), "sha256": sha256}


def values_of(value: Any) -> list[tuple[str, str, str]]:
    """`[{"rule": "heat-lag", "key": "weight", "to": "80 mm"}]` as rules, keys and values."""
    if not isinstance(value, list) or not 0 < len(value) <= MOST_VALUES:
        raise InputError(f"changes: expected a list of 1 to {MOST_VALUES} changes")
    found = []
    for one in value:
        values = [one.get(key) if isinstance(one, dict) else None for key in ("rule", "key", "to")]
        texts = [text for text in values if isinstance(text, str) and text.strip()]
        if len(texts) < len(values):
            raise InputError(f'expected {{"rule": …, "key": …, "to": …}}, got {one!r}')
        expect_keys("a change of a rule", one, ("rule", "key", "to"))
        found.append((texts[0], texts[1], texts[2]))
    return found


def _why_not(server: Server, answer: dict[str, Any]) -> str:
    """Why a profile is not written here; "" where it is."""
    path = Path(answer["path"])
    if answer["shipped"]:
        return f"{answer['name']} comes with kerfwise and is not changed: save it as a profile of your own"
    if path.is_relative_to(server.folder.path) or (server.profile and Path(server.profile).resolve() == path):
        return ""
    return (
        f"{path} lies outside the folder that is served, and is not changed: save it as a profile of your own, or "
        "start the server with -p"
    )


def _shown(server: Server, path: Path) -> str:
    """A file as the page names it: from the served folder where it is in there."""
    return path.relative_to(server.folder.path).as_posix() if path.is_relative_to(server.folder.path) else str(path)


def _write(path: Path, data: bytes, sha256: str | None) -> None:
    """Write a profile unless it has changed since it was read; None for one that was not there."""
    now = hashlib.sha256(read_named(path, "the profile", MOST_BYTES_OF_YAML)).hexdigest() if is_file(path) else None
    if now != sha256:
        raise InputError(f"{path.name} has changed on disk meanwhile: nothing is written")
    write_files({path: data})


async def _want_anew(server: Server, session: Session, profile: Path) -> None:
    """Want a nest by a profile that was just written; what somebody changes meanwhile stays."""
    while True:
        wanted = session.wanted
        result = await server.asked("edited", wanted=wanted, changes=[{"profile": profile.name}])
        try:
            if session.wanted is wanted:
                return await server.want(session, replace(wanted, job_text=result["job_text"]))
        except Stale:
            continue


async def _read_again(server: Server, path: Path, sha256: str) -> None:
    """Every open nest whose profile is made of this file, as it was written, is to be planned again."""
    waiting = list(server.sessions.values())
    while waiting:
        session = waiting.pop()
        try:
            if str(path) in await server.asked("profile_files", wanted=session.wanted):
                await server.want(session, replace(session.wanted, profile_now=sha256))
        except Stale:  # somebody has changed it meanwhile
            waiting.append(session)
        except (Refused, Died) as error:  # the profile is written; that this nest does not go with it is said there
            session.changed(wanted=replace(session.wanted, profile_now=sha256), problem=str(error))
