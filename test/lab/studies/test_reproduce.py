"""`omega_turn reproduce` from the outside."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import unsearched

from omega_turn_lab import cli
from omega_turn_lab.studies import NAMES, run
from omega_turn_lab.studies import tasks as tasks_module
from omega_turn_lab.studies.flat import AREA_LIMITS
from omega_turn_ros.design.problem import Design, DesignProblem

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def designed(monkeypatch: pytest.MonkeyPatch) -> list[DesignProblem]:
    """Problems that were designed for, in this process and without a search."""
    problems = []

    def design(problem: DesignProblem, seed: int, area_limit: float) -> Design:
        problems.append(problem)
        return unsearched(problem, seed, area_limit)

    monkeypatch.setattr(tasks_module, 'design_direct', design)
    return problems


def reproduce(out: Path, *arguments: str) -> int:
    return cli.main(['reproduce', *arguments, '--no-pybullet', '--jobs', '1', '--out', str(out)])


def test_a_study_leaves_its_figure_its_numbers_and_its_table(
    designed: list[DesignProblem], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert reproduce(tmp_path, 'evolution', '--seed', '2') == 0
    record = json.loads((tmp_path / 'evolution.json').read_text())
    assert (record['study'], record['seed']) == ('evolution', 2)
    assert record['seconds'] > 0.0 and len(designed) == 1
    assert (tmp_path / 'evolution.png').stat().st_size > 10_000
    printed = capsys.readouterr()
    assert '105.7 ± 2.1' in printed.out and 'difference' in printed.out
    assert 'designing gaits' in printed.err and '1/1' in printed.err


def test_finished_cases_are_reused_unless_fresh_or_of_another_seed(
    designed: list[DesignProblem], tmp_path: Path
) -> None:
    counts = []
    for extra in ((), (), ('--seed', '1'), ('--fresh',), ()):
        assert reproduce(tmp_path, 'evolution', *extra) == 0
        counts.append(len(designed))
    assert counts == [1, 1, 2, 3, 3]


def test_studies_share_the_cases_they_have_in_common(
    designed: list[DesignProblem], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, 'available', lambda: ['flat', 'evolution', 'joints'])
    assert reproduce(tmp_path, 'all') == 0
    asked = [
        (problem.chain.n_joints, problem.k_f, problem.k_t, problem.theta_max)
        for problem in designed
    ]
    limited = len(AREA_LIMITS)  # gaits of the omega turn's problem beside its best
    assert len(asked) == len(set(asked)) + limited == 3 * 7 + limited
    assert {path.stem for path in tmp_path.glob('*.json')} == {'flat', 'evolution', 'joints'}


@pytest.mark.parametrize(
    ('arguments', 'field'),
    [
        (['flat', '--jobs', '0'], 'jobs'),
        (['flat', '--jobs', '-3'], 'jobs'),
        (['flat', '--out', '/dev/null/out'], 'out'),
    ],
)
def test_a_bad_option_is_named_before_any_work(
    arguments: list[str], field: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(['reproduce', '--out', str(tmp_path), '--no-pybullet', *arguments]) == 2
    assert f'error: {field}: got' in capsys.readouterr().err


def test_a_study_nobody_knows_is_refused_with_the_list(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit) as exit_code:
        cli.main(['reproduce', 'tables'])
    assert exit_code.value.code == 2
    message = capsys.readouterr().err
    assert all(name in message for name in (*NAMES, 'all'))


def test_without_pybullet_the_error_says_how_to_do_without(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(run, 'find_spec', lambda name: None if name == 'pybullet' else object())
    assert cli.main(['reproduce', 'flat', '--out', str(tmp_path)]) == 1
    message = capsys.readouterr().err
    assert 'pip install' in message and '--no-pybullet' in message


def test_the_command_line_loads_nothing_heavy_until_asked() -> None:
    code = (
        'import sys, omega_turn_lab.cli; '
        'print([m for m in ("numpy", "scipy", "numba", "matplotlib", "joblib", "distributed", '
        '"rich", "shapely", "pybullet", "cma") if m in sys.modules])'
    )
    done = subprocess.run(
        [sys.executable, '-c', code], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.strip() == '[]'


def interrupted_study(tmp_path: Path, send: Callable[[subprocess.Popen[str]], None]) -> str:
    """Interrupt a study once its first case is finished; return what it said on stderr."""
    process = subprocess.Popen(
        [
            *(sys.executable, '-m', 'omega_turn_lab.cli', 'reproduce', 'joints'),
            *('--no-pybullet', '--jobs', '2', '--out', str(tmp_path)),
        ],
        cwd=ROOT,
        env={**os.environ, 'PYTHONPATH': str(ROOT)},
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # A shell that runs the tests in the background has them ignore it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        deadline = time.monotonic() + 200.0
        while not list((tmp_path / '.cache').glob('*.json')):
            assert process.poll() is None and time.monotonic() < deadline
            time.sleep(0.02)
        send(process)
        _, errors = process.communicate(timeout=30)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    assert process.returncode == 130
    return errors


def test_sigterm_ends_it_quietly_like_ctrl_c(tmp_path: Path) -> None:
    errors = interrupted_study(tmp_path, subprocess.Popen.terminate)
    assert errors.splitlines()[-1] == 'interrupted'
    assert not any(word in errors for word in ('Traceback', 'Warning', 'leaked'))


@pytest.mark.slow
def test_an_interrupt_keeps_what_is_finished_and_exits_130(tmp_path: Path) -> None:
    def to_every_process_of_the_job(process: subprocess.Popen[str]) -> None:  # as a terminal does
        os.killpg(process.pid, signal.SIGINT)

    errors = interrupted_study(tmp_path, to_every_process_of_the_job)
    assert 'interrupted' in errors and 'Traceback' not in errors
    finished = list((tmp_path / '.cache').iterdir())
    assert finished and all(path.suffix == '.json' for path in finished)
    assert not list(tmp_path.glob('*.json')), 'a study that was not finished'
