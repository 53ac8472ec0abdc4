# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Everything about one cell while somebody looks at it, and the cells that are looked at."""

from typing import Any, Callable, Dict, Iterable, List, Optional

from camera_to_base.dashboard.live.cells import CAMERA, CellFinder, full_name, GraphCell, TRANSFORM
from camera_to_base.dashboard.live.feeds import OnPicture, PictureTopics, SessionFeed, Snapshot
from camera_to_base.dashboard.live.geometry import Geometry
from camera_to_base.dashboard.live.health import CellHealth, Lines, LogLines, no_lines
from camera_to_base.dashboard.live.parameters import RemoteParameters
from camera_to_base.dashboard.live.positions import CellPositions
from camera_to_base.dashboard.live.status import CellStatus
from camera_to_base.dashboard.sessions.cell_sessions import AllSessions, CellSessions
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.parameters import TRANSFORM_SPECS, Values
from camera_to_base.ros import real_time_timer
from camera_to_base.settings import CAMERA_SPECS
from rcl_interfaces.msg import ParameterEvent
from rclpy.client import Client
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Trigger

_PERIOD_S = 0.1
_BEATS_PER_S = 10
_BEATS_PER_SHAPE = 2

OnPart = Callable[[str, Any], None]


class CellWatch:
    """
    Listens to a cell's nodes, and tells each part of its state that has changed.

    :param node: The node that listens.
    :param namespace: The cell's.
    :param cells: All cells.
    :param on_part: Called with a part's name and its data.
    :param lines: What its nodes have logged before.
    :param sessions: What people do with it.
    """

    def __init__(
        self, node: Node, namespace: str, cells: CellFinder, on_part: OnPart, lines: Lines,
        sessions: CellSessions,
    ) -> None:
        self._node, self._namespace, self._cells = node, namespace, cells
        self._on_part = on_part
        self._sent: Dict[str, Any] = {}
        self._cell = GraphCell(namespace, None, None)
        self._beats = 0
        names = {name: full_name(namespace, name) for name in (CAMERA, TRANSFORM)}
        self.camera = RemoteParameters(
            node, names[CAMERA], CAMERA_SPECS, self._on_parameters)
        self.transform = RemoteParameters(
            node, names[TRANSFORM], TRANSFORM_SPECS, self._on_parameters)
        self.geometry: Optional[Geometry] = None
        self._events = node.create_subscription(
            ParameterEvent, '/parameter_events', self._on_event, 100)
        self._sessions, self._feed = sessions, SessionFeed(node, namespace, sessions)
        self.positions = CellPositions(node, namespace, self._feed.on_objects)
        self._health = CellHealth(node, names.values())
        self._log = LogLines(node, names.values(), lines)
        self._status = CellStatus(self.positions, self._health, namespace)
        self._capture = node.create_client(
            Trigger, f'{names[CAMERA]}/capture_background')
        self._correction = node.create_client(Trigger, f'{names[CAMERA]}/corrected_surface')
        self._snapshots: List[Snapshot] = []
        self._timer = real_time_timer(node, _PERIOD_S, self._beat)
        self._look_at_graph()

    def set_parameters(self, node: str, values: Values) -> Future:
        """
        Set parameters of a node, all or none.

        :param node: 'camera' or 'transform'.
        :returns: The future of the new values.
        :raises InvalidValueError: If the node does not run, or has just begun to.
        :raises RefusedError: If there is no such parameter; the future may raise it, too.
        """
        parameters, running = (self.camera, self._cell.camera) if node == 'camera' else (
            self.transform, self._cell.transform)
        if not parameters.is_known and running:
            raise InvalidValueError(f'{running} has not told its parameters yet, so nothing was '
                                    'set: try again in a second')
        if not parameters.is_known:
            raise InvalidValueError(
                f'{parameters.remote} does not run, so nothing was set: start it')
        return parameters.change(values)

    def values_of(self, node: str, names: Iterable[str]) -> Dict[str, Any]:
        """Return the present values of some parameters of a node, 'camera' or 'transform'."""
        known = (self.camera if node == 'camera' else self.transform).values
        return {name: known[name] for name in names if name in known}

    def capture_background(self) -> Future:
        """
        Let the camera node take the background anew.

        :returns: The future of its sentence.
        :raises InvalidValueError: If it does not run; the future, if it has not taken one.
        """
        return _asked(self._capture, 'no background was taken')

    def corrected_surface(self) -> Future:
        """
        Ask the camera node for the correction that it offers to keep.

        :returns: The future of it, as JSON.
        :raises InvalidValueError: If it does not run; the future, if it corrects nothing.
        """
        return _asked(self._correction, 'no correction was kept')

    def snapshot(self) -> Future:
        """
        Take a frame, its mask and its positions, which belong together.

        :returns: The future of the pictures by file name, and the positions as JSON.
        """
        self._snapshots.append(Snapshot(
            self._node, self._namespace,
            lambda stamp: self._status.frame_data(stamp, self.geometry)))
        return self._snapshots[-1].answer

    def close(self) -> None:
        """Stop listening."""
        self._node.destroy_timer(self._timer)
        self._node.destroy_client(self._capture)
        self._node.destroy_client(self._correction)
        self._node.destroy_subscription(self._events)
        for part in (*self._snapshots, self.camera, self.transform, self.positions, self._health,
                     self._log, self._feed):
            part.close()

    def _beat(self) -> None:
        self._beats += 1
        watch = self._status.watch_data(self._cell, self.geometry, self._sessions.setup)
        self._tell('watch', watch)
        if self._beats % _BEATS_PER_SHAPE == 0:
            self._tell('shapes', self._status.shapes_data(self.geometry))
        self._sessions.see_published(watch['stamp_s'], watch['objects'])
        self._feed.check()
        self._snapshots = [one for one in self._snapshots if not one.check()]
        if self._beats % _BEATS_PER_S == 0:
            self._look_at_graph()
            self._tell('beat', self._beats)
            self._tell('health', self._status.health_data())
        if self._beats % (_BEATS_PER_S // 2) == 0:
            self._tell('log', self._log.data)

    def _look_at_graph(self) -> None:
        cells = self._cells.find()
        self._cell = next(
            (cell for cell in cells if cell.namespace == self._namespace), self._cell)
        self._tell('cells', [cell.data for cell in cells])
        for name, parameters, running in (
                ('camera', self.camera, self._cell.camera),
                ('transform', self.transform, self._cell.transform)):
            if running is None:
                parameters.forget()
                self._sessions.see_parameters(name, None)
            else:
                parameters.ask()
        self._feed.look_at_driver(self._cell.camera)
        self.positions.want_fused(self._cell.is_fused)
        for part in (self._health, self._log):
            part.follow(self._status.node_names(self._cell))

    def _tell(self, part: str, data: Any) -> None:
        if part not in self._sent or self._sent[part] != data:
            self._sent[part] = data
            self._on_part(part, data)

    def _on_event(self, event: ParameterEvent) -> None:
        self.camera.on_event(event)
        self.transform.on_event(event)

    def _on_parameters(self) -> None:
        self._tell('parameters', {'camera': self.camera.data, 'transform': self.transform.data})
        self._sessions.see_parameters('camera', self.camera.values or None)
        self._sessions.see_parameters('transform', self.transform.values or None)
        try:
            self.geometry = Geometry(
                self.camera.values, self.transform.values) if self.camera.is_known else None
        except CameraToBaseError:
            self.geometry = None  # the node itself has refused them
        place = self.geometry and self.geometry.settings.surface.camera_place
        self.positions.want_silhouettes(place is not None)
        self._tell('grid', self.geometry.grid_data if self.geometry else {})


def _asked(client: Client, what_was_not_done: str) -> Future:
    if not client.service_is_ready():
        raise InvalidValueError(f'camera_publisher does not run, so {what_was_not_done}')
    answer = Future()
    client.call_async(Trigger.Request()).add_done_callback(
        lambda done: _tell_sentence(done.result(), answer))
    return answer


def _tell_sentence(response: Trigger.Response, answer: Future) -> None:
    if response.success:
        answer.set_result(response.message)
    else:
        answer.set_exception(InvalidValueError(response.message))


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
        if not self._lines.get(namespace):
            self._lines.pop(namespace, None)

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
