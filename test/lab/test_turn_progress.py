"""Progress of a turn where there is no terminal: whole lines, at once."""

from __future__ import annotations

import pytest

from omega_turn_lab import turn_progress


def test_a_log_gets_lines_and_no_bar(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(turn_progress, 'LINE_EVERY', 0.0)
    progress = turn_progress.TurnProgress(90.0)
    for left in (95.0, 60.0, 0.0):
        progress.show(left, jammed=False)
    progress.close()
    assert capsys.readouterr().err.splitlines() == [
        'turning   0%, 0.0/90.0 deg',
        'turning  33%, 30.0/90.0 deg',
        'turning 100%, 90.0/90.0 deg',
    ]
