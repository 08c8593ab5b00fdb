"""Every block of a good program damaged in turn: dropped, an arc turned round, an end or a centre moved by a tenth."""

import re
from collections.abc import Callable, Iterator

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile

PLATE, PROFILE = plate(), profile()
BLOCKS = write_program(plan_of(PLATE, good_cuts(PLATE), PROFILE), PLATE, PROFILE).splitlines()

HARMLESS = ("M68 E3 Q0", "M5 $-1")
"""Said to be sure: the control's speed is whole, and nothing is on, in any case."""
STILL_ON_THE_PATH = ("G2 X390 Y59.25 I-20.75 J0", "G3 X110 Y50 I-12 J5")
"""Arcs whose end or centre moves along the path, or by far less across it."""

Damage = Callable[[str], str | None]


def words(block: str) -> str:
    return re.sub(r"^N\d+ ", "", block)


def leads_out(k: int) -> bool:
    return BLOCKS[k + 1].endswith("M5 $0")


def dropped(block: str) -> str | None:
    return None if words(block) in HARMLESS else ""


def turned_round(block: str) -> str | None:
    turned = re.sub(r"(?<=G)[23]\b", _other, block)
    return None if turned == block else turned


def _other(found: re.Match[str]) -> str:
    return "3" if found[0] == "2" else "2"


def moved(letter: str, mm: float) -> Damage:
    def damage(block: str) -> str | None:
        if not re.match(r"G[123]\b", words(block)) or words(block) in STILL_ON_THE_PATH:
            return None
        changed = re.sub(rf"(?<={letter})-?[\d.]+", lambda m: f"{float(m[0]) + mm:.4f}", block)
        return None if changed == block else changed

    return damage


def damaged(damage: Damage) -> Iterator[tuple[str, str]]:
    """Each block that is damaged, and the program with it. A lead-out may end elsewhere, or be left out."""
    for k, block in enumerate(BLOCKS[:-1]):
        if not block.startswith("(") and not leads_out(k) and (changed := damage(block)) is not None:
            yield block, "\n".join([*BLOCKS[:k], changed, *BLOCKS[k + 1 :], ""])


def passes(program: str) -> bool:
    try:
        return check_program(PLATE, program, PROFILE).ok
    except InputError:
        return False


def test_the_program_is_good() -> None:
    assert passes("\n".join([*BLOCKS, ""]))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("damage", "least"),
    [(dropped, 100), (turned_round, 28), *((moved(letter, 0.1), 24) for letter in "XYIJ")],
    ids=["dropped", "turned round", "X moved", "Y moved", "I moved", "J moved"],
)
def test_no_damage_passes(damage: Damage, least: int) -> None:
    programs = list(damaged(damage))
    assert len(programs) >= least
    assert [block for block, program in programs if passes(program)] == []
