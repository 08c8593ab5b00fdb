"""The made nests are of every family, the same for the same seed, and nests by the reader's own measure or refused."""

from __future__ import annotations

from pathlib import Path

import shapely

from kerfwise import InputError, read_nest
from kerfwise.tests.metal.made_nests import FAMILIES, GAPS_MM, SLOTS_MM, made

MANY = range(300)


def test_the_same_seed_makes_the_same_nest() -> None:
    assert [made(seed).text for seed in range(14)] == [made(seed).text for seed in range(14)]


def test_every_family_gap_and_slot_occurs() -> None:
    nests = [made(seed) for seed in MANY]
    assert {m.family for m in nests} == set(FAMILIES)
    assert {m.drawn for m in nests} >= {f"gap {g:g} mm, slot {s:g} mm" for g, s in ((0, 2), (10, 2))}
    assert {m.drawn.split(",")[0] for m in nests} == {f"gap {g:g} mm" for g in GAPS_MM}
    assert {m.drawn.split("slot ")[1] for m in nests} == {f"{s:g} mm" for s in SLOTS_MM}


def test_they_can_be_read(tmp_path: Path) -> None:
    read = 0
    for seed in range(3 * len(FAMILIES)):
        nest = made(seed)
        file = tmp_path / "nest.json"
        file.write_text(nest.text, encoding="utf-8")
        try:
            drawn = read_nest(file)
        except InputError as refused:
            assert "overlap" in str(refused) or "touch" in str(refused), f"seed {seed}: {refused}"  # noqa: PT017
            continue
        read += 1
        assert len(drawn.contours) == nest.contours
        assert all(shapely.within(c.polygon, drawn.sheet.polygon) for c in drawn.contours if c.kind != "mark")
    assert read >= 2.5 * len(FAMILIES)
