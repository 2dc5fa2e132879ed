"""The physics behind four verbs: real PyBullet, in this process."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pybullet
import pytest
from scene import body_centres, body_yaws, normal_forces

from omega_turn_ros.errors import BadInputError, SimulationError
from omega_turn_ros.robot import Robot, load_robot
from omega_turn_sim_bridge.robot import FOOT_CLEARANCE, ride_height
from omega_turn_sim_bridge.simulation import Simulation
from omega_turn_sim_bridge.simulation_config import Observation, SimulationConfig
from omega_turn_sim_bridge.terrain_config import TerrainConfig

FIELDS = ('positions', 'velocities', 'efforts', 'pose', 'twist')


@pytest.fixture(scope='module')
def robot() -> Robot:
    return load_robot('limbless16')


@pytest.fixture
def simulation(robot: Robot) -> Iterator[Simulation]:
    with Simulation(robot) as made:
        yield made


def wriggle(simulation: Simulation, k: int) -> Observation:
    """Command the k-th posture of a lopsided wave and take two steps."""
    joints = np.arange(simulation.robot.n_joints)
    posture = np.where(joints % 2 == 0, 0.2 + 0.5 * np.sin(0.1 * k + joints), 0.0)
    simulation.command(posture)
    simulation.step(2)
    return simulation.observe()


def assert_same(one: Observation, other: Observation) -> None:
    """Equal to the last bit."""
    for field in FIELDS:
        np.testing.assert_array_equal(getattr(one, field), getattr(other, field), err_msg=field)


def test_robot_stands_straight_still_and_centred_at_the_start(simulation: Simulation) -> None:
    seen = simulation.observe()
    for field in FIELDS:
        np.testing.assert_allclose(getattr(seen, field), 0.0, atol=1e-12, err_msg=field)
    centres = body_centres(simulation)
    assert (np.diff(centres[:, 0]) < 0.0).all()  # head first, looking along x
    assert simulation.time == 0.0


def test_feet_share_the_robot_s_weight_evenly_and_hold_the_body_clear(
    simulation: Simulation,
) -> None:
    robot = simulation.robot
    simulation.step(200)
    forces = normal_forces(simulation)
    assert forces.sum() == pytest.approx(robot.weight, rel=1e-3)
    assert forces.size == 2 * round(robot.length / robot.module_length)
    # Rigid feet shared it between 0 and ten times the mean.
    np.testing.assert_allclose(forces, forces.mean(), rtol=0.05)
    heights = body_centres(simulation)[:, 2]
    assert heights.max() < ride_height(robot)  # so the feet do touch
    assert heights.min() > ride_height(robot) - 0.5 * FOOT_CLEARANCE


def test_resting_robot_stays_where_it_is(simulation: Simulation) -> None:
    simulation.step(400)
    seen = simulation.observe()
    assert np.abs(seen.pose).max() < 1e-5
    assert np.abs(seen.positions).max() < 1e-4
    assert np.abs(seen.efforts[simulation.robot.yaw_indices]).max() < 0.01


def test_two_runs_are_the_same_to_the_last_bit_and_do_not_disturb_each_other(
    robot: Robot,
) -> None:
    with Simulation(robot) as alone:
        expected = [wriggle(alone, k) for k in range(40)]
    with Simulation(robot) as one, Simulation(robot) as other:
        for k in range(40):
            assert_same(wriggle(one, k), expected[k])
            other.command(np.full(robot.n_joints, -0.4))
            other.step(3)
        assert not np.array_equal(other.observe().positions, expected[-1].positions)


def test_reset_puts_everything_back_but_the_time(robot: Robot) -> None:
    with Simulation(robot, SimulationConfig(position_noise=0.01, seed=5)) as simulation:
        fresh = simulation.observe()
        first = [wriggle(simulation, k) for k in range(40)]
        time = simulation.time
        simulation.reset()
        assert_same(simulation.observe(), fresh)
        assert simulation.time == time
        for k in range(40):
            assert_same(wriggle(simulation, k), first[k])


def test_reset_forgets_the_command(simulation: Simulation) -> None:
    simulation.command(np.full(simulation.robot.n_joints, 0.5))
    simulation.step(20)
    simulation.reset()
    simulation.step(20)
    assert np.abs(simulation.observe().positions).max() < 1e-3


def test_noise_has_its_size_and_follows_its_seed(robot: Robot) -> None:
    def readings(seed: int) -> np.ndarray:
        config = SimulationConfig(position_noise=0.02, effort_noise=0.3, seed=seed)
        with Simulation(robot, config) as simulation:
            seen = [simulation.observe() for _ in range(40)]
        return np.array([[s.positions, s.efforts] for s in seen])

    one, again, other = readings(1), readings(1), readings(2)
    np.testing.assert_array_equal(one, again)
    assert not np.array_equal(one, other)
    # 640 samples: the standard deviation is known to 3 %, four times that is allowed.
    assert one[:, 0].std() == pytest.approx(0.02, rel=0.12)
    assert one[:, 1].std() == pytest.approx(0.3, rel=0.12)


def test_noise_is_in_the_readings_only(robot: Robot, simulation: Simulation) -> None:
    config = SimulationConfig(position_noise=0.02, effort_noise=0.3, seed=1)
    with Simulation(robot, config) as noisy:
        for k in range(20):
            exact, blurred = wriggle(simulation, k), wriggle(noisy, k)
        np.testing.assert_array_equal(blurred.pose, exact.pose)
        np.testing.assert_array_equal(blurred.velocities, exact.velocities)


def test_time_is_a_whole_number_of_steps(robot: Robot) -> None:
    with Simulation(robot, SimulationConfig(time_step=0.003)) as simulation:
        for _ in range(100):
            simulation.step(7)
        assert simulation.time == 700 * 0.003
        assert simulation.observe().time == simulation.time


def test_joints_go_to_the_command_and_no_faster_than_their_limit(
    simulation: Simulation,
) -> None:
    robot = simulation.robot
    posture = np.zeros(robot.n_joints)
    posture[robot.yaw_indices] = np.linspace(-0.6, 0.6, robot.n_yaw)
    simulation.command(posture)
    simulation.step(10)
    reached = np.abs(simulation.observe().positions).max()
    # The servo's reference keeps the limit; its joint swings over it by a degree as it starts.
    allowed = robot.velocity_limit * 10 * simulation.config.time_step
    assert 0.5 * allowed < reached < allowed + math.radians(1.0)
    simulation.step(290)
    np.testing.assert_allclose(simulation.observe().positions, posture, atol=0.01)


def test_servo_answers_a_step_of_its_command_smoothly(simulation: Simulation) -> None:
    posture = np.zeros(simulation.robot.n_joints)
    posture[8] = 0.05
    simulation.command(posture)
    path = [0.0]
    for _ in range(80):
        simulation.step()
        path.append(simulation.observe().positions[8])
    moves = np.diff(path)
    # A critically damped servo peaks at omega step/e and never swings over.
    peak = 2.0 * math.pi * simulation.config.servo_frequency * 0.05 / math.e
    assert moves.max() < 1.2 * peak * simulation.config.time_step
    assert moves.min() > -1e-4
    assert path[-1] == pytest.approx(0.05, abs=5e-4)


@pytest.mark.parametrize('frequency', [2.5, 10.0])
def test_servo_follows_a_ramp_late_by_its_lag(robot: Robot, frequency: float) -> None:
    rate = 0.5  # [rad/s]
    with Simulation(robot, SimulationConfig(servo_frequency=frequency)) as simulation:
        posture = np.zeros(robot.n_joints)
        for _ in range(200):
            posture[8] += rate * simulation.config.time_step
            simulation.command(posture)
            simulation.step()
        late = (posture[8] - simulation.observe().positions[8]) / rate
    # give or take the solver's step of 5 ms
    assert late == pytest.approx(2.0 / (2.0 * math.pi * frequency), abs=0.006)


def test_efforts_are_means_over_the_steps_since_the_last_observation(robot: Robot) -> None:
    with Simulation(robot) as often, Simulation(robot) as seldom:
        posture = np.zeros(robot.n_joints)
        for k in range(10):
            posture[robot.yaw_indices] = 0.02 * k
            efforts = []
            for simulation in (often, seldom):
                simulation.command(posture)
            for _ in range(4):
                often.step()
                efforts.append(often.observe().efforts)
            seldom.step(3)
            seldom.step()
            seen = seldom.observe()
            np.testing.assert_allclose(seen.efforts, np.mean(efforts, axis=0), atol=1e-12)
            np.testing.assert_array_equal(seldom.observe().efforts, seen.efforts)
        assert np.ptp(efforts, axis=0).max() > 0.01  # torques did change within a command


def test_command_beyond_the_position_limit_is_clipped(simulation: Simulation) -> None:
    robot = simulation.robot
    posture = np.zeros(robot.n_joints)
    posture[0], posture[14] = 50.0, -50.0
    simulation.command(posture)
    simulation.step(400)
    positions = simulation.observe().positions
    assert positions[0] == pytest.approx(robot.position_limit, abs=0.01)
    assert positions[14] == pytest.approx(-robot.position_limit, abs=0.01)
    # and not only by the joint's stop: the servo has not run on beyond it
    simulation.command(np.zeros(robot.n_joints))
    simulation.step(160)
    assert np.abs(simulation.observe().positions[[0, 14]]).max() < 0.1


def test_held_posture_is_the_one_the_robot_has(simulation: Simulation) -> None:
    simulation.command(np.full(simulation.robot.n_joints, 0.0))
    posture = np.zeros(simulation.robot.n_joints)
    posture[6] = 1.0
    simulation.command(posture)
    simulation.step(40)
    simulation.hold_posture()
    at = simulation.observe().positions[6]
    assert 0.1 < at < 0.9
    simulation.step(100)
    assert simulation.observe().positions[6] == pytest.approx(at, abs=0.05)


@pytest.mark.parametrize('bad', [math.nan, math.inf, -math.inf])
def test_command_that_is_not_finite_is_refused_and_changes_nothing(
    simulation: Simulation, bad: float
) -> None:
    posture = np.zeros(simulation.robot.n_joints)
    posture[3] = bad
    with pytest.raises(BadInputError, match=r'^positions: '):
        simulation.command(posture)
    simulation.step(20)
    assert np.abs(simulation.observe().positions).max() < 1e-3


@pytest.mark.parametrize('shape', [(), (15,), (17,), (16, 1)])
def test_command_of_another_shape_is_refused(
    simulation: Simulation, shape: tuple[int, ...]
) -> None:
    with pytest.raises(BadInputError, match=r'^positions: .*shape \(16,\)'):
        simulation.command(np.zeros(shape))


@pytest.mark.parametrize('direction', [1.0, -1.0])
def test_heading_is_continuous_over_many_turns(simulation: Simulation, direction: float) -> None:
    for k in range(1, 60):
        heading = direction * 0.25 * k
        pybullet.resetBasePositionAndOrientation(
            simulation.body,
            (0.0, 0.0, 1.0),
            pybullet.getQuaternionFromEuler((0.0, 0.0, heading)),
            physicsClientId=simulation.client,
        )
        assert simulation.observe().pose[2] == pytest.approx(heading, abs=1e-6)


def test_pose_is_the_mean_body_frame(simulation: Simulation) -> None:
    """Origin at the centre of mass, axis at the mean angle of the bodies, whatever the shape."""
    robot = simulation.robot
    posture = np.zeros(robot.n_joints)
    posture[robot.yaw_indices] = [1.2, 1.0, 0.8, 0.2, 0.0, 0.0, 0.1, -0.1]
    simulation.command(posture)
    simulation.step(300)
    seen = simulation.observe()
    mean = robot.body_masses @ body_centres(simulation) / robot.body_masses.sum()
    np.testing.assert_allclose(seen.pose[:2], mean[:2], atol=1e-9)
    yaw = body_yaws(simulation) @ robot.body_lengths / robot.length
    assert abs(yaw) > 0.02
    # bodies tilt by some 1e-4 rad on their feet, which their yaw angles see
    assert seen.pose[2] == pytest.approx(yaw, abs=1e-3)


def test_twist_is_the_rate_of_the_pose_in_its_own_axes(simulation: Simulation) -> None:
    robot = simulation.robot
    moving = []
    for k in range(1, 61):  # folds up slowly, 0.5 rad/s at most
        posture = np.zeros(robot.n_joints)
        posture[robot.yaw_indices] = (
            0.005 * k * np.array([1.0, 0.5, 0.0, -0.2, 0.4, 0.6, 1.0, 1.0])
        )
        simulation.command(posture)
        before = simulation.observe()
        simulation.step(2)
        after = simulation.observe()
        if k <= 20:
            continue  # until the feet have found their hold
        own = after.pose - before.pose
        c, s = math.cos(before.pose[2]), math.sin(before.pose[2])
        own[:2] = c * own[0] + s * own[1], c * own[1] - s * own[0]
        moving.append((after.twist, own / (2 * simulation.config.time_step)))
    twists, rates = np.swapaxes(moving, 0, 1)
    assert (np.abs(rates).mean(axis=0) > [0.005, 0.03, 0.1]).all()  # all three are put to the test
    np.testing.assert_allclose(twists, rates, atol=1e-3)  # velocity changes within the 10 ms


def open_clients() -> list[int]:
    return [
        client
        for client in range(20)
        if pybullet.getConnectionInfo(physicsClientId=client)['isConnected']
    ]


def test_ground_that_cannot_be_built_leaves_no_client_open(robot: Robot) -> None:
    before = open_clients()
    too_close = TerrainConfig('pegboard', spacing_bl=0.05)
    with pytest.raises(BadInputError, match=r'^terrain spacing_bl: got 0.05, expected room'):
        Simulation(robot, SimulationConfig(terrain=too_close))
    assert open_clients() == before


def test_closed_simulation_refuses_to_go_on_and_may_be_closed_again(robot: Robot) -> None:
    before = open_clients()
    with Simulation(robot) as simulation:
        assert len(open_clients()) == len(before) + 1
    assert open_clients() == before
    simulation.close()
    for verb in (simulation.step, simulation.observe, simulation.reset, simulation.hold_posture):
        with pytest.raises(SimulationError, match='closed'):
            verb()


def test_scene_that_explodes_is_reported(simulation: Simulation) -> None:
    pybullet.resetBaseVelocity(
        simulation.body, (math.nan, 0.0, 0.0), physicsClientId=simulation.client
    )
    with pytest.raises(SimulationError, match='not finite'):
        for _ in range(5):
            simulation.step()
            simulation.observe()


@pytest.mark.parametrize(
    ('field', 'value'),
    [
        ('time_step', 0.0),
        ('time_step', math.nan),
        ('solver_iterations', 0),
        ('friction', -0.1),
        ('friction', math.inf),
        ('contact_stiffness', 0.0),
        ('servo_frequency', 0.0),
        ('servo_frequency', math.nan),
        ('contact_damping', -1.0),
        ('effort_limit', -1.0),
        ('velocity_limit', math.nan),
        ('position_noise', -0.1),
        ('effort_noise', math.inf),
    ],
)
def test_setting_the_engine_would_swallow_is_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(BadInputError, match=rf'^{field}: '):
        SimulationConfig(**{field: value})
