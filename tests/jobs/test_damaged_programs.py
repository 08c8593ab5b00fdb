"""Programs damaged at random: each is refused with its line, or all it cuts is cut as before."""

import random
from pathlib import Path

import pytest

from kerfwise import InputError, resequence
from kerfwise.tests.postproc.old.programs import READ

WORDS = (
    "M0", "G91", "G90", "G20", "M5 $0", "M3 $0 S1", "M3 $1 S1", "G0 X5 Y5", "G1 X5 Y5", "M190 P2", "M52 P0", "F100",
    "(o=0, kw=2, fr=100)", "G4 P1", "M67 E3 Q50", "%", "M2", "G2 X20 Y20 I5 J5", "M6 T1", "M65 P2", "X1", "N5",
    "M159 P609", "#<holes>=2",
)  # fmt: skip


def damaged(rows: list[str], rnd: random.Random) -> str:
    """A program with lines lost, doubled, exchanged, put in, or with one character changed."""
    for _ in range(rnd.randrange(1, 4)):
        k, j = rnd.randrange(len(rows)), rnd.randrange(len(rows))
        match rnd.randrange(5):
            case 0 if len(rows) > 1:
                del rows[k]
            case 1:
                rows.insert(k, rnd.choice(WORDS))
            case 2:
                rows[k], rows[j] = rows[j], rows[k]
            case 3:
                rows.insert(k, rows[j])
            case _ if rows[k]:
                at = rnd.randrange(len(rows[k]))
                rows[k] = rows[k][:at] + rnd.choice("0159.-XYGM") + rows[k][at + 1 :]
    return "\n".join(rows)


@pytest.mark.parametrize("seed", range(4))
def test_damaged_programs(seed: int, tmp_path: Path) -> None:
    rnd, file = random.Random(seed), tmp_path / "old.nc"
    ended = {"refused": 0, "read": 0}
    for _ in range(20):
        file.write_text(damaged(rnd.choice(list(READ.values())).split("\n"), rnd))
        try:
            made = resequence(file, work=0.3, feed_mm_min=1000, without_rules=True)
        except InputError as error:
            ended["refused"] += 1
            if error.line is None and "never on" not in error.message:
                pytest.fail(f"no line: {error}")
            continue
        ended["read"] += 1
        assert made.after.cut_mm == pytest.approx(made.before.cut_mm, abs=0.01)
        assert sorted(b.path.length_mm for b in made.after.burns) == pytest.approx(
            sorted(b.path.length_mm for b in made.before.burns), abs=0.001
        )
        assert made.after.idle_mm <= made.before.idle_mm + 1e-6 or "longer" in made.ends
    assert min(ended.values()) > 0
