"""Part-rigidity by facts and by geometry: the judging allows what the cells of the facts blur, and no more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.facts import FactOptions, compute_facts
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import circle, nest, part
from kerfwise.rules.catalogue.part_rigidity import ALLOWANCE, PartRigidity, PartRigidityOptions
from kerfwise.rules.statements import AtLeast, Before
from kerfwise.tests.rules.test_statements_agree import sheets
from kerfwise.tests.tools.amount import examples

RULE, OPTIONS = PartRigidity(), PartRigidityOptions(head_weight_mm=0.0)
DISCS = nest(
    420, 330,
    *(part(f"D{k}", circle(60 + 100 * (k % 4), 60 + 105 * (k // 4), 47 - 4 * (k % 3))) for k in range(12)),
)  # fmt: skip


def holds(statement: AtLeast, at: Sequence[int]) -> bool:
    kept = (isinstance(literal, Before) and at[literal.i] < at[literal.j] for literal in statement.literals)
    return sum(w for w, true in zip(statement.weights, kept, strict=True) if true) >= statement.bound


@pytest.mark.slow
@examples(60)
@given(st.one_of(st.just(DISCS), sheets()), st.data())
def test_statements_and_geometry_agree(sheet: Nest, data: st.DataObject) -> None:
    outers = [sheet.index[p.outer.id] for p in sheet.parts]
    order = data.draw(st.permutations(outers))
    at = {contour: k for k, contour in enumerate(order)}
    candidates, cuts = [], {}
    for k in outers:
        contour = sheet.contours[k]
        entry_mm = data.draw(st.floats(0, 1, exclude_max=True)) * contour.curve.length_mm
        entry, way = contour.curve.point_at(entry_mm), data.draw(st.sampled_from(["cw", "ccw"]))
        candidates.append(Candidate(k, entry_mm, entry, way, entry, None, None, entry, 0.0))  # type: ignore[arg-type]
        cuts[k] = Cut(contour.id, entry, way, entry)  # type: ignore[arg-type]
    facts = compute_facts(sheet, FactOptions(), sorted(candidates, key=lambda c: c.contour))
    sequence = CutSequence(tuple(cuts[k] for k in order))
    exempt = {about.contours[0] for about in RULE.exempt(facts, OPTIONS)}
    short = {sheet.contours[facts.candidates[s.when].contour].id for s in RULE.statements(facts, OPTIONS)
             if s.when is not None and not holds(s, [at.get(k, -1) for k in range(facts.n)])}  # fmt: skip
    broken = {v.contours[0] for v in RULE.violations(sheet, sequence, OPTIONS)}
    assert broken <= short | exempt
    strict = replace(OPTIONS, rigid_min=OPTIONS.rigid_min + 2 * ALLOWANCE)
    assert short | exempt <= {v.contours[0] for v in RULE.violations(sheet, sequence, strict)}
