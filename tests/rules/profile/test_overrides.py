"""Values, rules and locks that are set for one nest."""

from __future__ import annotations

import contextlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise import InputError, Lock, Profile
from kerfwise.jobs.nest_job.job import job_of
from kerfwise.rules.own import OwnRule
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.overrides import lines_of, read_lock, read_setting, with_rule, with_settings, without_rule
from kerfwise.rules.registry import RULES

READ = {
    "P2 first": Lock(contour="P2", position="first"),
    "#7 last": Lock(contour="#7", position="last"),
    "P2.outer 5th": Lock(contour="P2.outer", position=5),
    "P3 after P2.outer": Lock(contour="P2.outer", before="P3"),
    "P2.outer entry (10, -2.5)": Lock(contour="P2.outer", entry=(10.0, -2.5)),
    "P2.outer entry at [10,20]": Lock(contour="P2.outer", entry=(10.0, 20.0)),
    "P2.outer cw": Lock(contour="P2.outer", direction="cw"),
    "no link P2.outer": Lock(contour="P2.outer", linked=False),
    "P2.outer linked false": Lock(contour="P2.outer", linked=False),
    "no tab P2": Lock(contour="P2", tab="off"),
    "P2 tab off": Lock(contour="P2", tab="off"),
    "P2 tab (5, 0)": Lock(contour="P2", tab=(5.0, 0.0)),
    "P2 in zone 3": Lock(part="P2", zone=3),
    '"last one" before "the first"': Lock(contour="last one", before="the first"),
    '"3"" pipe" before """"': Lock(contour='3" pipe', before='"'),
    '5" first': Lock(contour='5"', position="first"),
    "P1.outer before P2.outer": Lock(contour="P1.outer", before="P2.outer"),
    "  part#1.outer   before  part#2.hole1 ": Lock(contour="part#1.outer", before="part#2.hole1"),
    "P1.outer position first": Lock(contour="P1.outer", position="first"),
    "P1.outer position 12": Lock(contour="P1.outer", position=12),
    "P1.outer entry [10, 20.5]": Lock(contour="P1.outer", entry=(10.0, 20.5)),
    "P1.outer direction ccw": Lock(contour="P1.outer", direction="ccw"),
    "P1 zone 2": Lock(part="P1", zone=2),
    "a part of two words zone 1": Lock(part="a part of two words", zone=1),
    "{contour: P1.outer, position: last, direction: cw}": Lock(contour="P1.outer", position="last", direction="cw"),
}
WRONG = {
    "P2 frist": "'frist': did you mean 'first'\\? expected ID before ID",
    "P2 befor P3": "'befor': did you mean 'before'",
    "P2 soon": "'soon' decides nothing: expected ID before ID",
    "P2 first now": "nothing more was expected after 'first', got 'now'",
    "P2 before": "expected a contour, a part or #7 after 'before'",
    "P2 position": "expected first, last or a position counted from 1 after 'position'",
    "P2 entry 3 4": r"expected a point such as \(10, 20\) after 'entry', got '3 4'",
    "P2 entry (3)": r"entry: expected a point \[x, y\] in mm",
    "P2 linked true": "a link can be ruled out, not asked for",
    "P2 0th": "'0th'",
    "P2 in zone two": "zone: expected a whole number of at least 1, got 'two'",
    "no link": "expected ID before ID",
    "": "expected ID before ID",
    "P1.outer": "expected ID before ID",
    "P1.outer position soon": "position: expected first, last or a position counted from 1, got 'soon'",
    "P1.outer entry [1]": r"entry: expected a point \[x, y\] in mm",
    "P1.outer direction left": "direction: expected one of cw, ccw",
    "P1 zone 0": "zone: expected a whole number of at least 1",
    "P1.outer before P1.outer": "P1.outer cannot be cut before itself",
    "{contur: P1.outer}": "unknown key 'contur': did you mean 'contour'",
    "{contour: P1.outer": "not YAML",
}


@pytest.mark.parametrize("text", READ)
def test_read(text: str) -> None:
    assert read_lock(text) == READ[text]
    assert read_lock(text).because == "locked by the operator"


@pytest.mark.parametrize("text", WRONG)
def test_refused_with_the_text(text: str) -> None:
    with pytest.raises(InputError, match=WRONG[text]) as caught:
        read_lock(text)
    assert str(caught.value).startswith(f"lock {text!r}: ")


