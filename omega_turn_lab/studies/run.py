"""`omega_turn reproduce`: compute what the studies need, print, draw and store it."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

from omega_turn_lab.folder import make_folder
from omega_turn_lab.studies import NAMES
from omega_turn_lab.studies.executor import DaskExecutor, Executor, LocalExecutor, compute
from omega_turn_lab.studies.rows import Row, print_table, write_json
from omega_turn_lab.studies.store import ResultStore
from omega_turn_lab.studies.study import Outcome, Plan, Study
from omega_turn_lab.studies.tasks import PhysicsTask
from omega_turn_ros.errors import BadInputError, MissingPackageError
from omega_turn_ros.robot import load_robot

ROBOT = 'limbless16'  # the paper's
CACHE = '.cache'
PACKAGE = 'omega_turn_lab.studies'
ELSEWHERE = {'height': 'height_study'}  # module of a study, where its own name is taken


@dataclass(frozen=True, slots=True)
class ReproduceOptions:
    """What `omega_turn reproduce` is told.

    Attributes:
        name: a study, or 'all'.
        out: folder for tables, figures and finished cases.
        seed: of every search.
        jobs: processes on this machine, -1 for one per core.
        dask: address of a Dask scheduler to use instead; None for this machine.
        pybullet: play the gaits in PyBullet too.
        fresh: compute everything again.
    """

    name: str
    out: Path = Path('out')
    seed: int = 0
    jobs: int = -1
    dask: str | None = None
    pybullet: bool = True
    fresh: bool = False


def load_study(name: str) -> Study:
    """Return a study by name.

    Raises:
        BadInputError: no such study.
    """
    if name not in available():
        raise BadInputError('study', name, f'one of {available()} or all')
    study: Study = import_module(f'{PACKAGE}.{ELSEWHERE.get(name, name)}').STUDY
    return study


def available() -> list[str]:
    """Names of the studies, in the paper's order."""
    return [name for name in NAMES if find_spec(f'{PACKAGE}.{name}') is not None]


def run_reproduce(options: ReproduceOptions) -> int:
    """Run one study or all of them; return 0.

    Raises:
        BadInputError: an option is unusable.
        MissingPackageError: PyBullet or Dask is wanted but not installed.
    """
    began = time.perf_counter()
    names = available() if options.name == 'all' else [options.name]
    studies = [load_study(name) for name in names]
    executor = _checked(options)
    outcome = compute_outcome(studies, options, executor)
    for name in names:  # none of another run may stand beside these numbers
        (options.out / f'{name}.png').unlink(missing_ok=True)
    computed = time.perf_counter() - began
    for study, (rows, telling) in zip(studies, _told(names, outcome, options)):
        path = options.out / f'{study.name}.json'
        trials = study.records(outcome)
        write_json(path, study.name, rows, options.seed, computed + telling, trials)
        print_table(study.title, rows)
        if not (options.out / f'{study.name}.png').exists():
            print(f'{study.name}: no figure without PyBullet')
    print(f'{time.perf_counter() - began:.1f} s, files in {options.out}')
    return 0


def _told(
    names: Sequence[str], outcome: Outcome, options: ReproduceOptions
) -> Iterator[tuple[list[Row], float]]:
    """Rows of each study, in order, its figures drawn, and the time that took [s].

    Where there are several, on all cores.
    """
    from joblib import Parallel, delayed

    jobs = options.jobs if len(names) > 1 else 1
    pool = Parallel(jobs, batch_size=1, return_as='generator')
    yield from pool(delayed(_tell)(name, outcome, options.out) for name in names)


def _tell(name: str, outcome: Outcome, out: Path) -> tuple[list[Row], float]:
    began = time.perf_counter()
    study = load_study(name)
    rows = study.rows(outcome)
    study.draw(outcome, out)
    return rows, time.perf_counter() - began


def compute_outcome(
    studies: Sequence[Study], options: ReproduceOptions, executor: Executor
) -> Outcome:
    """Compute every case that any of the studies needs, once."""
    store = ResultStore(options.out / CACHE, options.fresh)
    plan = Plan(load_robot(ROBOT), options.seed)
    designs = [task for study in studies for task in study.designs(plan)]
    designs.sort(key=lambda task: -task.cost)  # a long case begun last would be waited for
    outcome = Outcome(plan, compute(designs, executor, store, 'designing gaits'))
    if not options.pybullet:
        return outcome
    trials = [
        PhysicsTask(task.robot, outcome.gait(task))
        for study in studies
        if study.played
        for task in study.designs(plan)
    ]
    played = compute(trials, executor, store, 'playing in PyBullet')
    asked = [task for study in studies for task in study.trials(outcome)]
    tried = compute(asked, executor, store, 'trying on terrains') if asked else {}
    return Outcome(plan, outcome.designed, played, tried)


def _checked(options: ReproduceOptions) -> Executor:
    """Refuse unusable options before any work; return where the cases run."""
    if options.seed < 0:
        raise BadInputError('seed', options.seed, 'an integer >= 0')
    if options.pybullet and find_spec('pybullet') is None:
        raise MissingPackageError('pybullet', 'sim', 'go without: --no-pybullet')
    make_folder(options.out)
    return DaskExecutor(options.dask) if options.dask else LocalExecutor(options.jobs)
