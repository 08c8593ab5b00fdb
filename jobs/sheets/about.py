"""What a work sheet says of the job that a nest belongs to."""

from __future__ import annotations

from kerfwise.jobs.nest_job.job import Job


def about_of_job(job: Job | None) -> dict[str, str]:
    """Names and values for the top of the sheet: order, due date, how many sheets; nothing where there is no job.

    Examples
    --------
    >>> about_of_job(Job(order="4711", quantity=3))
    {'order': '4711', 'sheets': '3 of the same'}
    """
    if job is None:
        return {}
    about = {"order": job.order or "", "due": "" if job.due is None else job.due.isoformat()}
    about["sheets"] = f"{job.quantity} of the same" if job.quantity > 1 else ""
    return {name: text for name, text in about.items() if text}
