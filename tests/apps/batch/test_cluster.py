"""The same batch on a Dask scheduler on the loopback, one of whose workers is killed in the middle."""

from __future__ import annotations

import subprocess
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from kerfwise.apps.batch.result import Row
from kerfwise.apps.batch.run import Cluster, Watcher, plan_task, run_batch
from kerfwise.apps.batch.store import Store
from kerfwise.apps.batch.tasks import Machines, NestTask, Options, machine_of, sources_in
from kerfwise.benchmarks.dask_here import cluster
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import read_limited
from kerfwise.jobs.process_pool import run_in_process
from kerfwise.tests.apps.batch.nests import write_nests

pytestmark = [pytest.mark.dask, pytest.mark.slow]
ANSWER_S = 120
NAMES = ("one", "two", "two with holes", "three", "more/four", "off the sheet")


@contextmanager
def scheduler_and_workers(folder: Path, count: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """The address of a scheduler of this machine that answers, and the processes of its workers."""
    from distributed import Client

    with cluster(folder, count) as (address, workers):
        with Client(address, timeout=ANSWER_S, set_as_default=False) as client:
            if count:
                client.wait_for_workers(count, timeout=ANSWER_S)
        yield address, workers


class Killing(Watcher):
    """Kills a worker as soon as a nest is finished; counts what is finished."""

    def __init__(self, worker: subprocess.Popen[bytes]) -> None:
        self.worker, self.ends = worker, Counter[str]()
        self.begun: list[str] = []

    def began(self, piece: NestTask) -> None:
        self.begun.append(piece.name)

    def ended(self, row: Row) -> None:
        self.ends[row.nest] += 1
        self.worker.kill()


@pytest.mark.full
def test_every_nest_is_done_once_though_a_worker_is_killed(tmp_path: Path) -> None:
    given, options = write_nests(tmp_path / "in", NAMES), Options(work=0.2)
    machines, told = Machines((machine_of("plasma", "plasma-carbon-steel", False),)), []
    with scheduler_and_workers(tmp_path, 2) as (address, workers):
        watcher = Killing(workers[0])
        with Cluster(plan_task, address, told.append) as workers_there:
            store = Store(tmp_path / "cluster")
            batch = run_batch(sources_in([given], store.out), machines, store, options, "1", workers_there.run, watcher)
        assert workers[0].wait() != 0
        assert workers[1].poll() is None
    assert batch.exit_code == 1
    assert watcher.ends == Counter(dict.fromkeys(NAMES, 1))
    assert sorted(watcher.begun) == sorted(NAMES)
    assert told == []
    alone = Store(tmp_path / "alone")
    run_batch(sources_in([given], alone.out), machines, alone, options, "1", run_in_process(plan_task))
    assert files(alone.out) == files(store.out)


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): read_limited(path) for path in folder.rglob("*") if path.is_file()}


@pytest.mark.full
def test_a_scheduler_that_is_lost_or_never_was_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kerfwise.apps.batch.run.ANSWER_S", 3.0)
    address = "tcp://127.0.0.1:1"  # nobody listens there
    with pytest.raises(InputError, match=rf"--scheduler {address}: no Dask scheduler answers"):
        Cluster(plan_task, address, print)
    with pytest.raises(InputError, match="no Dask scheduler answers"):
        Cluster(plan_task, "nonsense://x", print)
    told: list[str] = []
    with scheduler_and_workers(tmp_path, 0) as (there, _), Cluster(abs, there, told.append) as lost:
        assert ["has no worker yet" in text for text in told] == [True]
        from distributed import Client

        threading.Timer(1.0, lambda: Client(there, set_as_default=False).shutdown()).start()
        with pytest.raises(InputError, match="was lost; the same command goes on from here"):
            list(lost.run([-1], lambda piece: None))
