"""News for all tabs: two see the same, whoever is slow hears each thing once, one stream has them all."""

from __future__ import annotations

import json

import httpx
import pytest

from kerfwise.tests.apps.viewer.serve.served import SMALL, Open, Tab

pytestmark = pytest.mark.slow


def test_two_tabs_see_the_same_and_neither_writes_over_the_other(opened: Open, client: httpx.Client) -> None:
    one = opened()
    two = Tab(client, one.id, one.version, one.nest)
    one.edit({"lock": "C.outer last"})
    refused = two.edit({"lock": "B.outer first"}, expected=409)
    assert (refused["kind"], refused["locked"]) == ("stale", ["C.outer last"])
    assert two.version == one.version
    assert two.edit({"lock": "B.outer cw"})["locked"] == ["C.outer last", "B.outer cw"]
    for what, said in (("solve", {}), ("back", {"to": 1}), ("save", {}), ("cut", {"upto": 1})):
        assert one.client.post(f"/api/{one.id}/{what}", json={"version": one.version, **said}).status_code == 409
        assert one.client.post(f"/api/{one.id}/{what}", json=said).status_code == 409


def test_one_stream_has_the_news_of_all_nests(opened: Open, client: httpx.Client) -> None:
    first, found = opened(), []
    with client.stream("GET", "/api/events") as answer:
        lines = answer.iter_lines()
        told = (json.loads(line.removeprefix("data: ")) for line in lines if line.startswith("data: "))
        found.append(next(one for one in told if one.get("id") == first.id))
        first.edit({"lock": "C.outer last"})
        found.append(next(one for one in told if one.get("id") == first.id))
        other = opened(SMALL, "other.json")  # it was not open when the stream began
        other.solved()
        names = next(one for one in told if one.get("alternatives"))
    assert [one["locked"] for one in found] == [[], ["C.outer last"]]
    assert (names["nest"], len(names["alternatives"])) == (other.state()["nest"], 1)
