"""Where statements come from: sentences that are made when they are read are like those that are there."""

from __future__ import annotations

import copy
import pickle
from dataclasses import replace
from itertools import repeat

import pytest

from kerfwise.rules.statements import About

WRITTEN = About("r", ("A", "B"), "A before B")


def unread(said: list[tuple[str, ...]] | None = None) -> About:
    """One whose sentence nobody has read yet; `said` notes when it is made."""

    def say(contours: tuple[str, ...]) -> str:
        if said is not None:
            said.append(contours)
        return " before ".join(contours)

    return About.each("r", [("A", "B")], repeat(say))[0]


def test_a_sentence_is_made_once_and_not_before_it_is_read() -> None:
    said: list[tuple[str, ...]] = []
    about = unread(said)
    assert about.contours == ("A", "B")
    assert said == []
    assert about.sentence == about.sentence == "A before B"
    assert said == [("A", "B")]


def test_one_that_was_not_read_is_equal_to_one_that_was_written() -> None:
    assert unread() == WRITTEN
    assert hash(unread()) == hash(WRITTEN)
    assert repr(unread()) == repr(WRITTEN)
    assert unread() != replace(WRITTEN, sentence="B before A")


def test_it_can_be_copied_and_put_aside() -> None:
    assert pickle.loads(pickle.dumps(unread())) == copy.deepcopy(unread()) == copy.copy(unread()) == WRITTEN
    assert replace(unread(), contours=("A",)) == replace(WRITTEN, contours=("A",))


def test_what_it_does_not_have_is_refused_as_usual() -> None:
    with pytest.raises(AttributeError, match="'About' object has no attribute 'reason'"):
        unread().reason  # type: ignore[attr-defined]  # noqa: B018
