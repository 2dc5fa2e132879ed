"""Fourier gaits: the paper's family is a special case, and scalar and array forms agree."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.fourier_gait import FourierGait
from omega_turn_ros.gaits.library import gait_to_mapping, load_gait
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait

coefficient = st.floats(-1.5, 1.5)
series = st.integers(0, 3).flatmap(
    lambda m: st.lists(coefficient, min_size=2 * m + 1, max_size=2 * m + 1).map(tuple)
)
gaits = st.builds(FourierGait, st.just(1.5), st.just(1.0), series, series, series)
SEEDED = settings(derandomize=True, deadline=None, max_examples=60)


def test_the_paper_s_gait_is_one_harmonic_with_a_constant_lag() -> None:
    paper = TwoWaveGait(1.5, 1.0, 0.59, 0.3, -1.02, -0.78, -2.75, -3.07)
    fourier = FourierGait(
        1.5,
        1.0,
        (0.59 * 0.3, 0.59 * math.sin(-1.02), 0.59 * math.cos(-1.02)),
        (-0.78, -0.78 * math.sin(-2.75), -0.78 * math.cos(-2.75)),
        (-3.07,),
    )
    phases = np.linspace(-3.0, 9.0, 200)
    np.testing.assert_allclose(fourier.angles(phases, 8), paper.angles(phases, 8), atol=1e-12)


@SEEDED
@given(gait=gaits, phase=st.floats(-20.0, 20.0))
def test_scalar_and_array_forms_agree(gait: FourierGait, phase: float) -> None:
    forward, tau_f, turning, tau_t = gait.waves_at(phase)
    assert [forward, turning] == pytest.approx(
        [float(a) for a in gait.amplitudes(phase)], abs=1e-12
    )
    assert [tau_f, tau_t] == pytest.approx([float(p) for p in gait.phases(phase)], abs=1e-12)


@SEEDED
@given(gait=gaits, phase=st.floats(-6.0, 6.0))
def test_a_cycle_closes_and_the_mirror_negates_every_joint(
    gait: FourierGait, phase: float
) -> None:
    np.testing.assert_allclose(
        gait.angles(phase + 2.0 * np.pi, 8), gait.angles(phase, 8), atol=1e-11
    )
    np.testing.assert_array_equal(gait.mirrored().angles(phase, 8), -gait.angles(phase, 8))


@pytest.mark.parametrize(
    ('field', 'value'),
    [('forward', ()), ('turning', (1.0, 2.0)), ('lag', (math.nan,)), ('k_f', math.inf)],
)
def test_a_broken_series_is_refused_by_name(field: str, value: object) -> None:
    fields = {'k_f': 1.5, 'k_t': 1.0, 'forward': (1.0,), 'turning': (1.0,), 'lag': (0.0,)}
    with pytest.raises(BadInputError, match=f'gait field {field}'):
        FourierGait(**{**fields, field: value})


def test_a_fourier_gait_survives_its_file(tmp_path: Path) -> None:
    shipped = load_gait('omega_fast')
    assert isinstance(shipped.gait, FourierGait)
    path = tmp_path / 'copy.yaml'
    path.write_text(yaml.safe_dump(gait_to_mapping(shipped)))
    assert load_gait(str(path)).gait == shipped.gait


@pytest.mark.parametrize('broken', [{'forward': 3.0}, {'lag': None}, {'extra': [1.0]}])
def test_a_library_file_with_a_broken_series_is_refused(
    broken: dict[str, object], tmp_path: Path
) -> None:
    data = gait_to_mapping(load_gait('omega_fast'))
    data['parameters'] = {**data['parameters'], **broken}
    path = tmp_path / 'broken.yaml'
    path.write_text(yaml.safe_dump(data))
    with pytest.raises(BadInputError, match='gait'):
        load_gait(str(path))
