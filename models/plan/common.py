"""Why a cut follows a stretch of its contour alone, in a sentence."""

from __future__ import annotations

from kerfwise.encoder.candidates.candidate import Candidate


def common_because(candidate: Candidate, name: str) -> tuple[str, ...]:
    """What the neighbours that are out have left of a contour with common edges; nothing where it is cut all round."""
    if candidate.span is None:
        return ()
    begins = "begins in their kerf" if len(candidate.out) > 1 else "begins in its kerf"
    waits = "" if candidate.kerf_start else ", where the torch waits as for a pierce"
    return (f"common edges: {', '.join(candidate.out)} cut the rest of {name}, which {begins}{waits}",)
