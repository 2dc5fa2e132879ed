"""Sweeps give the same numbers wherever they run, and go on where they were stopped."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from cases import Hopeless, Square, WhoAmI

from omega_turn_lab.studies import executor as executor_module
from omega_turn_lab.studies.executor import DaskExecutor, LocalExecutor, compute
from omega_turn_lab.studies.store import ResultStore
from omega_turn_lab.studies.study import Plan
from omega_turn_lab.studies.tasks import Result, Task
from omega_turn_ros.errors import (
    BadInputError,
    MissingPackageError,
    OmegaTurnError,
)
from omega_turn_ros.robot import load_robot

SQUARES = [Square(value) for value in range(5)]

IN_PROCESS: dict[str, Any] = {
    'processes': False,
    'protocol': 'tcp://',
    'host': '127.0.0.1',
    'dashboard_address': ':0',
}


@pytest.fixture(scope='module')
def scheduler() -> Iterator[str]:
    """Address of a Dask cluster in this process, reached over TCP as a real one."""
    distributed = pytest.importorskip('distributed')
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, **IN_PROCESS) as cluster:
        yield cluster.scheduler_address


class Counting:
    """Computes in this process; gives up after so many cases."""

    def __init__(self, limit: int = 99) -> None:
        self.limit = limit
        self.done: list[Task] = []

    def results(self, tasks: Sequence[Task]) -> Iterator[tuple[int, Result]]:
        for index, task in enumerate(tasks):
            if len(self.done) == self.limit:
                raise KeyboardInterrupt
            self.done.append(task)
            yield index, task.run()


def test_one_process_two_processes_and_a_cluster_give_the_same_gaits(
    scheduler: str, tmp_path: Path
) -> None:
    robot = load_robot('limbless16').with_yaw_joints(3)
    tasks = [Plan(robot, seed=3).design(k_t, k_f=1.0) for k_t in (0.0, 0.5)]
    found = [
        compute(tasks, executor, ResultStore(tmp_path / str(i)), 'test')
        for i, executor in enumerate((LocalExecutor(1), LocalExecutor(2), DaskExecutor(scheduler)))
    ]
    assert found[0] == found[1] == found[2]
    assert all(result['angle_deg'] > 1.0 for result in found[0].values())


@pytest.mark.parametrize(('jobs', 'elsewhere'), [(1, False), (2, True)])
def test_more_than_one_job_means_other_processes_of_one_thread(jobs: int, elsewhere: bool) -> None:
    results = dict(LocalExecutor(jobs).results([WhoAmI(value) for value in range(4)]))
    assert sorted(results) == [0, 1, 2, 3]
    assert all((found['pid'] != os.getpid()) == elsewhere for found in results.values())
    if elsewhere:
        assert all(found['threads'] == '1' for found in results.values())


def test_equal_cases_are_computed_once(tmp_path: Path) -> None:
    executor = Counting()
    results = compute([*SQUARES, *SQUARES], executor, ResultStore(tmp_path), 'test')
    assert executor.done == SQUARES
    assert results == {task: task.run() for task in SQUARES}


def test_an_interrupted_sweep_goes_on_where_it_stopped(tmp_path: Path) -> None:
    store = ResultStore(tmp_path)
    with pytest.raises(KeyboardInterrupt):
        compute(SQUARES, Counting(3), store, 'test')
    rest = Counting()
    assert compute(SQUARES, rest, store, 'test') == {task: task.run() for task in SQUARES}
    assert rest.done == SQUARES[3:]
    none = Counting()
    compute(SQUARES, none, store, 'test')
    assert none.done == []


@pytest.mark.parametrize('where', ['here', 'there', 'cluster'])
def test_a_case_that_fails_says_which_and_why(where: str, scheduler: str, tmp_path: Path) -> None:
    executor = {
        'here': LocalExecutor(1),
        'there': LocalExecutor(2),
        'cluster': DaskExecutor(scheduler),
    }[where]
    with pytest.raises(OmegaTurnError, match=r'Hopeless\(value=7\): value: got 7, expected a'):
        compute([Hopeless(7)], executor, ResultStore(tmp_path), 'test')
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('jobs', [0, -2])
def test_no_processes_are_refused(jobs: int) -> None:
    with pytest.raises(BadInputError, match='jobs'):
        LocalExecutor(jobs)


@pytest.mark.parametrize('address', ['tcp://127.0.0.1:9', 'nonsense'])
def test_a_missing_scheduler_is_named(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip('distributed')
    monkeypatch.setattr(executor_module, 'CONNECT_TIMEOUT', 1)
    with pytest.raises(BadInputError, match=f'dask: got .{address}'):
        compute(SQUARES, DaskExecutor(address), ResultStore(tmp_path), 'test')


def test_a_scheduler_without_workers_is_not_waited_for_forever(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    distributed = pytest.importorskip('distributed')
    monkeypatch.setattr(executor_module, 'WORKER_TIMEOUT', 0.2)
    with (
        distributed.LocalCluster(n_workers=0, **IN_PROCESS) as cluster,
        pytest.raises(OmegaTurnError, match='dask worker'),
    ):
        compute(SQUARES, DaskExecutor(cluster.scheduler_address), ResultStore(tmp_path), 'test')


def test_a_worker_with_other_code_is_refused(
    scheduler: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = executor_module.code_fingerprint
    calls = iter(['ours'])
    monkeypatch.setattr(executor_module, 'code_fingerprint', lambda m: next(calls, real(m)))
    with pytest.raises(OmegaTurnError, match='other versions'):
        compute(SQUARES[:1], DaskExecutor(scheduler), ResultStore(tmp_path), 'test')


def test_without_dask_the_error_says_how_to_get_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, 'distributed', None)
    with pytest.raises(MissingPackageError, match=r"pip install 'dask\[distributed\]'"):
        compute(SQUARES, DaskExecutor('tcp://127.0.0.1:9'), ResultStore(tmp_path), 'test')
