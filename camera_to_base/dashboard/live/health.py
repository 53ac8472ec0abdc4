# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What a cell's nodes say about themselves: their diagnostics, their messages, their rates."""

from collections import deque
import time
from typing import Any, Collection, Deque, Dict, List, Optional

from camera_to_base.dashboard.live.state import Report
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.subscription import Subscription

_SECONDS = 60

_MOST_LINES = 100
_LOG_LEVELS = {10: 'debug', 20: 'info', 30: 'warn', 40: 'error', 50: 'fatal'}

Lines = Deque[Dict[str, Any]]

_HEALTH_LEVELS = {0: 'ok', 1: 'warn', 2: 'error', 3: 'stale'}


class Charts:
    """Keeps the rate and the latency of each of the last 60 s."""

    def __init__(self) -> None:
        self._rates: Deque[float] = deque(maxlen=_SECONDS)
        self._latencies: Deque[Optional[float]] = deque(maxlen=_SECONDS)
        self._count = 0

    def add(self, rate_hz: float, latency_ms: Optional[float]) -> None:
        """Add the numbers of a second; None where no frame came."""
        self._count += 1
        self._rates.append(rate_hz)
        self._latencies.append(latency_ms)

    @property
    def data(self) -> Dict[str, Any]:
        """The numbers as JSON, the oldest first; `count` is how many there have been."""
        return {'count': self._count, 'rate_hz': list(self._rates),
                'latency_ms': list(self._latencies)}


def no_lines() -> Lines:
    """Return an empty list of messages."""
    return deque(maxlen=_MOST_LINES)


class LogLines:
    """
    Keeps the last hundred messages.

    :param node: The node that listens.
    :param names: Full names of the nodes whose messages are kept.
    :param lines: Those that were kept before, and to which new ones are added.
    """

    def __init__(self, node: Node, names: Collection[str], lines: Lines) -> None:
        self._node, self._lines = node, lines
        self._names: Dict[str, str] = {}
        self._subscription: Optional[Subscription] = None
        self.follow(names)

    def follow(self, names: Collection[str]) -> None:
        """Listen to these nodes alone."""
        # A logger's name is the node's full name with dots.
        by_logger = {name.strip('/').replace('/', '.'): name for name in names}
        if by_logger == self._names:
            return
        self.close()
        self._names = by_logger
        # What a node said before is sent again to each new subscriber.
        self._subscription = self._node.create_subscription(
            Log, '/rosout', self._on_line, QoSProfile(
                depth=_MOST_LINES, durability=DurabilityPolicy.TRANSIENT_LOCAL))

    @property
    def data(self) -> List[Dict[str, Any]]:
        """The messages as JSON, the oldest first."""
        return sorted(self._lines, key=lambda line: line['time'])

    def close(self) -> None:
        """Stop listening."""
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None

    def _on_line(self, line: Log) -> None:
        if line.name in self._names:
            told = {'time': line.stamp.sec + line.stamp.nanosec / 1e9,
                    'level': _LOG_LEVELS.get(line.level, 'info'),
                    'node': self._names[line.name], 'text': line.msg}
            if told not in self._lines:
                self._lines.append(told)


class CellHealth:
    """
    Listens to the diagnostics of a cell's nodes.

    :param node: The node that listens.
    :param names: Full names of the nodes.
    """

    def __init__(self, node: Node, names: Collection[str]) -> None:
        self._node, self._names = node, list(names)
        self._reports: Dict[str, Report] = {}
        self._subscription = node.create_subscription(
            DiagnosticArray, '/diagnostics', self._on_diagnostics, 10)

    def follow(self, names: Collection[str]) -> None:
        """Listen to these nodes alone."""
        self._names = list(names)

    def report(self, name: str) -> Optional[Report]:
        """Return the last report of a node; None if there was none."""
        return self._reports.get(name)

    @property
    def data(self) -> List[Dict[str, Any]]:
        """The nodes' states as JSON."""
        return [_data(name, self._reports.get(name)) for name in self._names]

    def close(self) -> None:
        """Stop listening."""
        self._node.destroy_subscription(self._subscription)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name in self._names:
                self._reports[status.name] = _report(status)


def _report(status: DiagnosticStatus) -> Report:
    values = {pair.key: pair.value for pair in status.values}
    return Report(_HEALTH_LEVELS.get(status.level[0], 'stale'), values.pop('reason', ''),
                  status.message, values, time.monotonic())


def _data(name: str, report: Optional[Report]) -> Dict[str, Any]:
    if report is None:
        return {'name': name, 'level': 'stale', 'reason': 'no_report', 'values': {},
                'sentence': f'{name} has not reported yet', 'age_s': None}
    sentence = report.sentence if not report.is_stale else (
        f'{name} has not reported for {report.age_s:.0f} s; its last report: {report.sentence}')
    return {'name': name, 'level': 'stale' if report.is_stale else report.level,
            'reason': report.reason, 'sentence': sentence, 'values': report.values,
            'age_s': round(report.age_s, 1)}
