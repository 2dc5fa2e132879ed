"""`omega_turn demo`: gait, admittance and bridge node in one process, one turn, four files."""

from __future__ import annotations

import json
import math
import os
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from tqdm import tqdm

import omega_turn_lab.ros_environment  # noqa: F401  (first: it may restart the interpreter)
from omega_turn_lab.animation import animate_turn
from omega_turn_lab.folder import make_folder
from omega_turn_lab.ground_view import view_ground
from omega_turn_lab.live import NodeError, Observer, Stack, wait_until
from omega_turn_lab.pictures import draw_turn
from omega_turn_lab.recording import BagRecorder
from omega_turn_lab.run_record import RunRecord
from omega_turn_lab.uneven import feedback_on, pitch_effort_on
from omega_turn_ros import __version__
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.gaits.turn_plan import plan_turn
from omega_turn_ros.nodes.admittance_node import AdmittanceNode
from omega_turn_ros.nodes.gait_node import GaitNode
from omega_turn_ros.nodes.qos import COMMAND, LATCHED, STATE
from omega_turn_ros.robot import load_robot
from omega_turn_sim_bridge.bridge_node import PyBulletBridge
from omega_turn_sim_bridge.terrain_config import TerrainConfig, load_terrain

START_TIMEOUT = 30.0  # [s] for the nodes to find each other
STALL_TIMEOUT = 30.0  # [s] wall time without simulated time passing
SETTLE = 0.5  # [s] simulated, recorded after the end of the turn
TOPICS = (
    ('turn_angle', Float64, STATE),
    ('turn_remaining', Float64, LATCHED),
    ('joint_commands', JointState, COMMAND),
    ('joint_states', JointState, STATE),
    ('wave_phases', JointState, COMMAND),
    ('wave_amplitudes', JointState, STATE),
    ('odom', Odometry, STATE),
    ('/clock', Clock, STATE),
    ('diagnostics', DiagnosticArray, STATE),
)


