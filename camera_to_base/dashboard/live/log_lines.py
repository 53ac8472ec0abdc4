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

"""The last messages that a cell's nodes have logged."""

from collections import deque
from typing import Any, Collection, Deque, Dict, List

from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

_MOST_LINES = 100
_LEVELS = {10: 'debug', 20: 'info', 30: 'warn', 40: 'error', 50: 'fatal'}


Lines = Deque[Dict[str, Any]]


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
        self._node = node
        # A logger's name is the node's full name with dots.
        self._names = {name.strip('/').replace('/', '.'): name for name in names}
        self._lines = lines
        # What a node said before the page was opened is sent again.
        self._subscription = node.create_subscription(Log, '/rosout', self._on_line, QoSProfile(
            depth=_MOST_LINES, durability=DurabilityPolicy.TRANSIENT_LOCAL))

    @property
    def data(self) -> List[Dict[str, Any]]:
        """The messages as JSON, the oldest first."""
        return sorted(self._lines, key=lambda line: line['time'])

    def close(self) -> None:
        """Stop listening."""
        self._node.destroy_subscription(self._subscription)

    def _on_line(self, line: Log) -> None:
        if line.name in self._names:
            told = {'time': line.stamp.sec + line.stamp.nanosec / 1e9,
                    'level': _LEVELS.get(line.level, 'info'),
                    'node': self._names[line.name], 'text': line.msg}
            if told not in self._lines:
                self._lines.append(told)
