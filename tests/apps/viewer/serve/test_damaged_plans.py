"""A folder whose plans are broken, foreign or damaged: nests are listed and opened, or refused by name."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import httpx
import pytest

from kerfwise.tests.apps.viewer.serve.served import SMALL, Served
from kerfwise.tests.fuzz.inputs import seeds
from kerfwise.tests.tools.amount import full

FEW = ("half", "foreign", "a place of nan")
NAMES_OTHERS = ("foreign", "a row of nothing")
JOB = "locks: ['#2 first']\n"


def _row(plan: Any, **changed: Any) -> str:
    plan["cuts"][1] |= changed
    return json.dumps(plan)


def _plans() -> dict[str, bytes]:
    good = seeds.made("rich")[1]
    return {
        "nothing": b"",
        "half": good[: len(good) // 2],
        "bytes": bytes(range(256)),
        "another file": b'{"format": "kerfwise-nest/1"}',
        "a list": b"[1, 2]",
        "foreign": seeds.made("plain")[1],
        "a row of nothing": _row(json.loads(good), contour="Z.outer").encode(),
        "a place of words": _row(json.loads(good), entry=["a", "b"]).encode(),
        "a place of nan": _row(json.loads(good), pierce=[float("nan"), 1e308]).encode(),
        "deep": b"[" * 100_000,
    }


@pytest.mark.parametrize("case", [case if case in FEW else full(case) for case in _plans()])
def test_a_plan_beside_a_nest_takes_no_page_down(
    served: Served, client: httpx.Client, tmp_path: Path, case: str
) -> None:
    folder = served.server.folder.path / tmp_path.name
    folder.mkdir(exist_ok=True)
    for name in ("rich", "numbered"):
        (folder / f"{name}.json").write_bytes(seeds.nest_bytes("rich"))
        (folder / f"{name}.plan.json").write_bytes(_plans()[case])
    (folder / "numbered.job.yaml").write_text(JOB, encoding="utf-8")
    (folder / "small.json").write_text(SMALL, encoding="utf-8")
    listed = client.get("/api/nests")
    assert listed.status_code == 200, listed.text
    opened = client.post("/api/open", json={"nest": f"{tmp_path.name}/rich.json"})
    assert opened.status_code == 200, opened.text  # nothing is read of a plan that no lock names
    refused = client.post("/api/open", json={"nest": f"{tmp_path.name}/numbered.json"})
    assert refused.status_code == 422, refused.text
    told = refused.json()["message"]
    assert ("in the last plan" if case in NAMES_OTHERS else "numbered.plan.json: ") in told
