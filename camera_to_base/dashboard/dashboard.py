# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Node: serves the page on which a cell is set up and watched."""

import os
import sys
import threading
from typing import Any, List, Optional

from camera_to_base.dashboard.backend import Backend, NodeThread
from camera_to_base.dashboard.live.watch import WatchedCells
from camera_to_base.dashboard.server.sockets import part_text
from camera_to_base.dashboard.server.web_server import WebServer
from camera_to_base.dashboard.sessions.all_sessions import AllSessions
from camera_to_base.dashboard.sessions.cell_file import CellFiles
from camera_to_base.dashboard.specs import dashboard_settings, DASHBOARD_SPECS
from camera_to_base.parameters import all_names, TRANSFORM_SPECS
from camera_to_base.ros import Heartbeat, NodeParameters, run, whole_or_gone
from camera_to_base.settings import CAMERA_SPECS
from rclpy.node import Node
from sensor_msgs.msg import CompressedImage


class Dashboard(Node):
    """Serves the page; a client of the other nodes."""

    _server: Optional[WebServer] = None

    def __init__(self, **node_options) -> None:
        super().__init__('dashboard', **node_options)
        with whole_or_gone(self):
            parameters = NodeParameters(
                self, DASHBOARD_SPECS, dashboard_settings,
                others=all_names([*CAMERA_SPECS, *TRANSFORM_SPECS]),
                cli_args=node_options.get('cli_args'))
            Heartbeat(self)
            files = CellFiles(parameters.current.params_file, parameters.current.params_files,
                              self.get_namespace())
            self._sessions = AllSessions(files, self._on_part, self._on_board_picture)
            cells = WatchedCells(self, self._on_part, self._on_picture, self._sessions)
            self._server = WebServer(
                parameters.current, Backend(
                    NodeThread(self).call, cells, self._sessions))
            self._server.start()
            self.get_logger().info(f'the dashboard is at {self._server.address}')

    @property
    def address(self) -> str:
        """The address of the page."""
        return self._server.address

    def destroy_node(self) -> None:
        """End the server, and destroy the node."""
        if self._server is not None:
            self._server.close()
            self._sessions.close()
        super().destroy_node()

    def _on_part(self, cell: str, part: str, data: Any) -> None:
        self._server.call(self._server.states.put, cell, part, part_text(part, data))

    def _on_board_picture(self, cell: str, jpeg: bytes) -> None:
        self._server.call(self._server.pictures.put, (cell, 'board'), jpeg)

    def _on_picture(self, cell: str, kind: str, message: CompressedImage) -> None:
        stamp = message.header.stamp
        # The background is as old as it is.
        stamp_s = 0.0 if kind == 'background' else stamp.sec + stamp.nanosec / 1e9
        self._server.call(
            self._server.pictures.put, (cell, kind), bytes(message.data), stamp_s)


def main(args: Optional[List[str]] = None) -> int:
    """Run the node until a signal arrives."""
    code = run('dashboard', Dashboard, args)
    if threading.active_count() > 1:
        # A fit that still goes on is not waited for.
        sys.stdout.flush()
        os._exit(code)
    return code
