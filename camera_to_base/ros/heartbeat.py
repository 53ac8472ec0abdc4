# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""One timer for all periodic tasks of a node."""

from typing import Callable, List, Tuple

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.timer import Timer

_PERIOD_S = 0.2


def real_time_timer(node: Node, period_s: float, callback: Callable[[], None]) -> Timer:
    """Make a timer that runs on the steady clock, also where `use_sim_time` is true."""
    return node.create_timer(period_s, callback, clock=Clock(clock_type=ClockType.STEADY_TIME))


class Heartbeat:
    """
    Calls periodic tasks on the steady clock, from one timer.

    The executor checks every timer for every message, so each further timer slows all messages.
    The heartbeat also wakes the executor; without it, a signal takes effect with the next message
    only.
    """

    def __init__(self, node: Node) -> None:
        self._tasks: List[Tuple[int, Callable[[], None]]] = []
        self._count = 0
        real_time_timer(node, _PERIOD_S, self._beat)

    def every(self, period_s: float, task: Callable[[], None]) -> None:
        """Call a task with a period that is rounded to a multiple of 0.2 s."""
        self._tasks.append((max(1, round(period_s / _PERIOD_S)), task))

    def _beat(self) -> None:
        self._count += 1
        for beats, task in self._tasks:
            if self._count % beats == 0:
                task()
