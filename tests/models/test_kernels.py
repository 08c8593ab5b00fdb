"""Kept kernels: whatever is in their files, what is computed is right, and nothing fails."""

from __future__ import annotations

import gc
import importlib
import itertools
import os
import shutil
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest
from numba.core.codegen import JITCodeLibrary

from kerfwise.encoder.errors import Advice
from kerfwise.models import jit, numba_cache
from kerfwise.models.jit import (
    Kernel,
    compiling,
    cores,
    counted_s,
    inner,
    made_s,
    note_compiled,
    running_s,
    suited,
    take_plainly,
)
from kerfwise.models.jit import (
    jit as jit_kernels,
)
from kerfwise.models.numba_cache import Files, Kept, compiled_beside, is_kept


def doubled(x: int) -> int:
    return 2 * x


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "kept"))
    monkeypatch.setattr(numba_cache, "_told", set())
    return tmp_path / "kept"


def run() -> tuple[Any, list[str]]:
    """A kernel compiled or loaded as a new process would, once it is called; and what is told."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        kernel: Any = jit_kernels(nogil=True)(doubled)
        assert kernel(21) == 42
        assert kernel(1.5) == 3.0
    assert all(issubclass(w.category, Advice) for w in told)
    return kernel, [str(w.message) for w in told]


def hits(kernel: Any) -> int:
    return sum(kernel.dispatcher._cache_hits.values())


def test_a_second_run_loads_what_the_first_has_kept(folder: Path) -> None:
    first, told = run()
    assert (hits(first), told) == (0, [])
    assert len(list(folder.rglob("*.kernel"))) == 2
    second, told = run()
    assert (hits(second), told) == (2, [])


def test_what_compiling_takes_is_not_made_ready_where_kernels_are_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    _, told = run()
    context = type(run()[0].dispatcher.targetctx)
    monkeypatch.setattr(context, "refresh", lambda self: pytest.fail("60 modules are loaded for this"))
    loaded, _ = run()
    assert (hits(loaded), told) == (2, [])


DAMAGE: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda data: b"",
    "one byte": lambda data: data[:1],
    "a sum alone": lambda data: data[:64],
    "cut in the sum": lambda data: data[:40],
    "cut": lambda data: data[:100],
    "cut in half": lambda data: data[: len(data) // 2],
    "last byte lost": lambda data: data[:-1],
    "a byte too much": lambda data: data + b"\0",
    "one bit at the begin": lambda data: data[:64] + bytes([data[64] ^ 1]) + data[65:],
    "one bit in the machine code": lambda data: data[:-500] + bytes([data[-500] ^ 4]) + data[-499:],
    "zeros": lambda data: bytes(len(data)),
    "another's": lambda data: b"\x80\x04K\x01." * 40,
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_file_is_compiled_anew(damage: str, folder: Path) -> None:
    run()
    for path in folder.rglob("*.kernel"):
        path.write_bytes(DAMAGE[damage](path.read_bytes()))
    again, told = run()
    assert hits(again) == 0
    assert told in ([], ["kept kernels are damaged, and are compiled anew"])
    third, told = run()
    assert (hits(third), told) == (2, [])


def test_a_whole_file_of_something_else(folder: Path) -> None:
    """Its sums are right, and what is in it is no kernel."""
    first, _ = run()
    files = first.dispatcher._cache._cache_file
    for path in folder.rglob("*.kernel"):
        files.path = lambda key, path=path: path
        files.save("key", "no kernel")
    again, told = run()
    assert hits(again) == 0
    assert told == ["kept kernels cannot be read, and are compiled anew"]


def test_of_another_source_or_numba(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run()
    monkeypatch.setattr(numba, "__version__", "0.0")
    again, told = run()
    assert (hits(again), told) == (0, [])


CALLED = "from numba import njit\n\n\n@njit\ndef called(x):\n    return x * {factor}\n"
CALLING = (
    "from kerfwise.models.jit import jit as kept\n\nfrom {called} import MORE, called\n\n\n"
    "@kept()\ndef calling(x):\n    return 2 * (called(x) + MORE)\n"
)


@pytest.mark.parametrize("changed", ["nothing", "the kernel that is called", "a number of another file"])
def test_a_kernel_is_compiled_anew_where_what_it_calls_has_changed(
    changed: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    found = []
    for factor, more in ((3, 0), (4 if "called" in changed else 3, 1 if "number" in changed else 0)):
        (tmp_path / "called_kernel.py").write_text(CALLED.format(factor=factor) + f"\n\nMORE = {more}\n")
        (tmp_path / "calling_kernel.py").write_text(CALLING.format(called="called_kernel"))
        importlib.invalidate_caches()
        for name in ("called_kernel", "calling_kernel"):
            sys.modules.pop(name, None)
        numba_cache._digest.cache_clear()
        calling = importlib.import_module("calling_kernel").calling
        found.append((calling(5), hits(calling)))
    assert found[0] == (30, 0)
    assert (
        found[1]
        == {"nothing": (30, 1), "the kernel that is called": (40, 0), "a number of another file": (32, 0)}[changed]
    )


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="Windows has no such rights")
def test_what_others_may_have_written_is_not_run(folder: Path) -> None:
    run()
    folder.chmod(0o777)
    for place in folder.rglob("*"):
        if place.is_dir():
            place.chmod(0o777)
    kernel, told = run()
    assert hits(kernel) == 0
    assert [text for text in told if "are not run, for others may write there" in text]


def test_where_nothing_can_be_kept_it_is_said_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A home and an installation that may not be written."""

    def refused(self: object) -> None:
        raise PermissionError(13, "Permission denied")

    from numba.core.caching import _CacheLocator  # type: ignore[attr-defined]

    monkeypatch.setattr(_CacheLocator, "ensure_cache_path", refused)
    _, told = run()
    assert len(told) == 1
    assert "cannot be kept here" in told[0]
    assert run()[1] == []


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), OSError(30, "Read-only file system")])
def test_a_full_disk(error: OSError, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(self: object, key: object, kernel: object) -> None:
        raise error

    monkeypatch.setattr(Files, "save", full)
    _, told = run()
    assert told == [f"compiled kernels cannot be kept ({error.strerror}) and are compiled anew each time"]
    assert list(folder.rglob("*.kernel")) == []


def test_a_folder_in_the_place_of_a_file(folder: Path) -> None:
    run()
    for path in folder.rglob("*.kernel"):
        path.unlink()
        path.mkdir()
    _, told = run()
    assert len(told) == 1


def test_runs_at_once_never_read_the_half_of_a_file(tmp_path: Path) -> None:
    """Each kind of arguments has its own file: numba's count would give two runs one name for two kernels."""
    files = [Files(str(tmp_path), "f", lambda: "source") for _ in range(4)]

    def write_and_read(number: int) -> bool:
        files[number % 4].save(("kind", number % 3), [number % 3] * 50_000)
        found = files[(number + 1) % 4].load(("kind", number % 3))
        return found == [number % 3] * 50_000

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(write_and_read, range(60)))
    assert len(list(tmp_path.iterdir())) == 3
    files[0].flush()
    assert list(tmp_path.iterdir()) == []


