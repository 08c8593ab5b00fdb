"""What is drawn is valid, differs, and is drawn of every rule."""

from __future__ import annotations

import numpy as np
import pytest

from kerfwise.rules.options.option import options_of
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.registry import RULES
from kerfwise.tests.drawn_options import contradicts, drawn_value, with_drawn_options

EACH = [(name, option) for name, rule in RULES.items() for option in options_of(rule.Options)]


@pytest.mark.parametrize(("rule", "option"), EACH, ids=[f"{rule}-{option.key}" for rule, option in EACH])
def test_each_option_takes_several_values(rule: str, option: object) -> None:
    rng = np.random.default_rng(1)
    assert len({repr(drawn_value(option, rng)) for _ in range(30)}) > 1  # type: ignore[arg-type]


def test_the_same_seed_draws_the_same_and_nothing_contradicts() -> None:
    base = load_profile()
    for seed in range(20):
        drawn = with_drawn_options(base, np.random.default_rng(seed))
        assert drawn == with_drawn_options(base, np.random.default_rng(seed))
        assert not [name for name in RULES if contradicts(name, drawn, drawn.rules)]
