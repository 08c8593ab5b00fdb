"""Ways to cut each contour: where the torch pierces, joins, which way round it goes and where it leaves."""

from .build import CandidateBuilder, build_candidates, build_with_older_kerfs
from .candidate import Candidate, LeadOptions

__all__ = ["Candidate", "CandidateBuilder", "LeadOptions", "build_candidates", "build_with_older_kerfs"]
