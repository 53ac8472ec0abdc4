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

"""What the nodes of a cell say about their state."""

import time
from typing import Any, Collection, Dict, List, NamedTuple, Optional

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.node import Node

# Each node reports once a second.
_STALE_S = 3.5
_LEVELS = {0: 'ok', 1: 'warn', 2: 'error', 3: 'stale'}


class Report(NamedTuple):
    """The last report of a node, and when it came, by time.monotonic()."""

    level: str
    reason: str
    sentence: str
    values: Dict[str, str]
    came_at: float

    @property
    def age_s(self) -> float:
        """Time since it came."""
        return time.monotonic() - self.came_at

    @property
    def is_stale(self) -> bool:
        """Whether the node has missed several reports."""
        return self.age_s > _STALE_S


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
    return Report(_LEVELS.get(status.level[0], 'stale'), values.pop('reason', ''),
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
