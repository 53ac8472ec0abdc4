# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the pages show of a cell: its objects, its health, and why nothing is published."""

from collections import deque
import math
import time
from typing import Any, Collection, Deque, Dict, List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.coordinate_transform import Pose
from camera_to_base.dashboard.live.cells import GraphCell
from camera_to_base.dashboard.live.geometry import Geometry
from camera_to_base.dashboard.live.positions import CellPositions, SeenFrame
from camera_to_base.ros import UncertainPose
from camera_to_base.uncertainty import error_ellipse
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
import numpy as np
from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

_SECONDS = 60

_MOST_LINES = 100
_LOG_LEVELS = {10: 'debug', 20: 'info', 30: 'warn', 40: 'error', 50: 'fatal'}


Lines = Deque[Dict[str, Any]]

# Each node reports once a second.
_STALE_S = 3.5
_HEALTH_LEVELS = {0: 'ok', 1: 'warn', 2: 'error', 3: 'stale'}

_SHARE = 0.95
_MM_PER_CM = 10.0
# A base position belongs to a camera position that is transformed to this close to it.
_SAME_CM = 0.05
_DIGITS = 4

# Without a message for so long, nothing is published.
SILENT_S = 1.5


class Charts:
    """Keeps the rate and the latency of each of the last 60 s."""

    def __init__(self) -> None:
        self._rates: Deque[float] = deque(maxlen=_SECONDS)
        self._latencies: Deque[Optional[float]] = deque(maxlen=_SECONDS)

    def add(self, rate_hz: float, latency_ms: Optional[float]) -> None:
        """Add the numbers of a second; None where no frame came."""
        self._rates.append(rate_hz)
        self._latencies.append(latency_ms)

    @property
    def data(self) -> Dict[str, Any]:
        """The numbers as JSON, the oldest first."""
        return {'rate_hz': list(self._rates), 'latency_ms': list(self._latencies)}


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
                    'level': _LOG_LEVELS.get(line.level, 'info'),
                    'node': self._names[line.name], 'text': line.msg}
            if told not in self._lines:
                self._lines.append(told)


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


def objects_data(frame: SeenFrame, geometry: Optional[Geometry]) -> List[Dict[str, Any]]:
    """Describe the objects of a frame, the largest first; the ellipses contain 95 % of errors."""
    camera_poses = frame.camera or []
    bases = _bases(camera_poses, frame.base or [], geometry)
    pixels = _pixels([pose[:2] for pose in camera_poses], geometry)
    return [{
        'number': number + 1, 'pixel': pixels[number], 'camera': _flat(pose),
        'base': None if bases[number] is None else _in_space(bases[number], pose),
        'ellipse': _ellipse(number, pose, bases[number], frame),
    } for number, pose in enumerate(camera_poses)]


def left_out_data(frame: SeenFrame, geometry: Optional[Geometry]) -> List[Dict[str, Any]]:
    """Describe what was left out of a frame."""
    pixels = _pixels([(one.x, one.y) for one in frame.left_out], geometry)
    return [{'reason': one.kind, 'sentence': one.sentence, 'x': round(one.x, _DIGITS),
             'y': round(one.y, _DIGITS), 'pixel': pixel}
            for one, pixel in zip(frame.left_out, pixels)]


def _bases(
    camera_poses: Sequence[Pose], base_poses: Sequence[Pose], geometry: Optional[Geometry]
) -> List[Optional[Pose]]:
    # Positions beyond the reach are dropped, so the numbers of the two lists may differ.
    if len(camera_poses) == len(base_poses):
        return list(base_poses)
    if geometry is None or geometry.transform is None:
        return [None] * len(camera_poses)
    convert = geometry.transform.conversion.convert_point
    return [next((base for base in base_poses
                  if math.dist(base[:2], convert(*pose[:3])[:2]) < _SAME_CM), None)
            for pose in camera_poses]


def _ellipse(
    number: int, camera: Pose, base: Optional[Pose], frame: SeenFrame
) -> Optional[Dict[str, Any]]:
    if base is not None and frame.base_ellipses:
        return _ellipse_at(base, frame.base_ellipses, 'base')
    return _ellipse_at(camera, frame.camera_ellipses, 'camera')


def _ellipse_at(
    pose: Pose, ellipses: Sequence[UncertainPose], name: str
) -> Optional[Dict[str, Any]]:
    found = next((one for one in ellipses if math.dist(one.pose[:2], pose[:2]) < _SAME_CM), None)
    if found is None:
        return None
    ellipse = error_ellipse(found.covariance, _SHARE)
    return {'major_mm': round(_MM_PER_CM * ellipse.long, 3),
            'minor_mm': round(_MM_PER_CM * ellipse.short, 3),
            'angle_deg': round(math.degrees(ellipse.angle), 1), 'frame': name}


def _pixels(
    points: Sequence[Tuple[float, float]], geometry: Optional[Geometry]
) -> List[Optional[List[float]]]:
    if geometry is None or not points:
        return [None] * len(points)
    return [None if pixel is None else np.round(pixel, 1).tolist()
            for pixel in geometry.pixels(points)]