def test_every_kernel_that_is_kept_is_kept_so() -> None:
    root = Path(jit.__file__).parents[1]
    floors = [folder for folder in root.iterdir() if folder.is_dir() and folder.name.isidentifier()]
    sources = [path for folder in floors if folder.name != "tests" for path in folder.rglob("*.py")]
    assert len(sources) > 300
    assert not [path for path in sources if "cache=True" in path.read_text(encoding="utf-8")]
    assert issubclass(Kept, numba.core.caching.FunctionCache)


@inner(nogil=True)
def _tripled(x: int) -> int:
    return 3 * x


@pytest.fixture
def plainly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jit._process, "plain_steps", 100)


@pytest.mark.usefixtures("plainly")
def test_few_steps_are_taken_in_plain_python_and_more_are_compiled_with_all_that_is_called() -> None:
    """Whatever a kernel calls runs as it does itself."""
    ran: list[str] = []

    def told(x: int) -> int:
        ran.append("plain")
        return 3 * x

    called = Kernel(told, {"nogil": True}, keep=False)

    def through(x: int) -> int:
        return called(x) + 1

    outer: Any = jit_kernels(nogil=True)(through)
    assert suited(outer, 60)(5) == 16
    assert suited(outer, 40)(5) == 16
    assert (ran, outer.made, called.made) == (["plain"] * 2, False, False)
    assert suited(outer, 1) is outer

    def compiled(x: int) -> int:
        return _tripled(x) + 1

    whole: Any = jit_kernels(nogil=True)(compiled)
    assert suited(whole, 101)(5) == 16
    assert whole.made
    assert len(whole.dispatcher.signatures) == 1
    assert suited(whole, 1) is whole, "what is there is not run as plain Python"


