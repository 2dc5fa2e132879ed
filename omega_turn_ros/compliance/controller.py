"""The compliance controller as one pure step: joint states in, amplitude offsets out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.compliance.admittance import (
    AdmittanceConfig,
    AdmittanceState,
    admittance_step,
    relax_step,
    wave_jacobian,
)
from omega_turn_ros.compliance.external_torque import (
    TorqueConfig,
    external_torque_step,
    needed_torques,
)
from omega_turn_ros.errors import BadInputError, ConvergenceError
from omega_turn_ros.mechanics.chain import PlanarChain

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ComplianceConfig:
    """Settings of the compliance controller.

    Attributes:
        k_f: spatial frequency of the forward wave.
        k_t: spatial frequency of the turning wave.
        torque_scale: factors on J tau_ext of (forward, turning) wave. A negative factor makes a
            wave push harder against what holds it, up to its bound: among pegs that is what pays
            (`omega_turn reproduce pegboard`). (1, 1) is the paper's law read straight, in N m:
            the wave yields to what pushes it. 0 keeps a wave as it is.
        relax_rate: offsets return to 0 at this rate without efforts or waves [rad/s].
        law: constants of the admittance law.
        torque: how efforts become external torques.
    """

    k_f: float = 1.5
    k_t: float = 1.0
    torque_scale: tuple[float, float] = (-8.0, -8.0)
    relax_rate: float = 0.5
    law: AdmittanceConfig = field(default_factory=AdmittanceConfig)
    torque: TorqueConfig = field(default_factory=TorqueConfig)


@dataclass(frozen=True, slots=True)
class ComplianceState:
    """What the compliance controller remembers.

    Attributes:
        admittance: amplitude offsets and their rates.
        filtered: low-passed external torque [N m], shape (N,).
        external: external torque behind the dead band [N m], shape (N,).
        zero: efforts that count as none, see `tare` [N m], shape (N,).
    """

    admittance: AdmittanceState
    filtered: Array
    external: Array
    zero: Array


class ComplianceController:
    """Turns joint states into amplitude offsets. Holds constants only.

    Args:
        chain: the robot's planar chain, for the torque open ground needs.
        config: settings.
        needed: predicts the torque open ground needs, as `needed_torques` does.
    """

    def __init__(
        self,
        chain: PlanarChain,
        config: ComplianceConfig,
        needed: Callable[[PlanarChain, Array, Array, float], Array] = needed_torques,
    ) -> None:
        self.chain = chain
        self.config = config
        self._needed = needed

    def initial_state(self) -> ComplianceState:
        """No offset, no torque."""
        zero = np.zeros(self.chain.n_joints)
        return ComplianceState(AdmittanceState(), zero, zero, zero)

    def tare(self, state: ComplianceState, efforts: Array) -> ComplianceState:
        """Let what a robot reports at rest count as no effort: the bias of its sensors.

        Args:
            state: as returned before.
            efforts: of the yaw joints over some readings at rest [N m], shape (T, N), T >= 1.

        Raises:
            BadInputError: the shape is another.
        """
        if efforts.ndim != 2 or not efforts.size or efforts.shape[1] != self.chain.n_joints:
            expected = f'shape (T, {self.chain.n_joints}), T >= 1'
            raise BadInputError('efforts', efforts.shape, expected)
        return replace(state, zero=efforts.mean(axis=0))

    def step(
        self,
        state: ComplianceState,
        angles: Array,
        rates: Array,
        efforts: Array,
        phases: tuple[float, float],
        dt: float,
    ) -> ComplianceState:
        """Advance while a cycle is being played.

        Where no torque can be predicted, the reading counts as missing.

        Args:
            state: as returned before.
            angles: yaw joint angles [rad], shape (N,).
            rates: their velocities [rad/s], shape (N,).
            efforts: their efforts [N m], shape (N,).
            phases: (tau_f, tau_t) [rad].
            dt: time since the last step [s], >= 0.
        """
        config = self.config
        try:
            needed = self._needed(self.chain, angles, rates, config.torque.friction)
        except ConvergenceError:
            return self.relax(state, dt)
        filtered, external = external_torque_step(
            state.filtered, efforts - state.zero, needed, dt, config.torque
        )
        jacobian = wave_jacobian(*phases, config.k_f, config.k_t, self.chain.n_joints)
        force = np.array(config.torque_scale) * (jacobian @ external)
        law = admittance_step(state.admittance, force, dt, config.law)
        return ComplianceState(law, filtered, external, state.zero)

    def relax(self, state: ComplianceState, dt: float) -> ComplianceState:
        """Advance while efforts or waves are missing: forget torques, return to the gait."""
        zero = np.zeros_like(state.filtered)
        law = relax_step(state.admittance, dt, self.config.relax_rate)
        return replace(state, admittance=law, filtered=zero, external=zero)
