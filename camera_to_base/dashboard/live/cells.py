# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Finds the cells of the ROS graph: the namespaces with a camera node or a transform node."""

from typing import Dict, List, NamedTuple, Optional, Set

from rclpy.node import Node

CAMERA, TRANSFORM = 'camera_publisher', 'robot_base_publisher'


class GraphCell(NamedTuple):
    """
    One cell.

    :param namespace: '/' or '/cell_2'.
    :param camera: Full name of its camera node; None if that does not run.
    :param transform: Full name of its transform node; None if that does not run.
    """

    namespace: str
    camera: Optional[str]
    transform: Optional[str]

    @property
    def data(self) -> Dict[str, str]:
        """The cell as JSON."""
        return {'cell': self.namespace}


class CellFinder:
    """
    The cells that were ever seen; one whose nodes have ended stays.

    :param node: The node that looks at the graph.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._seen: Set[str] = set()

    def find(self) -> List[GraphCell]:
        """Return all cells; '/' without nodes if there is none."""
        running = {full_name(namespace, name)
                   for name, namespace in self._node.get_node_names_and_namespaces()
                   if name in (CAMERA, TRANSFORM)}
        self._seen |= {_namespace(name) for name in running}
        return [GraphCell(namespace, *(_if_running(full_name(namespace, name), running)
                                       for name in (CAMERA, TRANSFORM)))
                for namespace in sorted(self._seen or {'/'})]


def full_name(namespace: str, name: str) -> str:
    """Return the full name of a node or a topic in a namespace; one with a / has it already."""
    return name if name.startswith('/') else f'{namespace.rstrip("/")}/{name}'


def _namespace(node_name: str) -> str:
    return node_name.rpartition('/')[0] or '/'


def _if_running(name: str, running: Set[str]) -> Optional[str]:
    return name if name in running else None