NAMES = st.one_of(
    st.from_regex(r"P[0-9]{1,2}\.(outer|hole[1-9]|mark1)", fullmatch=True),
    st.from_regex(r"#[1-9][0-9]?", fullmatch=True),
    st.sampled_from(["part#1.outer", "A+B", "last", "no", "first one", "in zone 2", "2nd", "(x)", "Träger (x).outer",
                     "a  b", "{x}", "no link"]),
    st.text(st.characters(exclude_categories=("Cs",)), min_size=1, max_size=12),
    st.text('"\\ ab(', min_size=1, max_size=8),
).filter(str.strip)  # fmt: skip
COORDINATES = st.floats(-1e5, 1e5).map(lambda value: round(value, 3))
POINTS = st.tuples(COORDINATES, COORDINATES)
ONE = st.one_of(
    st.builds(Lock, contour=NAMES, position=st.one_of(st.sampled_from(["first", "last"]), st.integers(1, 10**8))),
    st.builds(Lock, contour=NAMES, before=NAMES).filter(lambda lock: lock.contour != lock.before),
    st.builds(Lock, contour=NAMES, entry=POINTS),
    st.builds(Lock, contour=NAMES, direction=st.sampled_from(["cw", "ccw"])),
    st.builds(Lock, contour=NAMES, linked=st.just(False)),
    st.builds(Lock, contour=NAMES, tab=st.one_of(st.just("off"), POINTS)),
    st.builds(Lock, part=NAMES, zone=st.integers(1, 999)),
)


@given(ONE)
def test_what_is_written_is_read_again(lock: Lock) -> None:
    [line] = lines_of(lock)
    assert read_lock(line) == lock


@given(st.text(max_size=40))
def test_no_line_breaks_the_parser(text: str) -> None:
    with contextlib.suppress(InputError):
        assert read_lock(text).wrong() is None


OFF_BY_DEFAULT = next(name for name, rule in RULES.items() if rule.default == "off")
HARD = next(name for name, rule in RULES.items() if rule.default == "hard" and {"soft", "off"} <= set(rule.strengths))


@pytest.mark.parametrize("name", [name for name, rule in RULES.items() if "off" in rule.strengths])
def test_a_rule_that_is_off_is_not_among_the_settings(name: str) -> None:
    profile = load_profile()
    assert name not in without_rule(profile, name).settings()
    assert {n: s for n, s in profile.rules.items() if n != name}.items() <= without_rule(profile, name).rules.items()


def test_a_changed_profile_is_another_one() -> None:
    profile = load_profile()
    assert len({profile.sha256, without_rule(profile, HARD).sha256, with_rule(profile, HARD, "soft").sha256}) == 3


def test_a_soft_rule_has_its_weight() -> None:
    assert with_rule(load_profile(), HARD, "soft").settings()[HARD].weight == RULES[HARD].default_weight
    assert with_rule(load_profile(), HARD).settings()[HARD].weight is None


def test_a_rule_that_was_off_is_on() -> None:
    profile = load_profile()
    assert OFF_BY_DEFAULT not in profile.settings()
    assert OFF_BY_DEFAULT in with_rule(profile, OFF_BY_DEFAULT).settings()


def test_an_own_rule_is_switched_too(tmp_path: Path) -> None:
    file = tmp_path / "own.yaml"
    file.write_text("own_rules: [{name: b, select: {kind: hole}, before: {kind: outer}}]\n")
    profile = load_profile(file)
    assert "own:b" in profile.settings()
    assert "own:b" not in without_rule(profile, "own:b").settings()
    assert with_rule(profile, "own:b", "soft").settings()["own:b"].weight == 1000.0


def test_what_cannot_be() -> None:
    must = next(name for name, rule in RULES.items() if "soft" not in rule.strengths)
    with pytest.raises(InputError, match="cannot be soft: it can be"):
        with_rule(load_profile(), must, "soft")
    with pytest.raises(InputError, match="did you mean"):
        without_rule(load_profile(), HARD + "x")


