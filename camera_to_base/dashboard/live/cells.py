# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Finds the cells of the ROS graph: the namespaces with nodes of a camera, or with camera_fusion.

A cell whose objects come from `camera_fusion` is a fused cell: its cameras are cells, too.
"""

from typing import Dict, List, NamedTuple, Optional, Set

from rclpy.node import Node

CAMERA, TRANSFORM = 'camera_publisher', 'robot_base_publisher'
FUSION = 'camera_fusion'


class GraphCell(NamedTuple):
    """
    One cell.

    :param namespace: '/' or '/cell_2'.
    :param camera: Full name of its camera node; None if that does not run.
    :param transform: Full name of its transform node; None if that does not run.
    :param fusion: Full name of its `camera_fusion`; None if that does not run.
    :param is_fused: Whether its objects come from `camera_fusion`, or did until that ended.
    """

    namespace: str
    camera: Optional[str]
    transform: Optional[str]
    fusion: Optional[str] = None
    is_fused: bool = False

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
                   if name in (CAMERA, TRANSFORM, FUSION)}
        self._seen |= running
        return [self._cell(namespace, running)
                for namespace in sorted(set(map(_namespace, self._seen)) or {'/'})]

    def _cell(self, namespace: str, running: Set[str]) -> GraphCell:
        names = [full_name(namespace, name) for name in (CAMERA, TRANSFORM, FUSION)]
        camera, transform, fusion = (name if name in running else None for name in names)
        was_fused = names[2] in self._seen and names[0] not in self._seen
        return GraphCell(namespace, camera, transform, fusion,
                         camera is None and (fusion is not None or was_fused))


def full_name(namespace: str, name: str) -> str:
    """Return the full name of a node or a topic in a namespace; one with a / has it already."""
    return name if name.startswith('/') else f'{namespace.rstrip("/")}/{name}'


def _namespace(node_name: str) -> str:
    return node_name.rpartition('/')[0] or '/'
