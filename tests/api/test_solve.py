"""kerfwise.solve: a plan, its program and its verdict, and all that a result can be asked."""

from __future__ import annotations

import json
import threading
from dataclasses import replace
from pathlib import Path

import pytest

import kerfwise
from kerfwise.tests.api.plates import CLASH, PAIR, WORK
from kerfwise.tests.commands.run_cli import kerfwise as command_line

NEST = Path(kerfwise.__file__).parent / "examples" / "nests" / "e1x_6.json"


@pytest.fixture(scope="module")
def result() -> kerfwise.Result:
    return kerfwise.solve(NEST, work=1)


def order(result: kerfwise.Result) -> list[str]:
    return [planned.cut.contour for planned in result.plan.cuts]


def test_the_same_as_the_command_line_byte_by_byte(result: kerfwise.Result, tmp_path: Path) -> None:
    said = command_line("solve", NEST, "--work", "1", "-o", tmp_path / "one.nc", "--plan", tmp_path / "one.json",
                        "--picture", tmp_path / "one.svg")  # fmt: skip
    assert said.code == 0
    files = result.save(tmp_path / "out", "one")
    assert [file.name for file in files] == ["one.nc", "one.plan.json", "one.svg"]
    for mine, theirs in zip(files, ("one.nc", "one.json", "one.svg"), strict=True):
        assert mine.read_bytes() == (tmp_path / theirs).read_bytes()
    assert str(result) in said.out


def test_a_remnant_is_saved_beside_its_program_as_by_the_command_line(tmp_path: Path) -> None:
    parts = [{"id": "A", "outer": [[20, 20], [220, 20], [220, 280], [20, 280]]}]
    nest, plant = tmp_path / "one.json", tmp_path / "plant.yaml"
    sheet = {"width": 500, "height": 300}
    nest.write_text(json.dumps({"format": "kerfwise-nest/1", "sheet": sheet, "parts": parts}))
    plant.write_text("cuts: {scrap: {remnant: right}}\n")
    assert command_line("solve", nest, "-p", plant, "--work", "1", "-o", tmp_path / "one.nc").code == 0
    kerfwise.solve(nest, plant, work=1).save(tmp_path / "out")
    for name in ("one.nc", "one.remnant.json", "one.remnant.dxf"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / name).read_bytes()


def test_what_is_known_of_it(result: kerfwise.Result) -> None:
    assert result.ok
    assert not result.interrupted
    assert (result.status, result.gap) == ("optimal", 0.0)
    assert result.bound == pytest.approx(result.objective)
    assert any("portfolio" in note or "ideals" in note for note in result.notes)
    assert kerfwise.check(NEST, result).ok


@pytest.mark.slow
def test_the_same_twice_whatever_the_form(tmp_path: Path) -> None:
    profile = tmp_path / "shop.yaml"
    profile.write_text("name: shop\nbased_on: plasma-carbon-steel\nlocks:\n  - {contour: P2.outer, position: first}\n")
    plain = kerfwise.load_profile()
    lock = kerfwise.Lock(contour="P2.outer", position="first")
    one = kerfwise.solve(PAIR, str(profile), work=WORK)
    others = [
        kerfwise.solve(PAIR, profile, work=WORK),
        kerfwise.solve(PAIR, kerfwise.load_profile(profile), work=WORK),
        kerfwise.solve(PAIR, plain, locks="P2.outer position first", work=WORK),
        kerfwise.solve(PAIR, plain, locks=[lock], work=WORK),
        kerfwise.solve(PAIR, kerfwise.load_profile(locks=[lock]), work=WORK),
        kerfwise.solve(PAIR, plain, locks={"contour": "P2.outer", "position": "first"}, work=WORK, engine="ideals"),
    ]
    assert order(one)[0] == "P2.outer"
    assert order(kerfwise.solve(PAIR, work=WORK)) != order(one) or order(one) != ["P1.hole1", "P1.outer", "P2.outer"]
    assert {tuple(order(other)) for other in others} == {tuple(order(one))}
    assert {other.plan.solve.objective for other in others} == {one.objective}


