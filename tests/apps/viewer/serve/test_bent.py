"""How the sheet moves along the time line: simulated in the background, drawn exaggerated, each part with its error."""

from __future__ import annotations

import pytest

from kerfwise.tests.apps.viewer.serve.conftest import Look
from kerfwise.tests.apps.viewer.serve.served import Served, Tab
from kerfwise.tests.tools.axe import findings

pytestmark = [pytest.mark.slow, pytest.mark.browser]

ERRORS = "[...app.stages[0].bent.errors(app.stages[0].scenery, app.state.time_s)]"


@pytest.mark.full
def test_the_sheet_moves_along_the_time_line(look: Look, planned: Tab, served: Served) -> None:
    at = look(planned)
    at.page.click("#bent")
    at.page.wait_for_selector("#bent[aria-pressed=true]")
    told = planned.get("bent", plan=1)  # known by now
    cold = {line["name"]: line["off"] for line in told["lines"] if line["kind"] == "outer"}
    assert at.ask(ERRORS) == []  # nothing is cut yet
    ends = at.ask("app.stages[0].timeline.ends_s")
    at.ask("app.seek(given[0])", ends[1] + 0.01)
    (one,) = at.ask(ERRORS)  # of the first part, its hole and its outline
    assert one == [0, pytest.approx(cold["A.outer"], abs=2e-3)]
    at.ask("app.seek(app.end())")
    assert {at.ask("app.data.nest.parts[given[0]]", part) for part, _ in at.ask(ERRORS)} == {"A", "B", "C"}
    worst = max(cold, key=lambda name: cold[name])
    said = at.page.locator("#bent-said").inner_text()
    assert f"{worst.removesuffix('.outer')} is off most, {cold[worst]:.2f} mm" in said
    assert "times as far as it moves" in said
    assert served.server.simulator.pid not in (None, served.server.desk.pid), "the desk answers meanwhile"
    assert findings(at.page) == []
    at.page.keyboard.press("b")
    at.page.wait_for_selector("#bent-said", state="hidden")


def test_a_material_of_unknown_strength_is_refused(planned: Tab) -> None:
    planned.edit({"set": "heat.material", "to": "plywood"})
    planned.solved()
    answer = planned.client.get(f"/api/{planned.id}/bent", params={"plan": 2})
    assert answer.status_code == 422, answer.text
    assert "plywood" in answer.json()["message"]
