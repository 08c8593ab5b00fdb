"""The job file: what belongs to one nest, written beside it in `NEST.job.yaml`."""

from .beside import job_beside
from .job import Job
from .read import read_job

__all__ = ["Job", "job_beside", "read_job"]
