"""Saves what a session shows: all files or none, and nothing over what somebody else has changed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from kerfwise.encoder.contents import MOST_BYTES_OF_YAML, contents, is_file
from kerfwise.encoder.errors import InputError
from kerfwise.jobs.default_names import expect_own, named_after
from kerfwise.jobs.nest_job.beside import beside_name
from kerfwise.postproc.files import expect_outputs, write_files

from .folder import Folder
from .session import Session
from .wanted import before_name, sha256_of


def save(session: Session, folder: Folder, profile_sha256: str) -> dict[str, Any]:
    """Write the shown plan's files and its job file, all of them or none; what was written, and the command line.

    `profile_sha256` is that of the profile as it is on disk now.

    Raises
    ------
    InputError
        If there is no plan, the check refuses it, the nest, the job file or the profile has changed on disk, a job
        file was saved that the plan was made without, a file is of another nest, or a link leads out of the folder.
    """
    current = session.current
    if current is None:
        raise InputError("there is no plan to save yet")
    if not current.ok:
        raise InputError(f"the check refuses this plan ({', '.join(current.broken)}): nothing is written")
    wanted, nest = current.wanted, Path(current.wanted.nest)
    if wanted.profile_now != session.wanted.profile_now:
        raise InputError("the profile has changed since this plan was made: plan again")
    job = nest.with_name(beside_name(nest.name))
    if sha256_of(nest) != current.sha256:
        raise InputError("the nest has changed on disk since this plan was made: open it again")
    if text_of(job) != session.on_disk:
        raise InputError(f"{job.name} has changed on disk since it was read: open the nest again")
    if wanted.job_text is None and session.on_disk is not None:
        raise InputError(f"{job.name} was saved since this plan was made, which goes without: plan again")
    if json.loads(current.plan)["profile"].get("sha256") != profile_sha256:
        raise InputError("the profile has changed on disk since this plan was made: plan again")
    files: dict[Path, str | bytes] = {nest.with_name(name): kept.text() for name, kept in current.files.items()}
    program, plan, picture = (nest.with_name(name) for name in named_after(nest))
    expect_own(nest, program, plan, picture)
    if wanted.old_plan is not None:
        before = nest.with_name(before_name(wanted.nest))
        expect_own(nest, program, before, picture)
        files[before] = wanted.old_plan
    expect_outputs(files, (nest, job))
    folder.expect_inside((*files, job))
    if wanted.job_text is not None and wanted.job_text != session.on_disk:
        files[job] = wanted.job_text
    write_files(files)
    told = {
        "number": current.number,
        "files": [path.name for path in files],
        "command": current.command,
        "same_bytes": not current.stopped,
    }
    session.changed(saved=told, on_disk=wanted.job_text if wanted.job_text is not None else session.on_disk)
    return told


def text_of(job: Path) -> str | None:
    """What a job file says, to the byte; None where there is none."""
    try:
        return contents(job, MOST_BYTES_OF_YAML).decode("utf-8") if is_file(job) else None
    except UnicodeDecodeError:
        raise InputError("not a job file: it is no UTF-8 text", file=job.name) from None
