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

"""Warns of a second node with the same name: its topics would carry two publishers' messages."""

import time

from camera_to_base.ros.heartbeat import Heartbeat
from rclpy.node import Node

# Of two nodes with one name, the younger one warns: it finds the name taken within this time.
_LONGEST_S, _PERIOD_S = 5.0, 1.0


class NameCheck:
    """
    Warns once, in the first seconds of a node, that another node has its name.

    :param node: The node that warns.
    :param heartbeat: Its heartbeat.
    """

    def __init__(self, node: Node, heartbeat: Heartbeat) -> None:
        self._node = node
        self._until = time.monotonic() + _LONGEST_S
        heartbeat.every(_PERIOD_S, self._check)

    def _check(self) -> None:
        if time.monotonic() <= self._until and self._is_name_taken():
            self._until = 0.0
            self._node.get_logger().warning(
                f'another {self._node.get_fully_qualified_name()} is running: every position is '
                'published twice; end one, or give one a namespace (-r __ns:=/cell_2)')

    def _is_name_taken(self) -> bool:
        own = self._node.get_name(), self._node.get_namespace()
        return self._node.get_node_names_and_namespaces().count(own) > 1
