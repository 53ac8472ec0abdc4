# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Node: serves the page on which a cell is set up and watched; carries out what pages ask for."""

import asyncio
from collections import deque
from concurrent.futures import Future
import io
import json
import os
import sys
import threading
from typing import Any, Callable, Deque, Dict, List, Mapping, Optional, Tuple
import zipfile

from camera_to_base.dashboard.live.parameters import RefusedError
from camera_to_base.dashboard.live.watch import WatchedCells
from camera_to_base.dashboard.server.guarded import Refused
from camera_to_base.dashboard.server.sockets import part_text
from camera_to_base.dashboard.server.web_server import WebServer
from camera_to_base.dashboard.sessions.cell_file import CellFiles
from camera_to_base.dashboard.sessions.cell_sessions import AllSessions, CellSessions
from camera_to_base.dashboard.specs import dashboard_settings, DASHBOARD_SPECS
from camera_to_base.errors import CameraToBaseError
from camera_to_base.parameters import all_names, TRANSFORM_SPECS
from camera_to_base.ros import Heartbeat, NodeParameters, run, whole_or_gone
from camera_to_base.settings import CAMERA_SPECS
from rclpy.node import Node
from rclpy.task import Future as RosFuture
from sensor_msgs.msg import CompressedImage

# A node answers within milliseconds. The background takes up to 10 s, see its service.
_LONGEST_ANSWER_S, _LONGEST_BACKGROUND_S, _LONGEST_SNAPSHOT_S = 5.0, 15.0, 8.0


class NodeThread:
    """
    The only way from the web server's thread to the node.

    :param node: The node whose executor runs the functions.
    """

    def __init__(self, node: Node) -> None:
        self._tasks: Deque[Tuple[Future, Callable[[], Any]]] = deque()
        self._guard = node.create_guard_condition(self._run)

    def call(self, function: Callable[[], Any]) -> Future:
        """
        Run a function in the executor's thread.

        :param function: It may return an rclpy future, whose result is waited for.
        :returns: A future of the function's result.
        """
        result: Future = Future()
        self._tasks.append((result, function))
        self._guard.trigger()
        return result

    def _run(self) -> None:
        while self._tasks:
            result, function = self._tasks.popleft()
            if result.set_running_or_notify_cancel():
                _fulfil(result, function)


def _fulfil(result: Future, function: Callable[[], Any]) -> None:
    try:
        value = function()
    except Exception as error:
        result.set_exception(error)
        return
    if isinstance(value, RosFuture):
        value.add_done_callback(lambda done: _copy(done, result))
    else:
        result.set_result(value)


def _copy(done: RosFuture, result: Future) -> None:
    if done.exception() is not None:
        result.set_exception(done.exception())
    else:
        result.set_result(done.result())