def _flat(pose: Pose) -> Dict[str, Any]:
    # An object without a direction has the identity's.
    yaw = None if pose.yaw == 0.0 else round(math.degrees(pose.yaw), 2)
    return {'x': round(pose.x, _DIGITS), 'y': round(pose.y, _DIGITS), 'yaw_deg': yaw}


def _in_space(base: Pose, camera: Pose) -> Dict[str, Any]:
    yaw = None if camera.yaw == 0.0 else round(math.degrees(base.yaw), 2)
    return {'x': round(base.x, _DIGITS), 'y': round(base.y, _DIGITS), 'yaw_deg': yaw}


class State(NamedTuple):
    """
    What is known about a cell.

    :param was_seen: Whether its camera node ran before.
    :param silent_s: Time since the last objects came.
    :param camera: The camera node's last report; None if there was none.
    :param transform: The transform node's.
    """

    cell: GraphCell
    was_seen: bool
    silent_s: float
    camera: Optional[Report]
    transform: Optional[Report]


def silence(state: State) -> Optional[Dict[str, Any]]:
    """Return why no positions come, in the camera frame or in the base frame; None if they do."""
    if state.silent_s <= SILENT_S:
        return None if state.cell.transform is not None else _told(
            'transform_not_running', 'warn',
            'robot_base_publisher does not run, so there are no positions in the base frame: '
            + _start('robot_base_publisher', state.cell))
    if state.cell.camera is None:
        return _no_camera_node(state)
    report = state.camera
    if report is not None and report.is_stale:
        return _told('node_hangs', 'error', (
            f'camera_publisher has not reported for {report.age_s:.0f} s: look at its terminal, '
            'and start it anew'))
    if report is not None and report.level != 'ok':
        return _told(report.reason, report.level, report.sentence)
    return _told('waiting', 'warn', 'waiting for the first positions of camera_publisher')


def warning(state: State) -> Optional[Dict[str, Any]]:
    """Return what is doubtful about positions that are published; None if nothing is."""
    if state.silent_s > SILENT_S:
        return None
    for report in (state.camera, state.transform):
        if report is not None and report.level != 'ok' and not report.is_stale:
            return _told(report.reason, report.level, report.sentence)
    return None


def _no_camera_node(state: State) -> Dict[str, Any]:
    if state.was_seen:
        return _told('node_ended', 'error', (
            'camera_publisher has ended: its terminal says why. '
            + _start('camera_publisher', state.cell).capitalize()))
    return _told('not_running', 'error', (
        'camera_publisher does not run, or this machine does not find it: '
        + _start('camera_publisher', state.cell)))


def _start(node: str, cell: GraphCell) -> str:
    in_cell = '' if cell.namespace == '/' else f' -r __ns:={cell.namespace}'
    return f'start it, for example with: ros2 run camera_to_base {node}' + (
        f' --ros-args{in_cell}' if in_cell else '')


def _told(kind: str, level: str, sentence: str) -> Dict[str, Any]:
    return {'reason': kind, 'level': level, 'sentence': sentence}


class CellStatus:
    """
    Puts together what came from a cell's nodes.

    :param positions: What they publish.
    :param health: What they say about themselves.
    :param camera: The camera node's full name.
    :param transform: The transform node's full name.
    """

    def __init__(
        self, positions: CellPositions, health: CellHealth, camera: str, transform: str
    ) -> None:
        self._positions, self._health = positions, health
        self._camera, self._transform = camera, transform
        self._charts = Charts()
        self._was_seen = False

    def watch_data(self, cell: GraphCell, geometry: Optional[Geometry]) -> Dict[str, Any]:
        """
        Return the part `watch` as JSON.

        :param cell: The nodes that run.
        :param geometry: Where things are; None where it is not known.
        """
        self._was_seen |= cell.camera is not None
        state = State(cell, self._was_seen, self._positions.silent_s,
                      self._health.report(self._camera), self._health.report(self._transform))
        frame = self._positions.newest
        shown = self._shown
        return {
            'silence': silence(state), 'warning': warning(state),
            'rate_hz': round(self._positions.rate_hz, 1),
            'age_s': None if frame is None else round(time.time() - frame.stamp_s, 1),
            'latency_ms': self._latency_ms,
            'objects': objects_data(shown, geometry) if shown else [],
            'left_out': left_out_data(shown, geometry) if shown else [],
            'map': geometry and geometry.map_data, 'image': geometry and geometry.image_data}

    def health_data(self) -> Dict[str, Any]:
        """Return the part `health` as JSON; it is called once a second."""
        self._charts.add(round(self._positions.rate_hz, 1), self._latency_ms)
        return {'nodes': self._health.data, 'charts': self._charts.data}

    @property
    def _shown(self) -> Optional[SeenFrame]:
        return self._positions.newest if self._positions.silent_s <= SILENT_S else None

    @property
    def _latency_ms(self) -> Optional[float]:
        shown = self._shown
        return None if shown is None else round(1e3 * shown.latency_s, 1)