@pytest.mark.usefixtures("plainly")
def test_what_takes_more_is_done_by_arrays_until_something_is_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jit._process, "made", False)
    kernel: Any = jit_kernels(nogil=True)(doubled)
    other: Any = jit_kernels(nogil=True)(doubled)

    def twin(x: int) -> int:
        return x + x

    assert suited(kernel, 100, twin, 1000) == kernel.plainly
    assert suited(kernel, 600, twin, 1000) is twin
    assert suited(kernel, 600, twin, 1000) is kernel, "it has taken 600 of 1000 steps"
    assert suited(kernel, 400, twin, 1000) is twin
    assert suited(kernel, 1) is kernel
    assert kernel(4) == 8
    assert suited(other, 600, twin, 1000) is other, "numba is there"
    take_plainly(0)
    jit._process.made = False
    assert suited(other, 1, twin, 1000) is other


@pytest.mark.usefixtures("plainly")
def test_none_runs_as_plain_python_once_everything_is_to_be_compiled() -> None:
    kernel: Any = jit_kernels(nogil=True)(doubled)
    assert suited(kernel, 1) == kernel.plainly
    take_plainly(0)
    assert suited(kernel, 1) is kernel


def test_the_clock_of_limits_stands_still_while_something_is_compiled() -> None:
    before_s, before_made_s = running_s(), made_s()
    with compiling():
        within_s = running_s()
        with compiling():
            time.sleep(0.05)
        assert running_s() == within_s
    assert made_s() - before_made_s >= 0.05
    assert running_s() >= before_s
    kernel: Any = jit_kernels(nogil=True)(doubled)
    since_s = made_s()
    kernel(4)
    assert made_s() > since_s


