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

"""Why a cell publishes nothing, and what to do."""

from typing import Any, Dict, NamedTuple, Optional

from camera_to_base.dashboard.live.cells import Cell
from camera_to_base.dashboard.live.health import Report

# Without a message for so long, nothing is published.
SILENT_S = 1.5


class State(NamedTuple):
    """
    What is known about a cell.

    :param was_seen: Whether its camera node ran before.
    :param silent_s: Time since the last objects came.
    :param camera: The camera node's last report; None if there was none.
    :param transform: The transform node's.
    """

    cell: Cell
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


def _start(node: str, cell: Cell) -> str:
    in_cell = '' if cell.namespace == '/' else f' -r __ns:={cell.namespace}'
    return f'start it, for example with: ros2 run camera_to_base {node}' + (
        f' --ros-args{in_cell}' if in_cell else '')


def _told(kind: str, level: str, sentence: str) -> Dict[str, Any]:
    return {'reason': kind, 'level': level, 'sentence': sentence}
