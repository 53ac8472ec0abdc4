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

"""The cells that somebody looks at, in the thread of the node's executor."""

from typing import Any, Callable, Dict

from camera_to_base.dashboard.all_sessions import AllSessions
from camera_to_base.dashboard.live.cell_watch import CellWatch
from camera_to_base.dashboard.live.cells import CellFinder
from camera_to_base.dashboard.live.log_lines import Lines, no_lines
from camera_to_base.dashboard.live.picture_topics import OnPicture, PictureTopics
from camera_to_base.errors import InvalidValueError
from rclpy.node import Node


class WatchedCells:
    """
    Starts and ends the watch of cells and pictures.

    :param node: The node that listens.
    :param on_part: Called with a cell, a part's name and its data.
    :param on_picture: Called with a cell, a kind and a message.
    :param sessions: What people do with the cells.
    """

    def __init__(
        self, node: Node, on_part: Callable[[str, str, Any], None], on_picture: OnPicture,
        sessions: AllSessions,
    ) -> None:
        self._node, self._on_part, self._sessions = node, on_part, sessions
        self._cells = CellFinder(node)
        self._pictures = PictureTopics(node, on_picture)
        self._watches: Dict[str, CellWatch] = {}
        # Kept while nobody looks: a page that is loaded again shows them again.
        self._lines: Dict[str, Lines] = {}

    def look_at(self, namespace: str) -> None:
        """Watch a cell."""
        if namespace not in self._watches:
            self._watches[namespace] = CellWatch(
                self._node, namespace, self._cells,
                lambda part, data: self._on_part(namespace, part, data),
                self._lines.setdefault(namespace, no_lines()),
                self._sessions.of(namespace))

    def look_away(self, namespace: str) -> None:
        """End the watch of a cell."""
        watch = self._watches.pop(namespace, None)
        if watch is not None:
            watch.close()

    def look_at_picture(self, namespace: str, kind: str) -> None:
        """Receive a kind of picture."""
        self._pictures.look_at(namespace, kind)

    def look_away_picture(self, namespace: str, kind: str) -> None:
        """Receive it no more."""
        self._pictures.look_away(namespace, kind)

    def watch(self, namespace: str) -> CellWatch:
        """
        Return the watch of a cell.

        :raises InvalidValueError: If nobody looks at it.
        """
        if namespace not in self._watches:
            raise InvalidValueError(f'no page shows the cell {namespace}: open one first')
        return self._watches[namespace]