@pytest.mark.slow
def test_limits_reach_the_engines() -> None:
    heard: list[kerfwise.Reached] = []
    made = kerfwise.solve(PAIR, work=WORK, seed=7, engine="search", on_progress=heard.append)
    assert (made.plan.solve.seed, made.plan.solve.found_by) == (7, "search")
    assert {reached.engine for reached in heard} == {"search"}
    assert heard[-1].objective_mm == pytest.approx(made.objective)
    assert kerfwise.solve(PAIR, time_s=5, strategy="shortest").plan.solve.engine == "portfolio"


def test_a_table_of_cuts(result: kerfwise.Result) -> None:
    table = result.to_frame()
    assert ",".join(table.columns) == (
        "order,contour,part,kind,zone,direction,entry_x_mm,entry_y_mm,pierce_x_mm,pierce_y_mm,length_mm,start_s,end_s,"
        "dwell_s,because"
    )
    assert list(table["contour"]) == order(result)
    assert list(table["order"]) == list(range(1, 17))
    assert table["length_mm"].sum() == pytest.approx(result.plan.totals.cut_mm, abs=0.1)


def test_without_pandas_the_table_says_what_to_install(
    result: kerfwise.Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(kerfwise.InputError, match="pip install pandas"):
        result.to_frame()


@pytest.mark.slow
def test_pictures(result: kerfwise.Result, tmp_path: Path) -> None:
    assert result.picture().content.startswith(b"<svg")
    assert result.picture("png").content.startswith(b"\x89PNG")
    assert b"<html" in result.picture("html").content[:200]
    shown = result._repr_html_()
    assert "data:image/svg+xml;base64," in shown
    assert "proven optimal" in shown
    file = result.picture().save(tmp_path / "plan.svg")
    assert file.read_bytes() == result.picture().content
    with pytest.raises(kerfwise.InputError, match=r"must end in \.svg"):
        result.picture().save(tmp_path / "plan.png")
    near = kerfwise.draw(NEST, result, contours=["part#1.outer"], caption="look here")
    assert b"look here" in near.content


@pytest.mark.slow
def test_explain(result: kerfwise.Result, tmp_path: Path) -> None:
    told = result.explain("part#1.outer")
    assert str(told).startswith("part#1.outer is cut ")
    plan = result.save(tmp_path)[1]
    assert command_line("explain", NEST, plan, "part#1.outer").out == f"{told}\n"
    assert kerfwise.explain(NEST, plan, "part#1.outer") == told
    with pytest.raises(kerfwise.InputError, match=r"did you mean 'part#1\.outer'"):
        result.explain("part1.outer")


def test_a_plan_that_the_check_refuses_is_not_written(result: kerfwise.Result, tmp_path: Path) -> None:
    cuts = result.plan.cuts
    wrong = replace(result.plan, cuts=(cuts[-1], *cuts[1:-1], cuts[0]))
    refused = replace(result, plan=wrong, verdict=kerfwise.check(NEST, wrong))
    assert not refused.ok
    with pytest.raises(kerfwise.RulesConflict, match="nothing was written"):
        refused.save(tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_save_that_fails_leaves_nothing(result: kerfwise.Result, tmp_path: Path) -> None:
    (tmp_path / "one.svg").mkdir()
    with pytest.raises(kerfwise.InputError, match="cannot write"):
        result.save(tmp_path, "one")
    assert [path.name for path in tmp_path.iterdir() if path.is_file()] == []


def test_rules_that_clash() -> None:
    with pytest.raises(kerfwise.NoPlan) as caught:
        kerfwise.solve(PAIR, locks=CLASH, work=WORK)
    conflict = caught.value.conflict
    assert conflict is not None
    assert {about.rule for about in conflict.clash} == {"locks"}
    assert set(conflict.contours) == {"P1.outer", "P2.outer"} or "P1.hole1" in conflict.contours
    assert str(caught.value) == str(conflict) == "\n".join(conflict.lines())
    assert "locked by the operator" in str(conflict)
    assert isinstance(caught.value, kerfwise.RulesConflict)
    found = kerfwise.conflict(PAIR, locks=CLASH, work=WORK)
    assert found is not None
    assert found.clash == conflict.clash
    assert kerfwise.conflict(PAIR, work=WORK) is None


def test_rules_that_clash_give_way_where_that_is_asked_for() -> None:
    made = kerfwise.solve(PAIR, locks=("P2.outer before P1.hole1", "P1.hole1 before P2.outer"), relax=True, work=WORK)
    assert made.ok
    assert len(made.plan.dropped) == 1
    assert made.plan.dropped[0].relaxed


@pytest.mark.slow
def test_after_a_stop_only_the_rest_is_planned(tmp_path: Path) -> None:
    result = kerfwise.solve(PAIR, work=WORK)
    program, plan, _ = result.save(tmp_path, "pair")
    for old in (result, result.plan, plan, str(program)):
        rest = kerfwise.solve(PAIR, resume_from=old, upto=2, work=WORK)
        assert rest.ok
        assert rest.plan.resumed_after == 2
        assert order(rest) == order(result)[2:]
    again = kerfwise.solve(PAIR, resume_from=result, upto=2, redo_last=True, work=WORK)
    assert order(again)[0] == order(result)[1]
    assert "broke off" in str(again.explain(order(again)[0]))


def test_another_thread_may_plan() -> None:
    made: list[kerfwise.Result] = []
    threads = [threading.Thread(target=lambda: made.append(kerfwise.solve(PAIR, work=WORK))) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert made[0].plan.to_json() == made[1].plan.to_json() == kerfwise.solve(PAIR, work=WORK).plan.to_json()


@pytest.mark.slow
def test_times_heat_and_facts(result: kerfwise.Result, tmp_path: Path) -> None:
    program, plan, _ = result.save(tmp_path)
    took = kerfwise.times(NEST, plan)
    assert took.total_s == pytest.approx(result.plan.totals.time_s, abs=0.01)
    assert f"{took}\n" == command_line("time", NEST, plan).out
    assert kerfwise.times(NEST, program).as_json() == json.loads(command_line("time", NEST, program, "--json").out)
    heat = kerfwise.simulate(NEST, result, model="logical")
    assert heat.found.model == "logical"
    assert f"{heat}\n" == command_line("heat", NEST, plan, "--model", "logical").out
    assert list(heat.to_frame()["part"]) == [p.part for p in heat.parts]
    assert "data:image/png;base64," in heat._repr_html_()
    assert kerfwise.facts(NEST).n == 16
    assert [planned.cut.contour for planned in kerfwise.read_plan(plan).cuts] == order(result)
    assert repr(result) == "<Result: 16 contours, idle 1.873 m, optimal>"


@pytest.mark.slow
def test_a_trade_off_takes_locks_and_goes_on_after_a_stop() -> None:
    first, *_, last = (c for c in order(kerfwise.solve(NEST, work=1)) if "hole" in c)
    locked = kerfwise.trade_off(NEST, prices_mm=[0], locks=f"{last} position first", work=1)
    (trade,) = locked.trades
    assert trade.lawful
    assert trade.plan.cuts[0].cut.contour == last != first
    rest = kerfwise.trade_off(NEST, prices_mm=[0], resume_from=trade.plan, upto=9, work=1)
    (trade,) = rest.trades
    assert trade.lawful
    assert (trade.plan.resumed_after, trade.plan.already_cut[0].cut.contour) == (9, last)


@pytest.mark.slow
def test_a_trade_off_relaxes() -> None:
    clash = ["part#1.outer position first", "part#3.outer before part#1.outer"]
    with pytest.raises(kerfwise.RulesConflict):
        kerfwise.trade_off(NEST, prices_mm=[0], locks=clash, work=1)
    (trade,) = kerfwise.trade_off(NEST, prices_mm=[0], locks=clash, relax=True, work=2).trades
    assert trade.lawful
