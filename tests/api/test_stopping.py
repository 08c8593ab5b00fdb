"""Ctrl-C, and a callback that has had enough: the best plan so far is kept."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest

import kerfwise

NEST = Path(kerfwise.__file__).parent / "examples" / "nests" / "e1x_6.json"


@pytest.fixture(scope="module")
def free(tmp_path_factory: pytest.TempPathFactory) -> kerfwise.Profile:
    path = tmp_path_factory.mktemp("profile") / "free.yaml"
    path.write_text("based_on: plasma-carbon-steel\nname: free\nrules: {zone-order: off}\n")
    return kerfwise.load_profile(path)


def test_ctrl_c_keeps_the_best_plan(free: kerfwise.Profile) -> None:
    presses = []
    before = signal.getsignal(signal.SIGINT)

    def press_once_there_is_a_plan(reached: kerfwise.Reached) -> None:
        if reached.objective_mm is not None and not presses:
            presses.append(reached)
            signal.raise_signal(signal.SIGINT)

    result = kerfwise.solve(NEST, free, engine="search", on_progress=press_once_there_is_a_plan)
    assert presses
    assert result.interrupted
    assert result.ok
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.slow
def test_a_callback_that_answers_false_stops(free: kerfwise.Profile) -> None:
    heard: list[kerfwise.Reached] = []

    def enough(reached: kerfwise.Reached) -> bool:
        heard.append(reached)
        return reached.objective_mm is None

    result = kerfwise.solve(NEST, free, engine="search", on_progress=enough)
    assert result.interrupted
    assert result.ok
    assert sum(reached.objective_mm is not None for reached in heard) == 1  # nobody asks again


@pytest.mark.slow
def test_what_a_callback_raises_comes_out(free: kerfwise.Profile) -> None:
    def fail(reached: kerfwise.Reached) -> None:
        raise ZeroDivisionError("of the caller")

    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(ZeroDivisionError, match="of the caller"):
        kerfwise.solve(NEST, free, work=1, on_progress=fail)
    assert signal.getsignal(signal.SIGINT) is before


def test_ctrl_c_before_there_is_a_plan(free: kerfwise.Profile) -> None:
    def at_once(reached: kerfwise.Reached) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        kerfwise.solve(NEST, free, engine="cp-sat-alone", work=1, on_progress=at_once)
