"""The benchmark runner: what it measures is what was judged, and it says so plainly."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any, cast

import pytest
from click.testing import CliRunner

import kerfwise
from kerfwise import InputError
from kerfwise.apps.bench.bench import BenchJob, BenchResult, BestKnown, line, measure, read_best_known, results_in_all
from kerfwise.apps.bench.bench_child import load_kernels, peak_mb
from kerfwise.apps.bench.verbs import command
from kerfwise.models.engines.ideals import kernels
from kerfwise.models.routing import judge_tour, read_instance

EXAMPLES = Path(kerfwise.__file__).parent / "examples"
KEYS = {"instance", "engine", "cost", "bound", "proven", "feasible", "seconds", "memory_mb", "processor_s", "tour"}


def result(cost: float | None = 103.0, fault: str = "") -> BenchResult:
    return BenchResult("a", "search", cost, None, False, cost is not None and not fault, 1.0, 200.0, (1, 2), fault)


@pytest.mark.slow
def test_a_routing_instance_in_a_process_of_its_own() -> None:
    path = EXAMPLES / "routing" / "nine.pcglns"
    done = measure(BenchJob(str(path), time_s=2.0))
    assert (done.instance, done.proven, done.feasible) == ("nine", True, True)
    assert judge_tour(read_instance(path), [int(v) for v in done.tour]) == (done.cost, "")
    assert done.bound == done.cost
    assert done.memory_mb > 20
    assert 0 < done.seconds < 60


@pytest.mark.slow
def test_the_command_prints_json_for_instances_and_nests() -> None:
    files = [str(EXAMPLES / "routing" / "twelve.sop"), str(EXAMPLES / "nests" / "e1x_6.json")]
    ran = CliRunner().invoke(command, [*files, "--work", "1", "--json"], standalone_mode=False)
    assert ran.return_value == 0
    sop, nest = json.loads(ran.stdout)
    assert set(sop) >= KEYS
    assert (sop["engine"], sop["proven"], sop["feasible"]) == ("portfolio", True, True)
    assert (nest["proven"], len(set(nest["tour"]))) == (True, 16)


@pytest.mark.slow
def test_the_table_tells_the_gap(tmp_path: Path) -> None:
    best = tmp_path / "best.csv"
    best.write_text("set,instance,best_upper\nrouting,twelve,397\nother,twelve,1\n")
    twelve = str(EXAMPLES / "routing" / "twelve.sop")
    ran = CliRunner().invoke(command, [twelve, "--work", "1", "--best-known", str(best)], standalone_mode=False)
    title, row, summary = ran.stdout.splitlines()
    assert title.split()[:2] == ["instance", "engine"]
    assert row.split()[:6] == ["twelve", "portfolio", "397", "397", "+0.00%", "yes"]
    assert "1 proven, at or under best known 1 of 1" in summary


@pytest.mark.full
def test_tables_that_do_not_fit_into_the_memory_given_are_not_made() -> None:
    nine = str(EXAMPLES / "routing" / "nine.pcglns")
    asked = [nine, "--engine", "ideals", "--work", "1", "--json"]
    plenty = CliRunner().invoke(command, asked, standalone_mode=False)
    scarce = CliRunner().invoke(command, [*asked, "--memory", "1e-6"], standalone_mode=False)
    assert (plenty.return_value, json.loads(plenty.stdout)[0]["proven"]) == (0, True)
    assert (scarce.return_value, json.loads(scarce.stdout)[0]["cost"]) == (1, None)


def test_gaps_are_of_feasible_tours_only() -> None:
    assert "+3.00%" in line(result(), 100.0)
    assert "%" not in line(result(fault="a cluster is not visited once"), 100.0)
    assert "none" in line(result(cost=None), 100.0)
    assert "mean gap 3.000%" in results_in_all([result(), result(cost=None)], [100.0, 100.0])


def test_best_known_by_set_and_by_name(tmp_path: Path) -> None:
    known = BestKnown({("sop", "ft53.1"): 7531.0, ("", "alone"): 3.0})
    assert known.of("x/sop/ft53.1.sop.gz") == 7531.0
    assert known.of("x/pcgtsplib/ft53.1.pcglns.gz") is None
    assert known.of("x/any/alone.sop") == 3.0
    wrong = tmp_path / "wrong.csv"
    wrong.write_text("instance,best\na,dear\n")
    with pytest.raises(InputError, match=r"wrong.csv:2: best is not a number: 'dear'"):
        read_best_known(wrong)
    wrong.write_text("name,value\na,1\n")
    with pytest.raises(InputError, match="expected columns instance and one of"):
        read_best_known(wrong)


@pytest.mark.slow
def test_a_broken_file_is_one_message(tmp_path: Path) -> None:
    broken = tmp_path / "broken.sop"
    broken.write_text("DIMENSION: 2\nEDGE_WEIGHT_SECTION\n0 1 2\n")
    with pytest.raises(InputError, match="2 × 2 weights were expected, 3 are there"):
        measure(BenchJob(str(broken)))


@pytest.mark.full
@pytest.mark.slow
def test_a_broken_file_among_others_is_told_and_the_others_are_run(tmp_path: Path) -> None:
    (tmp_path / "empty.sop").write_text("")
    twelve = str(EXAMPLES / "routing" / "twelve.sop")
    ran = CliRunner().invoke(command, [str(tmp_path / "empty.sop"), twelve, "--work", "1"], standalone_mode=False)
    assert ran.return_value == 2
    assert "empty.sop: the header must give one DIMENSION" in ran.stderr
    assert ran.stdout.splitlines()[-1].startswith("1 runs, 1 feasible")


@pytest.mark.parametrize(
    ("name", "said"),
    [("folder", "this is a folder; name the files in it"), ("a.txt", r"expected a file of \.pcglns, \.sop, \.dxf")],
)
def test_what_cannot_be_run_is_refused_before_anything_is(tmp_path: Path, name: str, said: str) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "a.txt").write_text("")
    twelve = str(EXAMPLES / "routing" / "twelve.sop")
    ran = CliRunner().invoke(command, [twelve, str(tmp_path / name)], standalone_mode=False)
    assert ran.stdout == ""
    with pytest.raises(InputError, match=said):
        raise ran.exception or AssertionError


def test_a_process_that_dies_is_one_message(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    twelve = EXAMPLES / "routing" / "twelve.sop"
    monkeypatch.setattr("sys.executable", "/bin/false")
    with pytest.raises(InputError, match=r"twelve\.sop: the engine search ended with an error: exit code 1"):
        measure(BenchJob(str(twelve), "search"))


@pytest.mark.full
def test_best_known_costs_of_other_sets_are_said_to_be_of_no_use(tmp_path: Path) -> None:
    best = tmp_path / "best.csv"
    best.write_text("set,instance,best_upper\nother,twelve,1\n")
    twelve = str(EXAMPLES / "routing" / "twelve.sop")
    ran = CliRunner().invoke(command, [twelve, "--work", "1", "--best-known", str(best)], standalone_mode=False)
    assert "has no costs for these instances" in ran.stderr


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="other systems tell no peak of a process alone")
def test_a_process_does_not_take_over_the_peak_of_its_parent() -> None:
    held = bytearray(b"1" * (300 << 20))
    assert peak_mb() > len(held) / (1 << 20)
    tell = "from kerfwise.apps.bench.bench_child import peak_mb; print(peak_mb())"
    done = subprocess.run([sys.executable, "-c", tell], capture_output=True, text=True, check=True)
    assert 1.0 < float(done.stdout) < 200.0


def _signatures(kernel: object) -> list[Any]:
    return list(cast(Any, kernel).dispatcher.signatures)


def test_the_sweep_is_loaded_for_cheap_plans_and_dear_ones() -> None:
    load_kernels()
    loaded = _signatures(kernels.sweep)
    assert {str(layer.fields["values"][0].dtype) for _, layer, *_ in loaded} == {"int32", "int64"}
    load_kernels()
    assert _signatures(kernels.sweep) == loaded
