"""The job file: what belongs to one nest, written beside it in `NEST.job.yaml`."""

from .job import Job, job_beside, read_job

__all__ = ["Job", "job_beside", "read_job"]