def test_no_price_comes_near_an_excuse_from_a_hard_rule(tmp_path: Path) -> None:
    (tmp_path / "p.yaml").write_text("rules:\n  level-ahead: {strength: soft, weight: 100.1 m}\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"level-ahead\.weight.* no more than 100000 mm"):
        load_profile(tmp_path / "p.yaml")


PLANT = """
name: plant
own_rules:
  - name: narrow slots first
    why: they warp
    select: {kind: hole, short_side_mm: "< 8"}
    before: {kind: hole, not: {short_side_mm: "< 8"}}
    scope: part
  - {name: v1.2, strength: soft, weight: 70 mm, apart: {cuts: 2, within: 50 mm}, select: {kind: hole}}
"""


@pytest.fixture
def plant(tmp_path: Path) -> Profile:
    (tmp_path / "plant.yaml").write_text(PLANT)
    return load_profile(str(tmp_path / "plant.yaml"))


def laid(plant: Profile, text: str) -> dict[str, OwnRule]:
    """The own rules of the plant with what a job file sets, by name."""
    made = with_settings(plant, job_of(text, "plate.job.yaml").settings, "plate.job.yaml")
    return {rule.name: rule for rule in made.own_rules if isinstance(rule, OwnRule)}


def test_what_is_set_takes_its_place_and_the_rest_stays(plant: Profile) -> None:
    before = {rule.name: rule for rule in plant.own_rules}
    text = 'set:\n  own_rules.narrow slots first.select.short_side_mm: "< 6"\n  own_rules.v1.2.apart.cuts: 3\n'
    after = laid(plant, text)
    slots, spread = after["narrow slots first"].plain(), after["v1.2"].plain()
    assert slots["select"] == {"kind": "hole", "short_side_mm": "< 6"}
    assert (slots["why"], slots["scope"]) == ("they warp", "part")
    assert spread["apart"] == {"cuts": 3, "within": "50 mm"}
    assert (spread["strength"], spread["weight"]) == ("soft", "70 mm")
    assert after["v1.2"].place == before["v1.2"].place


@pytest.mark.parametrize(
    "text",
    [
        "set: {own_rules.narrow slots first: soft, 'own:v1.2': off}",
        "set: {own_rules: {narrow slots first: soft, v1.2: {strength: off}}}",
        "set: {own_rules: {narrow slots first: {strength: soft}}, own_rules.v1.2.strength: off}",
    ],
)
def test_a_rule_is_made_soft_or_off(plant: Profile, text: str) -> None:
    after = laid(plant, text)
    assert (after["narrow slots first"].strength, after["narrow slots first"].weight) == ("soft", 1000.0)
    assert (after["v1.2"].strength, after["v1.2"].weight) == ("off", None)


@pytest.mark.parametrize(
    ("text", "place", "said"),
    [
        ("set: {own_rules.narrow slot first: off}", (1, 7), "did you mean 'narrow slots first'?"),
        (
            "set: {own_rules.narrow slots first.wight: 3 mm}",
            (1, 7),
            ": unknown key 'wight'",
        ),
        (
            "set: {own_rules.narrow slots first.weight: 3 mm}",
            (1, 44),
            "only a soft rule has a weight, this one is hard",
        ),
        ("set:\n  own_rules.v1.2.weight: heavy\n", (2, 26), "own_rules.v1.2.weight: "),
        ("set: {own_rules.v1.2.first: true}", (1, 7), "a rule asks one thing, this one asks apart and first"),
        ("set: {own_rules.v1.2.name: x}", (1, 7), "a rule keeps its name"),
        ("set: {own_rules: off}", (1, 7), "unknown own rule ''"),
        (
            "set:\n  own_rules.v1.2: {weight: 3 mm}\n  own_rules.v1.2.weight: 4 mm\n",
            (3, 3),
            "own_rules.v1.2.weight is set twice",
        ),
        ("set:\n  own:v1.2: soft\n  own_rules.v1.2.strength: off\n", (3, 3), "own_rules.v1.2.strength is set twice"),
        (
            "set:\n  own_rules.v1.2.apart: {cuts: 3}\n  own_rules.v1.2.apart.cuts: 4\n",
            (3, 3),
            "own_rules.v1.2.apart.cuts is set twice",
        ),
    ],
)
def test_what_is_wrong_is_said_at_its_place(plant: Profile, text: str, place: tuple[int, int], said: str) -> None:
    with pytest.raises(InputError) as error:
        laid(plant, text)
    assert said in error.value.message
    assert (error.value.file, error.value.line, error.value.column) == ("plate.job.yaml", *place)


def test_on_the_command_line(plant: Profile) -> None:
    made = with_settings(plant, [read_setting("own_rules.narrow slots first=soft")])
    assert made.own_rules[0].strength == "soft"
    with pytest.raises(InputError, match=r"--set \(in Python: settings\): unknown own rule 'v1.strength'"):
        with_settings(plant, [read_setting("own_rules.v1.strength=off")])
    with pytest.raises(InputError, match="the profile has no own rules"):
        with_settings(load_profile(), [read_setting("own:v1=off")])


def test_a_rule_in_a_file_and_the_parameters_of_a_model_file(tmp_path: Path) -> None:
    model = "% {0}: rivet holes are cut first\nint: {1}_most;  % default 800: no longer round than this, 0.01 mm\n"
    rest = "array[int] of var bool: {1}_holds = [true];\narray[int] of int: {1}_contour = [1];\n"
    for name in ("rivets-first", "beside"):
        (tmp_path / f"{name}.mzn").write_text((model + rest).format(name, name.replace("-", "_")))
    (tmp_path / "plant.yaml").write_text("models: rivets-first.mzn\nown_rules: [{file: beside.mzn, strength: soft}]\n")
    plant = load_profile(str(tmp_path / "plant.yaml"))
    job = job_of("set: {rules.rivets-first.most: 700, own_rules.beside.weight: 40 mm}", "plate.job.yaml")
    made = with_settings(plant, job.settings, "plate.job.yaml")
    assert made.rules["rivets-first"].options != plant.rules["rivets-first"].options
    assert (made.own_rules[0].strength, made.own_rules[0].weight) == ("soft", 40.0)
    assert with_settings(plant, [read_setting("own:beside=hard")]).own_rules[0].weight is None
    with pytest.raises(InputError, match="unknown key of a rule in a file 'select'"):
        with_settings(plant, [read_setting("own:beside.select=x")])