@dataclass(frozen=True, slots=True)
class DemoOptions:
    """What to show.

    Attributes:
        turn_deg: commanded turn [deg], + = counter-clockwise.
        out: folder for the files.
        gait: name in config/gaits, or a path.
        robot: name in config/robots, or a path.
        period: duration of one gait cycle [s].
        heading_feedback: 'odom' or 'none'.
        compliance: run the admittance node too, if the gait has amplitudes that yield.
        friction: of the ground.
        terrain: name in config/terrains, or a path.
        spacing: between pegs [BL]; None takes the terrain's.
        seed: of the simulation and of random terrains.
        gui: show PyBullet's window.
    """

    turn_deg: float = 90.0
    out: Path = Path('out')
    gait: str = 'omega'
    robot: str = 'limbless16'
    period: float = 10.0
    heading_feedback: str = 'odom'
    compliance: bool = True
    friction: float = 0.5
    terrain: str = 'flat'
    spacing: float | None = None
    seed: int = 0
    gui: bool = False

    def ground(self) -> TerrainConfig:
        """Return the ground to build.

        Raises:
            BadInputError: no such terrain, or a spacing where there are no pegs.
        """
        terrain = load_terrain(self.terrain)
        if self.spacing is None:
            return terrain
        if terrain.kind != 'pegboard':
            raise BadInputError('--spacing', self.spacing, 'a terrain with pegs: pegboard')
        return replace(terrain, spacing_bl=self.spacing)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a run came to."""

    record: RunRecord
    cycles: int
    real_time_factor: float


def demo_domain() -> int:
    """ROS_DOMAIN_ID where it is set, else one that another process hardly shares."""
    return int(os.environ.get('ROS_DOMAIN_ID') or 1 + os.getpid() % 100)


def run_demo(options: DemoOptions) -> int:
    """Turn the robot, print the result, write turn.png, .gif, .json and .mcap; return 0."""
    gait, robot = load_gait(options.gait), load_robot(options.robot)
    options = replace(options, compliance=options.compliance and gait.gait.complies)
    commanded = math.radians(options.turn_deg)
    predicted = plan_turn(commanded, gait.calibration).angle
    ground = view_ground(options.ground(), robot, options.seed)
    make_folder(options.out)
    with Stack(demo_domain()) as stack:
        outcome = _play(stack, options, commanded)
    record = outcome.record
    achieved = math.degrees(record.pose[-1, 2] - record.pose[0, 2])
    print('drawing ...', file=sys.stderr)
    draw_turn(record, robot, options.turn_deg, options.out / 'turn.png', ground)
    speed = max(1.0, float(record.time[-1]) / 10.0)
    animate_turn(record, robot, options.out / 'turn.gif', speed=speed, ground=ground)
    result = {
        'turn_deg_commanded': options.turn_deg,
        'turn_deg_predicted': math.degrees(predicted),
        'turn_deg_achieved': achieved,
        'error_deg': achieved - options.turn_deg,
        'cycles': outcome.cycles,
        'real_time_factor': outcome.real_time_factor,
        'simulated_seconds': float(record.time[-1]),
        'gait': options.gait,
        'robot': options.robot,
        'heading_feedback': options.heading_feedback,
        'compliance': options.compliance,
        'terrain': options.terrain,
        'spacing_bl': options.spacing,
        'seed': options.seed,
        'version': __version__,
    }
    (options.out / 'turn.json').write_text(json.dumps(result, indent=2) + '\n')
    print(
        f'commanded {options.turn_deg:+.1f} deg, predicted {math.degrees(predicted):+.1f}, '
        f'achieved {achieved:+.2f}, error {achieved - options.turn_deg:+.2f} deg, '
        f'{outcome.cycles} cycles, real-time factor {outcome.real_time_factor:.1f}'
    )
    print(f'see {options.out / "turn.png"}, turn.gif, turn.json, turn.mcap')
    return 0


def _play(stack: Stack, options: DemoOptions, commanded: float) -> Outcome:
    """Bring the nodes up, command the turn, wait for its end."""
    robot = load_robot(options.robot)
    observer = stack.add(lambda **k: Observer(robot, **k))
    bridge = stack.add(
        PyBulletBridge,
        robot=options.robot,
        lock_step=True,
        start_paused=True,
        friction=options.friction,
        terrain=options.terrain,
        peg_spacing=options.spacing or 0.0,
        pitch_effort_limit=pitch_effort_on(options.ground(), load_gait(options.gait).gait),
        seed=options.seed,
        gui=options.gui,
    )
    gait = stack.add(
        GaitNode,
        robot=options.robot,
        gait=options.gait,
        period=options.period,
        heading_feedback=options.heading_feedback,
        use_compliance=options.compliance,
        lock_step=True,
        **feedback_on(options.ground()),
    )
    if options.compliance:
        stack.add(
            AdmittanceNode,
            robot=options.robot,
            gait=options.gait,
            friction=options.friction,
            lock_step=True,
        )
    with BagRecorder(bridge, options.out / 'turn.mcap', TOPICS):
        _command(observer, commanded, 4 if options.compliance else 3)
        start = time.monotonic()
        _call(bridge, observer, 'pybullet_bridge/resume')
        _watch(observer, abs(options.turn_deg))
        turned = observer.simulated_time
        factor, end = turned / (time.monotonic() - start), turned + SETTLE
        wait_until(lambda: observer.simulated_time >= end, STALL_TIMEOUT, 'the robot to settle')
        _call(bridge, observer, 'pybullet_bridge/pause')
        return Outcome(observer.record(SETTLE), gait.cycles_done, factor)


def _command(observer: Observer, commanded: float, state_readers: int) -> None:
    """Publish the turn once everybody listens, and wait until the gait node has taken it."""
    count = observer.count_subscribers
    wait_until(
        lambda: (
            count('turn_angle') >= 2
            and count('joint_states') >= state_readers
            and count('joint_commands') >= 3
        ),
        START_TIMEOUT,
        'the nodes to find each other',
    )
    wait_until(lambda: observer.remaining is not None, START_TIMEOUT, 'turn_remaining')
    if commanded == 0.0:
        return
    observer.turn_angle.publish(Float64(data=commanded))
    wait_until(lambda: observer.remaining != 0.0, START_TIMEOUT, 'the turn to be accepted')


def _watch(observer: Observer, size_deg: float) -> None:
    """Show progress until the turn is done."""
    bar_format = '{desc} {percentage:3.0f}%|{bar}| {n:.1f}/{total:.1f} deg [{elapsed}{postfix}]'
    moved, seen = time.monotonic(), -1.0
    with tqdm(total=size_deg, desc='turning', bar_format=bar_format, mininterval=0.2) as bar:
        while observer.remaining != 0.0:
            left = math.degrees(observer.remaining or 0.0)
            bar.n = min(max(size_deg - abs(left), 0.0), size_deg)
            seconds = observer.simulated_time
            bar.set_postfix_str(f'{left:+.1f} deg to go, {seconds:.1f} s simulated', refresh=False)
            bar.update(0)
            now, simulated = time.monotonic(), observer.simulated_time
            if simulated != seen:
                moved, seen = now, simulated
            elif now - moved > STALL_TIMEOUT:
                raise NodeError(f'simulated time stands still at {simulated:.2f} s')
            time.sleep(0.05)
        bar.n = size_deg
        bar.refresh()


def _call(server: PyBulletBridge, observer: Observer, name: str) -> None:
    client = observer.create_client(Trigger, name)
    if not client.wait_for_service(START_TIMEOUT):
        raise NodeError(f'service {name} did not appear in {START_TIMEOUT:g} s')
    future = client.call_async(Trigger.Request())
    wait_until(future.done, START_TIMEOUT, f'an answer of {name}')
    observer.destroy_client(client)