@pytest.mark.parametrize("clock", [running_s, counted_s])
def test_a_clock_that_stands_still_does_so_while_it_is_read(
    clock: Callable[[], float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A thread may be held up between any two looks at the system's clock."""
    ticks = itertools.count(1000)
    monkeypatch.setattr(jit.time, "monotonic", lambda: float(next(ticks)))
    with compiling():
        assert clock() == clock()


@pytest.mark.parametrize("compiles", [True, False])
def test_the_clock_of_commands_stands_still_while_something_is_compiled_and_counts_loading(
    compiles: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    now_s = 1000.0
    monkeypatch.setattr(jit.time, "monotonic", lambda: now_s)
    before_s, before_running_s = counted_s(), running_s()
    with compiling():
        now_s += 3.0
        if compiles:
            note_compiled()
        assert counted_s() == before_s
    assert counted_s() == before_s + (0.0 if compiles else 3.0)
    assert running_s() == before_running_s
    now_s += 2.0
    assert counted_s() == before_s + (2.0 if compiles else 5.0)


def test_a_kernel_that_is_kept_is_loaded_and_one_that_is_not_is_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[str] = []
    monkeypatch.setattr(jit, "note_compiled", lambda: told.append("compiled"))
    run()
    assert told == ["compiled"] * 2
    run()
    assert told == ["compiled"] * 2


@pytest.mark.parametrize(("asked", "found"), [("3", 3), ("0", 1), ("many", 1)])
def test_as_many_threads_as_the_environment_says(asked: str, found: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_NUM_THREADS", asked)
    assert cores() == found


def test_else_a_thread_for_each_core(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NUMBA_NUM_THREADS", raising=False)
    assert cores() == numba.config.NUMBA_DEFAULT_NUM_THREADS


LIBRARIES = "numba ortools pandas scipy ezdxf matplotlib"
NESTS = Path(jit.__file__).parents[1] / "examples" / "nests"


@pytest.mark.slow
@pytest.mark.parametrize("given", [("e1x_6.json",), ("e1x_6.json", "--time-limit", "20")])
def test_a_small_nest_is_planned_without_a_kernel_that_is_compiled(given: tuple[str, ...], tmp_path: Path) -> None:
    """Of 16 contours. Not even numba is loaded: that would take longer than the planning."""
    script = (
        "import sys; from kerfwise.cli import main\n"
        "try: main(sys.argv[1:-1])\nfinally: print([m for m in sys.argv.pop().split() if m in sys.modules])"
    )
    nest, *limit = given
    words = ("solve", str(NESTS / nest), "-o", "made.nc", "--picture", "made.svg", *limit, LIBRARIES)
    run = subprocess.run(
        [sys.executable, "-c", script, *words], cwd=tmp_path, capture_output=True, encoding="utf-8", check=True
    )
    assert run.stdout.splitlines()[-1] == "[]"


@pytest.mark.slow
def test_a_kept_kernel_that_makes_arrays_runs_where_nothing_is_compiled(folder: Path) -> None:
    """Their memory is counted by numba's runtime: it is there, though a process has loaded all its kernels."""
    script = (
        "import numpy as np; from kerfwise.models.physics.heat.timed_path import _fill as kernel\n"
        "xy, at_s = np.array([[1.0, 1.0], [5.0, 1.0], [5.0, 4.0]]), np.array([0.0, 1.0, 2.0])\n"
        "dose, point = np.zeros((99, 2)), np.full((99, 2), -1)\n"
        "print(kernel(xy, at_s, 10, 10, dose, point, np.zeros(99), np.zeros((99, 2), dtype=np.int64)))\n"
        "print(sum(kernel.dispatcher._cache_hits.values()))"
    )
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder)}
    first, second = (
        subprocess.run([sys.executable, "-c", script], capture_output=True, encoding="utf-8", env=environment)
        for _ in range(2)
    )
    assert (first.returncode, second.returncode) == (0, 0)
    assert (first.stdout.split()[:-1], second.stdout.split()[-1]) == (second.stdout.split()[:-1], "1")


def test_kernels_compile_without_scipy_and_load_with_still_less() -> None:
    """That takes as long as numba itself; products of matrices still find it, where somebody else compiles such."""
    script = (
        "import sys, kerfwise.models.numba_cache\nprint('numba.np.arraymath' in sys.modules)\n"
        "from kerfwise.models.jit import jit\nprint(jit()(lambda x: x + 1)(1))\n"
        "from numba.np import arraymath\nprint('scipy.linalg' in sys.modules, arraymath._HAVE_BLAS)"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, encoding="utf-8", check=True)
    assert run.stdout.split() == ["False", "2", "False", "True"]


def test_what_only_kernels_call_has_machine_code_in_those_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Numba gives every function machine code, and optimises it again wherever it is called."""
    emitted: list[str] = []
    emit = JITCodeLibrary._finalize_final_module

    def noted(self: Any) -> None:
        emitted.append(self.name)
        emit(self)

    monkeypatch.setattr(JITCodeLibrary, "_finalize_final_module", noted)

    @inner(nogil=True)
    def part(x: int) -> int:
        return x if x < 10 else part(x - 7) + 1

    @inner(nogil=True)
    def sums(values: Any) -> Any:
        room = np.empty(len(values), np.int64)
        for k in range(len(values)):
            room[k] = part(values[k])
        return room.sum()

    @jit.jit(nogil=True)
    def kernel(values: Any) -> Any:
        return sums(values) + part(30)

    assert kernel(np.array([5, 24, 40])) == 5 + 6 + 10 + 12 == kernel.plainly(np.array([5, 24, 40]))
    own = [name.rpartition(".")[2] for name in emitted if "what_only_kernels" in name]
    assert own == ["kernel"]


@pytest.mark.parametrize("ends_well", [True, False])
def test_what_another_process_compiles_is_waited_for(
    ends_well: bool, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, _ = run()
    assert is_kept(first.dispatcher)
    folder.rename(tmp_path / "made")
    looks = iter(range(10))

    def runs() -> bool:
        if next(looks) < 3:
            return True
        if ends_well:
            shutil.copytree(tmp_path / "made", folder, dirs_exist_ok=True)
        return False

    monkeypatch.setattr(numba_cache, "LOOK_S", 0.0)
    compiled_beside(doubled, runs)
    again, told = run()
    assert not told
    assert hits(again) == (2 if ends_well else 0)
    assert next(looks) == 4
    assert is_kept(again.dispatcher)


def test_a_kernel_of_another_source_is_not_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kernel, _ = run()
    files = kernel.dispatcher._cache._cache_file
    assert files.any_kept()
    monkeypatch.setitem(files.__dict__, "made_by", b"another".ljust(32))
    assert not files.any_kept()


def test_objects_are_collected_again_once_a_kernel_is_compiled() -> None:
    with compiling():
        assert not gc.isenabled()
        with compiling():
            assert not gc.isenabled()
        assert not gc.isenabled()
    assert gc.isenabled()
