"""The ten rules of docs/model-files.md: without each the best plan breaks it, with it the plan keeps it."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

import kerfwise
from kerfwise import Profile, load_profile, read_nest
from kerfwise.tests.commands.run_cli import kerfwise as command_line
from kerfwise.tests.tools.amount import few

pytestmark = pytest.mark.minizinc

DOCS = Path(kerfwise.__file__).parent / "docs"
PAGE = (DOCS / "model-files.md").read_text(encoding="utf-8")
NEST = read_nest(DOCS / "own-rules.nest.json")
EXAMPLES = {
    name: (strength or "hard", text)
    for name, strength, text in re.findall(
        r"^### \d+\. .+?`(\w+)\.mzn`(?:, `(\w+)`)?\n.*?```\n(.*?)```", PAGE, re.MULTILINE | re.DOTALL
    )
}
QUIET = ("heat-lag", "no-islands", "no-narrow-strips", "no-tip-travel", "part-rigidity")


def plant(folder: Path, name: str, strength: str) -> Profile:
    off = ", ".join(f"{rule}: off" for rule in QUIET)
    path = folder / "plant.yaml"
    path.write_text(f"models: {name}.mzn\nrules: {{{off}, {name.replace('_', '-')}: {strength}}}\n", encoding="utf-8")
    return load_profile(path)


def test_there_are_ten() -> None:
    assert len(EXAMPLES) == 10
    assert sum(strength == "soft" for strength, _ in EXAMPLES.values()) == 1


@pytest.mark.slow
@pytest.mark.parametrize("name", few(sorted(EXAMPLES, key=lambda name: EXAMPLES[name][0] == "hard"), 4))
def test_rule_changes_the_plan(name: str, tmp_path: Path) -> None:
    strength, text = EXAMPLES[name]
    (tmp_path / f"{name}.mzn").write_text(text, encoding="utf-8")
    profile = plant(tmp_path, name, strength)
    rule_id = name.replace("_", "-")
    rule, options = profile.rulebook()[rule_id], profile.settings()[rule_id].options
    off = replace(
        profile, rules={**profile.rules, rule_id: replace(profile.rules[rule_id], strength="off", weight=None)}
    )
    without = kerfwise.solve(NEST, off, work=1.0)
    before = rule.violations(NEST, without.plan.sequence(), options)
    assert before, "the rule asks nothing new"
    kept = kerfwise.solve(NEST, profile, work=8.0)
    assert kept.verdict.ok, kept.verdict.broken()
    judged = kept.verdict.rule(rule_id)
    assert len(judged.violations) < len(before)
    assert strength == "soft" or judged.verdict == "holds"


def test_the_file_of_the_page_reads(tmp_path: Path) -> None:
    (text,) = re.findall(r"## A file\n\n```\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "rivets_first.mzn").write_text(text, encoding="utf-8")
    profile = plant(tmp_path, "rivets_first", "hard")
    rule = profile.rulebook()["rivets-first"]
    assert rule.sentence == "Rivet holes are cut before all other holes of their part"
    assert "As agreed with assembly." in command_line("rules", "rivets-first", "-p", tmp_path / "plant.yaml").out
    assert profile.settings()["rivets-first"].options.most == 800
