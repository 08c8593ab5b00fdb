"""kerfwise time: what it prints of a plan and of its program."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.tests.commands.run_cli import kerfwise

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"
LASER = "laser-amg3m-1mm"
KEYS = ["cut_s", "idle_s", "pierce_s", "total_s", "idle_share", "nc_blocks"]


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A plan of the nest by the laser's profile, and its program."""
    folder = tmp_path_factory.mktemp("timed")
    made = package.solve(NEST, LASER, work=2)
    (folder / "plan.json").write_text(made.plan.to_json())
    (folder / "plan.nc").write_text(made.program)
    return folder / "plan.json", folder / "plan.nc"


def told(made: Path, profile: object = LASER) -> dict[str, float]:
    ended = kerfwise("time", NEST, made, "-p", profile, "--json")
    assert ended.code == 0, ended.err
    data = json.loads(ended.out)
    assert list(data)[:6] == KEYS
    assert data["total_s"] == pytest.approx(sum(data[k] for k in KEYS[:3]), abs=0.002)
    assert data["idle_share"] == pytest.approx(data["idle_s"] / data["total_s"], abs=1e-5)
    return dict(data)


def test_plan_and_program_agree_with_each_other_and_with_what_the_plan_states(files: tuple[Path, Path]) -> None:
    plan, program = map(told, files)
    stated = json.loads(files[0].read_text())["time"]
    assert plan == stated
    assert plan.pop("nc_blocks") == program.pop("nc_blocks") == files[1].read_text().count("\nN")
    assert plan.pop("model") == program.pop("model")
    assert plan == pytest.approx(program, rel=1e-3)


def test_the_table_for_people(files: tuple[Path, Path]) -> None:
    data = told(files[0])
    lines = kerfwise("time", NEST, files[0], "-p", LASER).out.splitlines()
    assert [line.split()[0] for line in lines] == ["cut", "idle", "pierce", "total"]
    assert [float(line.split()[1]) for line in lines] == pytest.approx(
        [data[k] for k in ("cut_s", "idle_s", "pierce_s", "total_s")], abs=0.06
    )
    assert lines[1].endswith(f"{data['idle_share']:.1%} of the time")
    assert lines[2].endswith("16 pierces")
    blocks = data["nc_blocks"]
    assert f"{blocks} NC blocks, feed by blocks, bystar-3015-amg3m-1mm, " in lines[3]


def test_a_plants_own_points_acceleration_and_prices(files: tuple[Path, Path], tmp_path: Path) -> None:
    base = told(files[0])
    cases = {
        "constant": "time: {model: constant}",
        "points": "time: {feed_by_blocks: {points: [[10, 6 m/min], [1000, 6 m/min]]}}",
        "limited": "time: {model: acceleration, acceleration: 2 m/s2}",
        "priced": "prices: {machine_hour: 80, gas_hour: 12, currency: RUB}",
    }
    found = {}
    for name, text in cases.items():
        path = tmp_path / f"{name}.yaml"
        path.write_text(f"based_on: {LASER}\n{text}\n")
        found[name] = told(files[0], path)
    assert found["constant"]["cut_s"] == found["points"]["cut_s"] < found["limited"]["cut_s"]
    assert found["constant"]["idle_s"] < found["limited"]["idle_s"]
    assert base["cut_s"] > found["constant"]["cut_s"]
    cost = found["priced"]["cost"]
    assert cost["machine"] == pytest.approx(80 * base["total_s"] / 3600, abs=1e-4)  # type: ignore[index]
    assert cost["gas"] == pytest.approx(12 * (base["cut_s"] + base["pierce_s"]) / 3600, abs=1e-4)  # type: ignore[index]
    last = kerfwise("time", NEST, files[0], "-p", tmp_path / "priced.yaml").out.splitlines()[-1]
    assert last.split()[:3] == ["cost", f"{cost['total']:.2f}", "RUB,"]  # type: ignore[index]


def test_a_program_whose_feeds_are_not_the_profiles_is_noted(files: tuple[Path, Path]) -> None:
    other = kerfwise("time", NEST, files[1])
    assert other.code == 0
    said = "by its own words the program cuts for 57.0 s, at the profile's feeds for 137.0 s"
    assert other.err.startswith(f"note: {said}; the times below are by its own\n")
    assert other.out.startswith("cut          57.0 s")
    assert kerfwise("time", NEST, files[1], "-p", LASER).err == ""


