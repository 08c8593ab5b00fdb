"""What is wrong with a model file, or with how a profile names it, is said in one message: where, and what to do."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.request import facts_of, make_request
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.flat import flatzinc_to_expr, model_file
from kerfwise.rules.profile.load import load_profile

ROW = nest(300, 120, *(part(name, rect(10 + 90 * k, 20, 60, 60)) for k, name in enumerate("ABC")))
GOOD = (
    "% small first\nint: small_first_most;  % default 3: how many\n\n"
    "array[int] of var bool: small_first_holds =\n  [{}];\n"
)
MODELS = "models: [small_first.mzn]\n"


def planned(profile: Path) -> None:
    """What is done before engines are asked."""
    loaded = load_profile(profile)
    make_request(facts_of(ROW, loaded), loaded)


def refused(folder: Path, array: str = "before(1, 2)", profile: str = MODELS, text: str = GOOD) -> str:
    """The message, with the folder taken out of it."""
    (folder / "small_first.mzn").write_text(text.replace("{}", array))
    (folder / "plant.yaml").write_text(profile)
    with pytest.raises(InputError) as error:
        planned(folder / "plant.yaml")
    return str(error.value).replace(f"{folder}/", "")


@pytest.mark.parametrize(
    ("models", "said"),
    [
        ("small_frist.mzn", "plant.yaml:1:9: models: there is no file 'small_frist.mzn'"),
        ("[small_first.mzn, none.mzn]", "plant.yaml:1:27: models: there is no file 'none.mzn'"),
        ("none/*.mzn", "plant.yaml:1:9: models: no MiniZinc file matches 'none/*.mzn'"),
        ("'*.txt'", "plant.yaml:1:9: models: no MiniZinc file matches '*.txt'"),
        ("folder", "plant.yaml:1:9: models: 'folder' is a folder: name the files in it, as in folder/*.mzn"),
        ("rule.txt", "rule.txt: expected a MiniZinc file such as plant_rule.mzn"),
        (
            "[small_first.mzn, folder/small_first.mzn]",
            "plant.yaml:1:27: models: two files state the rule small-first: small_first.mzn and folder/small_first.mzn",
        ),
        ("{a: b}", "plant.yaml:1:9: models: expected a list, got a mapping"),
        ("[3.mzn]", "3.mzn: a rule's file is named as the rule, such as rivets_first.mzn; '3' is no name that"),
    ],
)
def test_how_a_profile_names_files(tmp_path: Path, models: str, said: str) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "small_first.mzn").write_text(GOOD.replace("{}", "before(1, 2)"))
    (tmp_path / "3.mzn").write_text(GOOD)
    (tmp_path / "rule.txt").write_text(GOOD)
    assert refused(tmp_path, profile=f"models: {models}\n").startswith(said)


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("{most: many}", "plant.yaml:2:29: rules.small-first.most: expected a whole number, got 'many'"),
        ("{most: 2.5}", "plant.yaml:2:29: rules.small-first.most: expected a whole number, got '2.5'"),
        ("{moist: 3}", "plant.yaml:2:23: rules.small-first: unknown key 'moist': did you mean 'most'?"),
        ("sotf", "plant.yaml:2:22: rules.small-first: expected one of hard, soft, off, got 'sotf'"),
    ],
)
def test_parameters_and_strengths_from_the_profile(tmp_path: Path, setting: str, said: str) -> None:
    assert refused(tmp_path, profile=f"{MODELS}rules: {{small-first: {setting}}}\n").startswith(said)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            GOOD.replace("  % default 3: how many", ""),
            "small_first.mzn:2: the parameter small_first_most has no default: write it beside, as in `int: "
            "small_first_most;  % default 3: what it is`",
        ),
        (GOOD.replace("default 3", "default many"), "small_first.mzn:2: the parameter small_first_most has no default"),
        (
            GOOD.replace("first_holds", "last_holds"),
            "small_first.mzn:4: the array small_last_holds is not named as the file: call it small_first_holds, or the "
            "file small_last.mzn",
        ),
        ("% nothing\n", "small_first.mzn: the file states nothing: expected an array `array[int] of var bool: small_f"),
    ],
)
def test_what_a_file_says_of_itself(tmp_path: Path, text: str, said: str) -> None:
    assert refused(tmp_path, text=text).startswith(said)


def test_a_file_of_own_rules_that_is_not_there(tmp_path: Path) -> None:
    said = refused(tmp_path, profile="own_rules: [{file: none.mzn}]\n")
    assert re.match(r"(plant\.yaml:1:\d+: .*none\.mzn|none\.mzn: cannot read the rule: No such file)", said)


@pytest.mark.minizinc
@pytest.mark.parametrize(
    ("array", "said"),
    [
        ("befor(1, 2)", "no function or predicate with name `befor' found"),
        ("before(1, k)", "undefined identifier `k'"),
        ("before(1, 2) | i in", "syntax error, unexpected ]"),
        ("position[1]", "cannot determine coercion from type array[int] of var int"),
        ('before(1, "B")', "no function or predicate with this signature found: `before"),
    ],
)
def test_mistakes_in_the_text_have_their_line(tmp_path: Path, array: str, said: str) -> None:
    assert re.match(rf"small_first\.mzn:5:\d+: MiniZinc: {re.escape(said)}", refused(tmp_path, array))


@pytest.mark.minizinc
def test_a_parameter_with_a_name_of_its_own(tmp_path: Path) -> None:
    said = refused(tmp_path, text=GOOD.replace("{}", "before(1, 2)") + "int: most;\n")
    assert said == (
        "small_first.mzn:6:1: MiniZinc: variable `most' must be defined; a parameter is called as the file and then by "
        "its own name, as in small_first_most, with a default beside it"
    )


@pytest.mark.minizinc
def test_a_mistake_in_an_included_file_is_told_there(tmp_path: Path) -> None:
    (tmp_path / "beside.mzn").write_text("int: a = b;\n")
    said = refused(tmp_path, text='include "beside.mzn";\n' + GOOD)
    assert said.startswith("beside.mzn:1:10: MiniZinc: undefined identifier `b'")


@pytest.mark.minizinc
def test_a_file_may_have_any_name_that_a_rule_may(tmp_path: Path) -> None:
    (tmp_path / "rule.mzn").write_text("array[int] of var bool: rule_holds = [befor(1, 2)];\n")
    assert refused(tmp_path, profile="models: rule.mzn\n").startswith("rule.mzn:1:39: MiniZinc: no function")


@pytest.mark.minizinc
def test_what_can_hold_in_no_order_says_which_element_it_is(tmp_path: Path) -> None:
    (tmp_path / "small_first.mzn").write_text(GOOD.replace("{}", "before(1, 2), before(1, 2) /\\ before(2, 1)"))
    (tmp_path / "plant.yaml").write_text(f"{MODELS}rules: {{level-ahead: off}}\n")
    profile = load_profile(tmp_path / "plant.yaml")
    rule = profile.rulebook()["small-first"]
    texts = [s.about.sentence for s in rule.statements(facts_of(ROW, profile), rule.Options())]
    assert texts[1] == "element 2 of the file's array can hold in no order: Small first (small_first.mzn:4)"


@pytest.mark.minizinc
def test_a_file_that_has_gone_meanwhile(tmp_path: Path) -> None:
    (tmp_path / "small_first.mzn").write_text(GOOD.replace("{}", "before(1, 2)"))
    (tmp_path / "plant.yaml").write_text(MODELS)
    profile = load_profile(tmp_path / "plant.yaml")
    (tmp_path / "small_first.mzn").unlink()
    with pytest.raises(InputError, match=r"small_first\.mzn: MiniZinc: .*small_first\.mzn"):
        make_request(facts_of(ROW, profile), profile)


@pytest.mark.parametrize("blanks", [" " * 30_000, "\n" * 30_000, "\t \n" * 10_000], ids=["spaces", "lines", "both"])
def test_thousands_of_blanks_are_read_at_once(blanks: str) -> None:
    text = (
        f"{blanks}int: rule_least;  % default 3: least{blanks}\n% default{blanks}\nint{blanks}\n{blanks}constraint x;"
    )
    (found,) = model_file._parameters(Path("rule.mzn"), text, "rule")
    assert (found.name, found.default) == ("rule_least", "3")
    assert model_file._BARE.search(text)


def test_products_that_grow_too_large_are_refused_before_they_are_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(flatzinc_to_expr, "MOST_MULTIPLIED", 10)
    product = "position[i] * position[j] >= 2 | i, j in CONTOUR where i < j"
    assert refused(tmp_path, product) == (
        "small_first.mzn:4: rule small-first: products of what a plan decides come to more than 10 terms on 3 "
        "contours: multiply by facts alone, or say the same by sums and conditions"
    )
