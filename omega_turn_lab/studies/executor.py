"""Where cases run: on the cores of this machine, or on an existing Dask cluster."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

from omega_turn_lab.studies.store import ResultStore, code_fingerprint
from omega_turn_lab.studies.tasks import Result, Task
from omega_turn_ros.errors import BadInputError, MissingPackageError, OmegaTurnError

AnyTask = TypeVar('AnyTask', bound=Task)

CONNECT_TIMEOUT = 10  # [s]
WORKER_TIMEOUT = 30  # [s]


class Executor(Protocol):
    """Runs cases."""

    def results(self, tasks: Sequence[Task]) -> Iterator[tuple[int, Result]]:
        """Yield (index, result) of every case as each finishes."""


@dataclass(frozen=True, slots=True)
class LocalExecutor:
    """Processes on this machine, one thread each.

    Attributes:
        jobs: how many; -1 is one per core, 1 stays in this process.
    """

    jobs: int = -1

    def __post_init__(self) -> None:
        """Refuse no process at all."""
        if self.jobs == 0 or self.jobs < -1:
            raise BadInputError('jobs', self.jobs, 'a number of processes, or -1: one per core')

    def results(self, tasks: Sequence[Task]) -> Iterator[tuple[int, Result]]:
        """See `Executor.results`."""
        from joblib import Parallel, delayed, parallel_config

        # An interrupt ends the workers while their helper tidies up after them, too; what one
        # finds gone, because the other was faster, is no news to anybody.
        os.environ.setdefault('PYTHONWARNINGS', 'ignore:resource_tracker')
        with parallel_config(backend='loky', inner_max_num_threads=1):
            pool = Parallel(self.jobs, batch_size=1, return_as='generator_unordered')
            home = os.getpid()
            yield from pool(delayed(_numbered)(*pair, home) for pair in enumerate(tasks))


@dataclass(frozen=True, slots=True)
class DaskExecutor:
    """The workers of a Dask scheduler that already runs.

    Attributes:
        address: of the scheduler, such as 'tcp://10.0.0.1:8786'.
    """

    address: str

    def results(self, tasks: Sequence[Task]) -> Iterator[tuple[int, Result]]:
        """See `Executor.results`.

        Raises:
            BadInputError: no scheduler answers at the address.
            MissingPackageError: Dask is not installed.
            OmegaTurnError: the scheduler has no worker, or one has other code than we.
        """
        try:
            from distributed import as_completed
        except ModuleNotFoundError as error:
            raise MissingPackageError('dask[distributed]', 'cluster') from error
        with _client(self.address) as client:
            index = {
                client.submit(_run_same_code, task, code_fingerprint(task.code), pure=False): i
                for i, task in enumerate(tasks)
            }
            for future, result in as_completed(index, loop=client.loop, with_results=True):
                yield index[future], result


def _client(address: str) -> Any:
    """Connect to a scheduler that has at least one worker."""
    from distributed import Client

    expected = 'the address of a running scheduler, such as tcp://127.0.0.1:8786'
    if not address.rpartition(':')[2].isdecimal():
        raise BadInputError('dask', address, expected)  # Dask would look for it for long
    try:
        client = Client(address, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise BadInputError('dask', address, expected) from error
    try:
        client.wait_for_workers(1, timeout=WORKER_TIMEOUT)
    except TimeoutError as error:
        client.close()
        raise OmegaTurnError(f'{address} has no worker: dask worker {address}') from error
    return client


def _run(task: Task) -> Result:
    """Run a case; an error names it, and survives the way home from another process."""
    try:
        return task.run()
    except OmegaTurnError as error:
        raise OmegaTurnError(f'{task}: {error}') from error


def _numbered(index: int, task: Task, home: int) -> tuple[int, Result]:
    """Run a case in a worker, or in the process `home` itself."""
    if os.getpid() != home:
        # Ctrl-C reaches every process of the terminal; home is the one that ends the others.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    return index, _run(task)


def _run_same_code(task: Task, fingerprint: str) -> Result:
    """Run a case on a worker whose code gives the numbers ours would give."""
    if code_fingerprint(task.code) != fingerprint:
        raise OmegaTurnError('a Dask worker runs other versions of this package or its libraries')
    return _run(task)


def compute(
    tasks: Sequence[AnyTask], executor: Executor, store: ResultStore, label: str
) -> dict[AnyTask, Result]:
    """Run every case once, those already in the store not at all; keep each as it finishes.

    Args:
        tasks: cases, repeats allowed.
        executor: where they run.
        store: what was finished before, and where results go.
        label: for the progress bar.

    Returns:
        Result of each case.
    """
    from tqdm import tqdm

    known = {task: store.load(task) for task in dict.fromkeys(tasks)}
    results = {task: result for task, result in known.items() if result is not None}
    missing = [task for task in known if task not in results]
    with tqdm(total=len(known), initial=len(results), desc=label, unit='case') as bar:
        if missing:
            for index, result in executor.results(missing):
                store.save(missing[index], result)
                results[missing[index]] = result
                bar.update()
    return results
