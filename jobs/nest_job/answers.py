"""Answers to questions of a drawing are kept in its job file, so that nobody is asked twice."""

from __future__ import annotations

import json
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.questions import Answers
from kerfwise.jobs.given import Tell
from kerfwise.postproc.files import write_files
from kerfwise.rules.options.yaml_edit import with_value

from .asked import Asked
from .beside import beside_name
from .job import Job
from .read import job_of, read_job


def kept_answers(nest: str | Path, job: Job | None, asked: Asked, read: Nest, tell: Tell) -> Job | None:
    """The job with the answers that were given, written down in its file; those that no question asked for are told.

    Where there is to be no job file, or none can be written, that is told and the answers hold for this time.
    """
    used = {} if read.reading is None else read.reading.answers
    for question, choice in asked.answers:
        if question not in used:
            tell(f"--answer {question}={choice} answers no question of {Path(nest).name}: it is not kept")
    new = tuple((q, c) for q, c in asked.answers if q in used and dict(() if job is None else job.answers).get(q) != c)
    if not new or asked.job is False or isinstance(asked.job, Job):
        return job
    path = Path(asked.job) if asked.job is not None else Path(nest).with_name(beside_name(nest))
    try:
        text = path.read_text("utf-8-sig") if path.exists() else ""
        write_files({path: with_kept(text, new, str(path))})
    except (InputError, OSError, UnicodeDecodeError) as error:
        tell(f"the answers are not kept: {error}")
        return job
    tell(f"kept in {path}: {', '.join(f'{q}={c}' for q, c in new)}")
    return read_job(path)


def with_kept(text: str, answers: Answers, file: str) -> str:
    """The text of a job file with these answers in it, all else as it is.

    Raises
    ------
    InputError
        If the text is no job file.

    Examples
    --------
    >>> print(with_kept("quantity: 4  # sheets\\n", (("frame", "sheet"),), "plate.job.yaml"), end="")
    quantity: 4  # sheets
    <BLANKLINE>
    answers: {"frame": "sheet"}
    """
    job = job_of(text, file) if text.strip() else Job()
    told = json.dumps(dict(job.answers) | dict(answers), ensure_ascii=False)
    made = with_value(text, ["answers"], told)
    job_of(made, file)
    return made
