"""Bevels burnt in layers: programs of made nests leave every part whole and every face cut, at every depth."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest

import kerfwise
from kerfwise import InputError, Nest, Profile, RulesConflict
from kerfwise.tests.checked import checked
from kerfwise.tests.metal.bevel_nests import made_for_block, made_nest
from kerfwise.tests.metal.layers import jets_of, simulate_layers
from kerfwise.tests.tools.amount import full

FEW, SINGLE, TWO = (0, 3), 100, 10
LONG_RUN = 97
"""Three of four edges have a land, and the run along them, with its loops, is longer than the round."""


def planned(seed: int, kind: str = "whole") -> tuple[Nest, Profile, str] | None:
    """The nest of a seed with its program; None where there is no room, which is refused."""
    nest, profile = made_for_block(seed) if kind == "block" else made_nest(seed, kind == "edges")
    try:
        done = kerfwise.solve(nest, profile, work=0.05)
    except (InputError, RulesConflict) as error:
        if "cannot be read back" in str(error):
            raise
        return None
    assert done.verdict.ok, done.verdict
    return nest, profile, done.program


@pytest.mark.parametrize(
    ("seed", "kind"), [(FEW[0], "whole"), full(FEW[1], "whole"), (SINGLE, "edges"), full(TWO, "block")]
)
def test_programs_of_made_nests_burn_no_part_and_leave_no_face(seed: int, kind: str) -> None:
    made = planned(seed, kind)
    assert made is not None
    nest, profile, program = made
    assert [str(one) for one in simulate_layers(nest, program, profile)] == []


@pytest.mark.full
def test_a_run_may_be_longer_than_the_round_and_not_come_after_it() -> None:
    made = planned(LONG_RUN, "edges")
    assert made is not None
    nest, profile, program = made
    assert [str(one) for one in simulate_layers(nest, program, profile)] == []
    before, run, rounds, after = re.split(r"(?=^\(CUT 2 .* PASS [12]|^\(CUT 3 )", program, flags=re.MULTILINE)
    told = [str(v) for rule in checked(nest, before + rounds + run + after, profile).rules for v in rule.violations]
    assert any("P2.outer: an edge is cut on after the round that sets the part loose" in text for text in told), told


@pytest.mark.full
@pytest.mark.slow
@pytest.mark.parametrize("kind", ["whole", "edges", "block"])
@pytest.mark.parametrize("first", range(0, 200, 20))
def test_two_hundred_made_nests(first: int, kind: str) -> None:
    made = [one for seed in range(first, first + 20) if (one := planned(seed, kind)) is not None]
    assert len(made) >= (10 if kind == "edges" else 16)
    found = [f"{nest.file}: {f}" for nest, profile, program in made for f in simulate_layers(nest, program, profile)]
    assert found == []


def damages(program: str) -> Iterator[tuple[str, str]]:
    """Programs with one thing wrong, and which kind of finding that makes."""
    lean = re.compile(r" A(-?)([1-9][0-9.]*)")
    yield "tilts more", lean.sub(lambda m: f" A{m[1]}{float(m[2]) + 4:g}", program, count=1)
    yield "tilts the other way", lean.sub(lambda m: f" A{'' if m[1] else '-'}{m[2]}", program, count=1)
    yield "stays upright", re.sub(r" A-?[0-9.]+", "", program)


def test_the_simulation_can_fail() -> None:
    made = planned(FEW[0])
    assert made is not None
    nest, profile, program = made
    for name, damaged in damages(program):
        assert simulate_layers(nest, damaged, profile), name


def test_jets_are_read_as_the_control_runs_them() -> None:
    text = "G0 X10 Y0 A45 C0\nM3 S1\nG4 P1\nG1 X20 F600\nG3 X20 Y20 I0 J10 C180\nM5\n"
    (jet,) = jets_of(text)
    assert jet[0].tolist() == [10, 0, 45, 0]
    assert jet[-1].round(9).tolist() == [20, 20, 45, 180]
    assert jet[len(jet) // 2, 0] > 20