def test_a_plan_of_another_profile_is_noted(files: tuple[Path, Path]) -> None:
    other = kerfwise("time", NEST, files[0])
    said = (
        "note: the profile is not the one the plan was made with (its sha256 differs): this is 'plasma-carbon-steel', "
    )
    assert other.err.startswith(f"{said}that was '{LASER}', whose sha256 begins ")
    assert other.err.endswith(": give it with -p (in Python profile=)\n")
    assert kerfwise("time", NEST, files[0], "-p", LASER).err == ""


def test_wrong_input(files: tuple[Path, Path], tmp_path: Path) -> None:
    missing = kerfwise("time", NEST, tmp_path / "none.nc")
    assert (missing.code, missing.out) == (2, "")
    assert "cannot read the program: No such file" in missing.err
    (tmp_path / "odd.nc").write_text("G1 X5\n")
    assert "odd.nc:1:1: a line or an arc with no feed" in kerfwise("time", NEST, tmp_path / "odd.nc").err
    other = NEST.with_name("plate40.json")
    assert "the plan was made from another nest" in kerfwise("time", other, files[0]).err


def triangles(side_mm: float) -> tuple[str, str]:
    """A nest of 15 triangles, four of them with a hole, and a program of 120 blocks that cuts their 19 contours."""
    rise = side_mm * 0.75**0.5
    parts, paths = [], []
    for k in range(15):
        x, y = 300.0 * (k % 5) + 40, 300.0 * (k // 5) + 40
        corners = [[x, y], [x + side_mm, y], [x + side_mm / 2, y + rise]]
        hole = [[x + 0.2 * side_mm + 0.4 * a, y + 0.1 * side_mm + 0.4 * b] for a, b in ([0, 0], [side_mm, 0])]
        parts.append(
            {"id": f"P{k}", "outer": corners, "holes": [[*hole, [hole[0][0], hole[0][1] + 30]]] if k < 4 else []}
        )
        paths += [corners] * (2 if k < 4 else 1)
    lines = ["G21", "G90"]
    for first, *others in paths:
        lines += [f"G0 X{first[0]:.3f} Y{first[1]:.3f}", "M3 $0 S1"]
        lines += [f"G1 X{x:.3f} Y{y:.3f} F6000" for x, y in [*others, first]]
        lines += ["M5 $0"]
    lines += ["(going home)", "M5 $-1", "G0 X0 Y0", "G49", "M2"]
    nest = {"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 1600, "height": 1000}, "parts": parts}
    return json.dumps(nest), "\n".join(lines) + "\n"


def test_the_known_answer_of_120_blocks(tmp_path: Path) -> None:
    """Tavaeva and Petunin: 15 parts, 19 contours, n = 120, AMg3M 1 mm: 126.27 s at 0.1 m/s becomes 141.38 s.

    The paper prints no lengths; the two times leave 12.05 m to cut and 5.8 s for all else (see test_clock.py), which
    is what idle travel takes here.
    """
    on_mm = (141.38 - 126.27) / (1 / (257.2 * 120**-0.222) - 1 / 100)
    nest, program = triangles(on_mm / 57)
    (tmp_path / "nest.json").write_text(nest)
    (tmp_path / "plan.nc").write_text(program)
    machine = "machine: {cut_feed: 0.1 m/s, travel: 1.303 m/s, pierce_time: 0}"
    times = {}
    for name, model in (("constant", "constant"), ("corrected", "blocks")):
        path = tmp_path / f"{name}.yaml"
        path.write_text(f"{machine}\ntime: {{model: {model}, feed_by_blocks: bystar-3015-amg3m-1mm}}\n")
        ended = kerfwise("time", tmp_path / "nest.json", tmp_path / "plan.nc", "-p", path, "--json")
        assert ended.code == 0, ended.err
        times[name] = json.loads(ended.out)
    assert times["constant"]["nc_blocks"] == times["corrected"]["nc_blocks"] == 120
    assert times["constant"]["total_s"] == pytest.approx(126.27, abs=0.05)
    assert times["corrected"]["total_s"] == pytest.approx(141.38, abs=0.05)
