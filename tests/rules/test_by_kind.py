"""Statements of several kinds, however they are mixed, are sorted in their order."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from kerfwise.rules.statements import About, Forbid, IdleTravel, Precede, Statement, by_kind

ABOUT = About("r", (), "")
ONE = st.one_of(
    st.builds(Precede, st.integers(0, 5), st.integers(0, 5), st.just(ABOUT)),
    st.builds(Forbid, st.integers(0, 5), st.just(ABOUT)),
    st.builds(IdleTravel, st.just(ABOUT), st.floats(0, 5)),
)


@given(st.lists(ONE))
def test_each_kind_keeps_its_order(statements: list[Statement]) -> None:
    kinds = by_kind(iter(statements))
    assert kinds.precede == tuple(s for s in statements if isinstance(s, Precede))
    assert kinds.forbid == tuple(s for s in statements if isinstance(s, Forbid))
    assert kinds.idle_travel == tuple(s for s in statements if isinstance(s, IdleTravel))
    assert kinds.lag == kinds.link == ()