class Backend:
    """
    What the web server calls, in its thread.

    :param call: Runs a function of the cells in the node's thread, see :class:`NodeThread`.
    :param cells: The cells, for functions in the node's thread.
    :param sessions: What people do with the cells.
    """

    def __init__(
        self, call: Callable[[Callable[[], Any]], Future], cells: WatchedCells,
        sessions: AllSessions,
    ) -> None:
        self._call, self._cells, self._sessions = call, cells, sessions

    def look_at(self, cell: str) -> None:
        """Watch a cell from now on."""
        self._call(lambda: self._cells.look_at(cell)).add_done_callback(
            lambda done: self._sessions.show(cell))

    def look_away(self, cell: str) -> None:
        """Do not watch a cell any more."""
        self._call(lambda: self._cells.look_away(cell)).add_done_callback(
            lambda done: self._sessions.forget_invented(cell))

    def look_at_picture(self, cell: str, kind: str) -> None:
        """Receive a kind of picture from now on."""
        self._call(lambda: self._cells.look_at_picture(cell, kind))

    def look_away_picture(self, cell: str, kind: str) -> None:
        """Do not receive a kind of picture any more."""
        self._call(lambda: self._cells.look_away_picture(cell, kind))

    async def set_parameters(
        self, cell: str, node: str, values: Dict[str, Any]
    ) -> Dict[str, Any]:
        """Set parameters of a node, all or none; return their new values."""
        return await self._answer(
            lambda: self._cells.watch(cell).set_parameters(node, values))

    async def capture_background(self, cell: str) -> str:
        """Take the background anew; return the node's sentence."""
        return await self._answer(
            lambda: self._cells.watch(cell).capture_background(), _LONGEST_BACKGROUND_S)

    async def act(
        self, cell: str, part: str, name: str, body: Dict[str, Any]
    ) -> Dict[str, Any]:
        """Carry out a step of a session: all of it, or nothing; return its state."""
        sessions = self._sessions.of(cell)
        if not sessions.has(part, name):
            raise Refused(404, f'there is no step {name:.40} of {part}')
        changes = await self.ask_sessions(cell, lambda one: one.act(part, name, body))
        if changes is not None:
            await self._apply(cell, changes.values)
            sessions.done(part, name, changes)
        return sessions.state(part)

    async def keep_correction(self, cell: str, body: Dict[str, Any]) -> Dict[str, Any]:
        """
        Write the camera node's correction into the file, and let the node use it.

        The file is first: a background that is older than its surface is not trusted.

        :param body: {'path': another file}, or {}.
        :returns: The state of the part `save`.
        """
        offer = json.loads(await self._answer(
            lambda: self._cells.watch(cell).corrected_surface()))
        changes = await self.ask_sessions(cell, lambda one: one.keep_correction(offer, body))
        try:
            await self._apply(cell, changes.values)
        except Refused as error:
            raise Refused(error.status_code, (
                f'the file is written, but the node does not use it: {error.data["error"]}: start '
                'the node again with the file')) from error
        return self._sessions.of(cell).state('save')

    async def snapshot(self, cell: str) -> bytes:
        """Return a ZIP of a frame, its mask, its positions, and the parameters."""
        files, positions = await self._answer(lambda: self._cells.watch(cell).snapshot(),
                                              _LONGEST_SNAPSHOT_S)
        content = io.BytesIO()
        with zipfile.ZipFile(content, 'w') as file:
            for name, picture in files.items():
                file.writestr(name, picture)
            file.writestr('positions.json', json.dumps(positions, indent=1))
            if positions.get('objects') is not None:
                file.writestr('cell.yaml', await self.ask_sessions(
                    cell, lambda one: one.file_text()))
        return content.getvalue()

    async def ask_sessions(self, cell: str, function: Callable[[CellSessions], Any]) -> Any:
        """Call a function of a cell's sessions, which may take a while."""
        loop = asyncio.get_running_loop()
        try:
            return await loop.run_in_executor(None, function, self._sessions.of(cell))
        except CameraToBaseError as error:
            raise Refused(409, str(error)) from error

    async def _apply(self, cell: str, values: Mapping[str, Dict[str, Any]]) -> None:
        # Each node takes all or nothing; if the second one refuses, the first one goes back.
        before = await self._answer(lambda: {
            node: self._cells.watch(cell).values_of(node, names)
            for node, names in values.items()})
        applied: List[str] = []
        try:
            for node, wanted in values.items():
                await self.set_parameters(cell, node, wanted)
                applied.append(node)
        except Refused:
            for node in applied:
                await self.set_parameters(cell, node, before[node])
            raise

    async def _answer(
        self, function: Callable[[], Any], longest_s: float = _LONGEST_ANSWER_S
    ) -> Any:
        try:
            return await asyncio.wait_for(asyncio.wrap_future(self._call(function)), longest_s)
        except RefusedError as error:
            raise Refused(400, str(error), errors=error.errors) from error
        except CameraToBaseError as error:
            raise Refused(409, str(error)) from error
        except asyncio.TimeoutError:
            raise Refused(503, f'the node has not answered within {longest_s:g} s: it is busy, '
                               'and may still do it, or it hangs; look at its terminal') from None


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
