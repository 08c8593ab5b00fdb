"""What is laid over a profile: the job file, then the command line; whose locks stand, and on which contours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.nest_job.job import Job, job_of
from kerfwise.jobs.nest_job.request import LastPlan, with_locks, with_values
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.overrides import read_lock, read_setting
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.values import ForOneNest
from kerfwise.tests.tools.amount import examples

PLATE = nest(
    600, 200,
    part("P1", rect(10, 10, 80, 80)),
    part("P2", rect(110, 10, 80, 80), [rect(130, 30, 20, 20), rect(160, 60, 20, 20)]),
    part("P3", rect(210, 10, 80, 80), [rect(230, 30, 30, 30)]),
)  # fmt: skip
PLANT = load_profile()
LAST = LastPlan("plate.plan.json", {1: "P2.hole1", 2: "P2.hole2", 3: "P2.outer", 4: "P3.hole1", 5: "P3.outer"})


def laid(
    *asked: str, job: str = "", profile: Profile = PLANT, last: LastPlan = LAST, tell: Sequence[str] = ()
) -> tuple[Lock, ...]:
    told = list(tell)
    found = job_of(job, "plate.job.yaml") if job else None
    locks = tuple(map(read_lock, asked))
    return with_locks(with_values(profile, found, (), locks), PLATE, found, locks, lambda: last, told.append).locks


def orders(*pairs: str) -> set[Lock]:
    return {Lock(contour=a, before=b) for a, b in (pair.split("<") for pair in pairs)}


@pytest.mark.parametrize(
    ("said", "locks"),
    [
        ("P1 first", {Lock(contour="P1.outer", position="first")}),
        ("P2.outer 5th", {Lock(contour="P2.outer", position=5)}),
        ("#4 before P1", orders("P3.hole1<P1.outer")),
        ("P1 after #5", orders("P3.outer<P1.outer")),
        ("P2 before P3.outer", orders("P2.hole1<P3.outer", "P2.hole2<P3.outer", "P2.outer<P3.outer")),
        (
            "P3 first",
            orders(
                *(
                    f"{a}<{b}"
                    for a in ("P3.hole1", "P3.outer")
                    for b in ("P1.outer", "P2.hole1", "P2.hole2", "P2.outer")
                )
            ),
        ),
        (
            "P3 last",
            orders(
                *(
                    f"{b}<{a}"
                    for a in ("P3.hole1", "P3.outer")
                    for b in ("P1.outer", "P2.hole1", "P2.hole2", "P2.outer")
                )
            ),
        ),
        ("P1 entry (10, 50)", {Lock(contour="P1.outer", entry=(10.0, 50.0))}),
        ("P3 cw", {Lock(contour=name, direction="cw") for name in ("P3.hole1", "P3.outer")}),
        ("no link P3", {Lock(contour=name, linked=False) for name in ("P3.hole1", "P3.outer")}),
        ("no tab P3", {Lock(contour="P3.outer", tab="off")}),
        ("P3 in zone 2", {Lock(part="P3", zone=2)}),
        ("P3.outer in zone 2", {Lock(part="P3", zone=2)}),
    ],
)
def test_names_stand_for_contours(said: str, locks: set[Lock]) -> None:
    assert set(laid(said)) == locks


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ("P4 first", "lock 'P4 first': unknown contour or part 'P4' (valid: P1, P1.outer"),
        ("P2.hole3 last", "lock 'P2.hole3 last': unknown contour or part 'P2.hole3': did you mean 'P2.hole2'"),
        (
            "P2 2nd",
            "lock 'P2 position 2': P2 has 3 contours (P2.hole1, P2.hole2, P2.outer): say which of them is cut 2 in",
        ),
        ("P2 entry (1, 2)", "P2 has 3 contours (P2.hole1, P2.hole2, P2.outer): say which of them is entered there"),
        ("P2 before P2.outer", "P2.outer cannot be cut before itself: P2 and P2.outer both have it"),
        ("#9 first", "lock '#9 first': #9: plate.plan.json has 5 cuts only"),
        ("P4 in zone 1", "unknown part 'P4'"),
    ],
)
def test_what_the_nest_does_not_have(said: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        laid(said)
    assert message in str(caught.value)


def test_a_lock_of_the_job_file_is_refused_in_its_place() -> None:
    with pytest.raises(InputError) as caught:
        laid(job="quantity: 2\nlocks:\n  - P1 first\n  - P9 last\n")
    assert str(caught.value).startswith("plate.job.yaml:4:5: lock 'P9 last': unknown contour or part 'P9'")


def test_numbers_mean_what_they_meant_when_the_plan_was_made_so() -> None:
    job = job_of("locks: ['#5 first']\n", "plate.job.yaml")
    job = replace(job, sha256="1a2b")
    told: list[str] = []
    plant = with_locks(with_values(PLANT, job, (), ()), PLATE, job, (), lambda: LAST, told.append)
    assert plant.locks == (Lock(contour="P3.outer", position="first"),)
    assert told == ["#5 is P3.outer, as in plate.plan.json"]
    made_with = plant.for_one_nest
    assert made_with == ForOneNest("plate.job.yaml", "1a2b", (), (), {"#5": "P3.outer"})
    now = LastPlan("plate.plan.json", {1: "P3.outer", 5: "P1.outer"}, made_with)
    assert with_locks(with_values(PLANT, job, (), ()), PLATE, job, (), lambda: now, told.append).locks == plant.locks
    other = replace(job, sha256="3c4d")
    again = with_locks(with_values(PLANT, other, (), ()), PLATE, other, (), lambda: now, told.append)
    assert again.locks == (Lock(contour="P1.outer", position="first"),)


PROFILE_FIRST = replace(PLANT, locks=(Lock(contour="P1.outer", position="first", direction="cw"),))


def test_the_job_goes_before_the_profile_and_the_command_line_before_both() -> None:
    told: list[str] = []
    job = job_of("locks: [P2.hole1 first, P3 last]\n", "plate.job.yaml")

    def locks(*asked: str) -> list[str]:
        said = tuple(replace(read_lock(one), reason=f"--lock {one!r}") for one in asked)
        plant = with_values(PROFILE_FIRST, job, (), said)
        return [str(lock.contour) for lock in with_locks(plant, PLATE, job, said, lambda: LAST, told.append).locks
                if lock.position == "first"]  # fmt: skip

    assert locks() == ["P2.hole1"]
    assert told == ["the lock 'P1.outer first' gives way to the lock 'P2.hole1 first' (plate.job.yaml:1:9)"]
    told.clear()
    assert locks("P3.hole1 first") == ["P3.hole1"]
    by = "gives way to the lock 'P3.hole1 first' (--lock 'P3.hole1 first')"
    assert told[1:] == [
        f"the lock 'P2.hole1 first' (plate.job.yaml:1:9) {by}",
        f"the lock 'P3 last' (plate.job.yaml:1:25) {by}",
    ]


def test_what_does_not_contradict_stands_from_all_three() -> None:
    found = laid("P2 before P1", job="locks: [P3 last]\n", profile=PROFILE_FIRST)
    assert Lock(contour="P1.outer", direction="cw") in found
    assert Lock(contour="P2.outer", before="P1.outer") in found
    assert Lock(contour="P1.outer", before="P3.outer") in found
    assert not any(lock.position for lock in found)  # P1.outer cannot be the first


def test_without_anything_laid_over_it_a_profile_stays_what_it_is() -> None:
    assert with_values(PLANT, None, (), ()) is PLANT
    assert with_locks(PROFILE_FIRST, PLATE, None, (), lambda: LAST, print) is PROFILE_FIRST


KEYS = {"material.kerf": ("material", "kerf_mm"), "leads.lead_out_length": ("leads", "lead_out_length_mm"),
        "leads.lead_in_min": ("leads", "lead_in_min_mm")}  # fmt: skip
GIVEN = st.dictionaries(st.sampled_from(sorted(KEYS)), st.sampled_from([1, 1.25, 1.5, 2]))


@examples(40)
@given(of_job=GIVEN, of_line=GIVEN)
def test_each_value_is_that_of_the_last_who_says_it(of_job: dict[str, float], of_line: dict[str, float]) -> None:
    text = "".join(f"\n  {key}: {value}" for key, value in of_job.items())
    job = job_of(f"set:{text}\n" if text else "", "plate.job.yaml")
    made = with_values(PLANT, job, [read_setting(f"{key}={value}") for key, value in of_line.items()], ())
    only = {
        key: with_values(PLANT, None, [read_setting(f"{key}={value}")], ()) for key, value in (of_job | of_line).items()
    }
    for key, (section, name) in KEYS.items():
        expected = getattr(getattr(only.get(key, PLANT), section), name)
        assert getattr(getattr(made, section), name) == expected, key
        from_where = "--set" if key in of_line else "plate.job.yaml:" if key in of_job else PLANT.said_at.get(key, "")
        assert made.said_at.get(key, "").startswith(from_where)


CHOICES = st.sampled_from(
    ["P1.outer first", "P2.hole1 first", "P3.hole1 2nd", "P1 cw", "P1 ccw", "P2 before P3", "P3 before P2", "P1 last",
     "P3 last", "no link P2", "P1 entry (10, 50)", "P1 entry (90, 50)", "P2 in zone 1", "P2 in zone 2"]
)  # fmt: skip


@examples(60)
@given(of_job=st.lists(CHOICES, max_size=3), asked=st.lists(CHOICES, max_size=3))
def test_the_command_line_always_stands_and_nothing_stands_against_it(of_job: list[str], asked: list[str]) -> None:
    job = "locks:" + "".join(f"\n  - {one}" for one in of_job) + "\n"
    alone = set(laid(*asked))
    found = set(laid(*asked, job=job, profile=PROFILE_FIRST))
    assert alone <= found
    further = {(lock.contour or lock.part, key) for lock in found - alone for key in _decided(lock)}
    assert not further & {(lock.contour or lock.part, key) for lock in alone for key in _decided(lock)}
    turned = {Lock(contour=lock.before, before=lock.contour) for lock in alone if lock.before}
    assert not turned & (found - alone)


def _decided(lock: Lock) -> list[str]:
    return [key for key in ("position", "entry", "direction", "zone") if getattr(lock, key) is not None]


def test_the_job_is_one_of_the_files_that_a_profile_is_made_of() -> None:
    job = Job(file="nests/plate.job.yaml", sha256="1a2b")
    assert with_values(PLANT, job, (), ()).read_from[-1] == "nests/plate.job.yaml"
