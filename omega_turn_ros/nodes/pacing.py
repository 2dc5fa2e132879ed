"""A control loop that keeps its own time and sees to the rest of its node now and then.

rclpy's executor builds its wait set anew for every round, which costs a 100 Hz node more than all
it does with its messages. A paced node waits for nothing but its next tick.
"""

from __future__ import annotations

import threading
import time
from typing import Protocol, runtime_checkable

from rclpy.executors import SingleThreadedExecutor
from rclpy.service import Service

LOOK_EVERY = 0.1  # [s] between two callbacks other than the tick: services, slow timers


@runtime_checkable
class Paced(Protocol):
    """A node that is to be ticked."""

    @property
    def tick_period(self) -> float | None:
        """Time between two ticks [s]; None where its own timers or messages drive it."""

    def tick(self) -> None:
        """Do what is due now."""


def spin_paced(
    node: Paced, period: float, executor: SingleThreadedExecutor, ended: threading.Event
) -> None:
    """Tick a node until told to stop. After a delay the missed ticks are left out.

    Args:
        node: that is ticked; the executor has it, too.
        period: between two ticks [s].
        executor: for everything else the node does.
        ended: tells to stop.
    """
    due = look = time.monotonic()
    together = 0.5 * min(period, LOOK_EVERY)  # a look this early needs no wake-up of its own
    while not ended.is_set():
        now = time.monotonic()
        if now >= due:
            node.tick()
            due += period
            late = time.monotonic()
            if due <= late:
                due = late + period
        if now + together >= look:
            for _ in range(2):  # the second ends the round the first began
                executor.spin_once(timeout_sec=0.0)
            look = now + LOOK_EVERY
        time.sleep(max(min(due, look) - time.monotonic(), 0.0))


def answer_now(service: Service) -> None:
    """Answer a call of a service if there is one, without waiting for the executor's look."""
    with service.handle:
        request, header = service.handle.service_take_request(service.srv_type.Request)
    if header is not None:
        service.send_response(service.callback(request, service.srv_type.Response()), header)
