"""How soon zoned plates are proven with links, against without, in one run: a table of the page about chains."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from kerfwise.apps.bench.bench_child import load_kernels
from kerfwise.benchmarks.plates import default_without, made_plate
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.engines.solve import solve
from kerfwise.rules.profile.sections import Cuts, Links
from kerfwise.rules.stating.lazy_statements import lazy_statements

TRIES = 3
"""Each proof is made so often, and the least time counts: other programs on the machine only add to it."""
WORK = 60.0
HEAD = """\
## How soon zoned plates are proven

The same plates, plasma, {pierce:g} s a pierce, without no-tip-travel, in the zones that geometry makes (they do not
move here): seconds of the processor from the statements to the proof, without the facts, which stand beside it. Of
{tries} runs the quickest counts.

| nest | zones | links offered | facts, s | proven, s | with links: facts, s | proven, s | times as long |
|---|---:|---:|---:|---:|---:|---:|---:|
"""


@dataclass(frozen=True)
class Proof:
    """What a proof took, processor s: facts, and from statements on; `proven` says whether it came to one."""

    zones: int
    links: int
    facts_s: float
    proof_s: float
    proven: bool


def proof(nest: Nest, pierce_s: float, longest_mm: float, tries: int = TRIES) -> Proof:
    """The quickest of some runs, in the zones of geometry, with links of that length, or none where it is 0."""
    profile = default_without("no-tip-travel")
    machine = replace(profile.machine, pierce_time_s=pierce_s)
    profile = replace(profile, machine=machine, cuts=Cuts(links=Links(longest_mm=longest_mm)))
    began_s = time.process_time()
    facts = facts_of(nest, profile)
    facts_s = time.process_time() - began_s
    limits, found = options_for(nest, profile, work=WORK), []
    for _ in range(tries):
        began_s = time.process_time()
        asked = make_request(facts, profile)
        solution = solve(facts, asked.stated.statements, limits, None, lazy_statements(facts, profile))
        found.append((time.process_time() - began_s, solution.status == "optimal"))
    return Proof(int(facts.zone.max()), len(facts.links), facts_s, min(found)[0], all(proven for _, proven in found))


def rows(sizes: Iterable[int], pierce_s: float, longest_mm: float, tries: int = TRIES) -> Iterator[str]:
    """A row of the table for each plate."""
    load_kernels()
    for contours in sizes:
        plates = {mm: made_plate(contours, seed=1) for mm in (0.0, longest_mm)}  # a nest keeps what is known of it
        plain, linked = (proof(nest, pierce_s, mm, tries) for mm, nest in plates.items())
        cells = [f"{len(plates[0.0].contours)} contours", f"{plain.zones}", f"{linked.links}"]
        cells += [f"{plain.facts_s:.1f}", _took(plain), f"{linked.facts_s:.1f}", _took(linked)]
        yield f"| {' | '.join(cells)} | {linked.proof_s / plain.proof_s:.2f} |"


def _took(made: Proof) -> str:
    return f"{made.proof_s:.2f}" if made.proven else f"not proven in {made.proof_s:.2f}"
