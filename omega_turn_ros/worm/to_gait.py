"""A robot's gait out of a worm's turn: one cycle of both waves, closed and scaled to fit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from omega_turn_ros.design.calibrate import make_library_gait
from omega_turn_ros.design.problem import FINEST, DesignProblem
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.fourier_gait import FourierGait, fourier_waves
from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_ros.gaits.two_wave import two_wave_angles
from omega_turn_ros.robot import Robot
from omega_turn_ros.worm.kymograph import Kymograph
from omega_turn_ros.worm.template import TwoWaves, Wave, best_pair, fit_two_waves
from omega_turn_ros.worm.turns import deepest_bend, find_turns

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SAMPLES = 72  # of the cycle, evenly in phase
STARTS = 8  # first guesses of the lag between the waves
SCREENING, FITTING = 8, 200  # iterations from each of them, and from the best
LONGEST = 20.0  # [s] what takes longer to go round is no wave


@dataclass(frozen=True, slots=True)
class Cycle:
    """One cycle of the forward wave in a recording.

    Attributes:
        trial: its index.
        start: its first frame, numbered as in the recording.
        stop: the frame after its last.
        bend: mean size of the deepest bend over it [rad].
    """

    trial: int
    start: int
    stop: int
    bend: float


@dataclass(frozen=True, slots=True)
class WormGait:
    """A worm's turn on a robot.

    Attributes:
        entry: the gait, calibrated, turning counter-clockwise.
        cycle: where it comes from.
        likeness: share of the sum of squares of the worm's two waves, over that cycle, that the
            closed gait reproduces before scaling.
        factor: of both amplitudes, so that the robot keeps its limits; 1 is as bent as the worm.
        unscaled: angle of a cycle if the robot could bend like the worm [rad].
        clearance: smallest gap of the robot to itself [m].
    """

    entry: LibraryGait
    cycle: Cycle
    likeness: float
    factor: float
    unscaled: float
    clearance: float


def deepest_cycle(trials: Sequence[Kymograph], waves: TwoWaves) -> Cycle:
    """Find the cycle of the forward wave, in either direction, over which bodies bend deepest.

    The forward wave is the clock: the longer one may be little more than a bend to one side.

    Args:
        trials: the recordings.
        waves: fitted to them.

    Raises:
        BadInputError: the forward wave never makes a whole cycle.
    """
    best: Cycle | None = None
    for index, (trial, wave) in enumerate(zip(trials, waves.forward)):
        phase = _clock(wave.signal)
        most = int(LONGEST * trial.fps)
        bends = np.concatenate([[0.0], np.cumsum(np.abs(deepest_bend(trial.angles)))])
        for start in range(len(phase)):
            far = np.abs(phase[start : start + most] - phase[start]) >= 2.0 * np.pi
            if not far.any():
                continue
            stop = start + int(far.argmax()) + 1
            bend = float(bends[stop] - bends[start]) / (stop - start)
            if best is None or bend > best.bend:
                best = Cycle(index, trial.first + start, trial.first + stop, bend)
    if best is None:
        expected = 'a whole cycle of the forward wave: more frames around the turn'
        raise BadInputError('recording', 'none', expected)
    return best


def turn_waves(trials: Sequence[Kymograph]) -> TwoWaves:
    """Fit the template to the deepest turn, told from the straight body.

    A turn is too short for its mean posture to be the animal's rest posture: it is the bend to
    one side that turns the body, and a gait needs it (own derivation).

    Args:
        trials: the recordings, all with equal N; without a turn all their frames count.

    Returns:
        Waves of the turn's k_t and k_f in all frames.
    """
    turns = [(turn, trial) for trial in trials for turn in find_turns(trial)]
    chosen = list(trials)
    if turns:
        turn, trial = max(turns, key=lambda pair: abs(pair[0].bend))
        chosen = [trial.cut(turn.start, turn.stop)]
    pair = best_pair(sum(part.angles.T @ part.angles for part in chosen))
    angles = [trial.angles for trial in trials]
    return fit_two_waves(angles, angles, trials[0].fps, pair)


def worm_gait(
    trials: Sequence[Kymograph], robot: Robot, name: str, harmonics: int = 1
) -> WormGait:
    """Turn the deepest bent cycle of recordings into a gait.

    The robot takes on the worm's curvature per body length. A wave that travels from head to tail
    gets a negative spatial frequency. A recorded cycle does not end as it began: f_1, f_2 and f_3
    as Fourier series close it, fitted to the joint angles of both waves by least squares; a mean
    and one harmonic each are as rich as eq:prescribe_amp. Where the robot cannot bend so far,
    both amplitudes are scaled down (own derivation).

    Args:
        trials: the recordings, all with equal N.
        robot: whose limits are kept.
        name: of the gait.
        harmonics: of each series.

    Raises:
        BadInputError: there is no cycle, the robot has too few joints for the waves, or the gait
            does not turn it.
    """
    if harmonics < 1:
        raise BadInputError('harmonics', harmonics, 'at least 1')
    waves = turn_waves(trials)
    if waves.k_f > 0.5 * robot.n_yaw:
        expected = f'at most {0.5 * robot.n_yaw:g}, half the yaw joints of {robot.name}'
        raise BadInputError('k_f', waves.k_f, expected)
    cycle = deepest_cycle(trials, waves)
    trial = trials[cycle.trial]
    frames = slice(cycle.start - trial.first, cycle.stop - trial.first)
    pair = (waves.turning[cycle.trial], waves.forward[cycle.trial])
    turning, forward = (_on_robot(wave, frames, trial.n_positions, robot.n_yaw) for wave in pair)
    k_t, k_f = waves.k_t, waves.k_f
    phase = _clock(forward)
    if phase[-1] < phase[0]:  # A sin(tau + a) = -A sin(-tau - a)
        turning, forward, phase = -turning.conj(), -forward.conj(), np.pi - phase
        k_t, k_f = -k_t, -k_f
    gait, likeness = _closed_gait(phase, turning, forward, k_f, k_t, robot.n_yaw, harmonics)
    problem = DesignProblem.of_robot(robot, robot.position_limit)
    factor = min(1.0, problem.feasible_factor(problem.path(gait, FINEST), 1e-7))
    scaled = gait.scaled(factor)
    text = f'Turn of a worm: {trial.name}, frames {cycle.start} to {cycle.stop - 1}'
    entry = make_library_gait(name, text, scaled, robot)
    clearance = problem.clearance(problem.path(entry.waves))
    unscaled = abs(problem.turn(problem.path(gait)))
    return WormGait(entry, cycle, likeness, factor, unscaled, clearance)


def _clock(signal: Complex) -> Array:
    """Phase of a wave [rad], continuous where its amplitude passes through zero to below."""
    phase: Array = 0.5 * np.unwrap(2.0 * np.angle(signal))
    return phase


def _on_robot(wave: Wave, frames: slice, positions: int, joints: int) -> Complex:
    """The wave in joint angles of a body with another number of joints, at the same places.

    Position i of N stands for the part of the body around (i - 1/2)/N.
    """
    shift = 2.0 * np.pi * wave.k * (0.5 / positions - 0.5 / joints)
    signal: Complex = wave.signal[frames] * np.exp(1j * shift) * positions / joints
    return signal


def _closed_gait(
    phase: Array,
    turning: Complex,
    forward: Complex,
    k_f: float,
    k_t: float,
    joints: int,
    harmonics: int,
) -> tuple[FourierGait, float]:
    """Fit the series to a cycle; return the gait and the share of squares it reproduces."""
    tau = phase[0] + 2.0 * np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES
    rising = np.maximum.accumulate(phase)  # a worm may hesitate
    first, second = (_at(tau, rising, signal) for signal in (turning, forward))
    target = two_wave_angles(
        np.abs(second), np.angle(second), np.abs(first), np.angle(first), k_f, k_t, joints
    )
    terms = 2 * harmonics + 1

    def angles(x: Array) -> Array:
        f_1, f_2, f_3 = (tuple(part) for part in np.split(x[1:], 3))
        amplitude_f, tau_f, amplitude_t, tau_t = fourier_waves(tau + x[0], f_1, f_2, f_3)
        return two_wave_angles(amplitude_f, tau_f, amplitude_t, tau_t, k_f, k_t, joints)

    def off(x: Array) -> Array:
        result: Array = (angles(x) - target).ravel()
        return result

    ahead = float(np.angle(np.sum(first * np.exp(-1j * tau))))  # turning wave before the clock
    fits = []
    for k in range(STARTS):
        guess = np.zeros(1 + 3 * terms)
        guess[0] = ahead
        guess[[1, 1 + terms]] = np.abs(second).mean(), np.abs(first).mean()
        guess[1 + 2 * terms] = 2.0 * np.pi * k / STARTS
        fits.append(least_squares(off, guess, max_nfev=SCREENING))
    best = least_squares(off, min(fits, key=lambda fit: fit.cost).x, max_nfev=FITTING)
    series = [[float(c) for c in part] for part in np.split(best.x[1:], 3)]
    series[2][0] = math.remainder(series[2][0], math.tau)
    gait = FourierGait(k_f, k_t, *(tuple(part) for part in series))
    return gait, 1.0 - 2.0 * best.cost / float((target**2).sum())


def _at(tau: Array, phase: Array, signal: Complex) -> Complex:
    """The signal at other phases, linear in between."""
    real, imaginary = (np.interp(tau, phase, part) for part in (signal.real, signal.imag))
    both: Complex = real + 1j * imaginary
    return both
