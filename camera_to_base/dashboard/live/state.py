# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
What state a cell is in, decided from facts in one place.

The banner, each part of the page and Health show this one value; none of them makes its own.
"""

import time
from types import MappingProxyType
from typing import Any, Collection, Dict, List, Mapping, NamedTuple, Optional, Tuple

from camera_to_base.calibration import BASE, SURFACE
from camera_to_base.dashboard.live.cells import CAMERA, FUSION, GraphCell, TRANSFORM

# Without objects in the camera frame for so long, nothing is published.
SILENT_S = 1.5
# Base positions follow within milliseconds.
_LONGEST_OWED_S = 2.0
# A node reports once a second; one that was killed is told within 3 s.
_STALE_S = 2.5

# What a board in the view looks like to the camera node. A nudge (view_moved, view_corrected) is
# not among them: the placements of a board do not belong together then.
_COVERED = (
    'view_changed', 'view_unknown', 'background_unsettled', 'background_missing', 'touched')
# What a background of the former surface, or a board that still lies there, looks like.
_OUTDATED = (*_COVERED, 'background_dark', 'other_view', 'frame_size', 'view_moved', 'taken_away')
# Positions that are wrong for more than one reason: this one comes first.
_BEFORE_BASE = ('not_calibrated', 'random', 'other_camera')

# The part of the page that helps, by the beginning of a kind.
_WAYS = {
    'save': ('view_corrected',),
    'watch': ('looks_solid',),
    'calibrate': ('not_calibrated', 'other_camera', 'frame_size'),
    'robot': ('base_not_calibrated',),
    'detect': ('view_', 'background_', 'taken_away', 'other_view'),
    'health': ('camera_', 'no_publisher', 'damaged', 'old_frames', 'topic_', 'no_base_positions'),
}


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
        """Whether the node has missed a report."""
        return self.age_s > _STALE_S


class Facts(NamedTuple):
    """
    What is known about a cell.

    :param was_seen: Whether its camera node ran before, of a fused cell its camera_fusion.
    :param silent_s: Time since the last objects in the camera frame came.
    :param owed_s: Time since objects came in the camera frame that have not come in the base
        frame, nor any later ones; 0 if they have.
    :param camera: The camera node's last report; None if there was none.
    :param transform: The transform node's.
    :param fusion: Of camera_fusion, in a fused cell.
    :param cameras: Of the camera nodes of a fused cell, by the cells' names.
    :param parts: What is calibrated: SURFACE, MARKERS, BASE; None while it is not known.
    :param sees_board: Whether a board is looked for, and seen now.
    :param has_new_surface: Whether a new surface is used whose background is not taken yet.
    :param object_count: Number of objects in the newest frame.
    :param has_left_out: Whether something was left out of it, or of one shortly before.
    :param not_kept: Why what people have measured is not on the disk; None if it is.
    """

    cell: GraphCell
    was_seen: bool = True
    silent_s: float = 0.0
    owed_s: float = 0.0
    camera: Optional[Report] = None
    transform: Optional[Report] = None
    fusion: Optional[Report] = None
    cameras: Mapping[str, Optional[Report]] = MappingProxyType({})
    parts: Optional[Collection[str]] = None
    sees_board: bool = False
    has_new_surface: bool = False
    object_count: int = 0
    has_left_out: bool = False
    not_kept: Optional[str] = None


class CellState(NamedTuple):
    """
    The state of a cell.

    :param kind: A stable word; `ok` if positions in the base frame are published and nothing is
        doubtful.
    :param level: 'ok', 'calm' for what belongs to the step that is done now, 'warn' or 'error'.
    :param sentence: What is the matter, and what to do.
    :param also: What else is the matter, a sentence each.
    """

    kind: str
    level: str
    sentence: str
    also: Tuple[str, ...] = ()

    @property
    def data(self) -> Dict[str, Any]:
        """The state as JSON; `way` is the part of the page that helps."""
        way = next((part for part, kinds in _WAYS.items() if self.kind.startswith(kinds)), None)
        return {'reason': self.kind, 'level': self.level, 'sentence': self.sentence,
                'also': list(self.also), 'way': way}


def cell_state(facts: Facts) -> CellState:
    """Decide what state a cell is in; the most harmful fact comes first."""
    if facts.cell.is_fused:
        return _fused(facts)
    if facts.silent_s > SILENT_S:
        return _silence(facts)
    doubts = list(filter(None, (
        _without_base(facts), _uncalibrated(facts), _doubt(facts.camera),
        _doubt(facts.transform), _not_kept(facts.not_kept))))
    return _worst(doubts) or CellState('ok', 'ok', _published(facts))


def _worst(doubts: List[CellState]) -> Optional[CellState]:
    """Return the first doubt, with the sentences of the others; None for none."""
    if not doubts:
        return None
    first, *others = doubts
    return first._replace(also=tuple(one.sentence for one in others
                                     if one.sentence not in first.sentence))


def _fused(facts: Facts) -> CellState:
    # A camera that is nudged, or sees nothing, is its own cell's matter, and this one's.
    of_cameras = [doubt._replace(kind='camera_doubt', sentence=f'In {name}, {doubt.sentence}')
                  for name, doubt in zip(facts.cameras, map(_doubt, facts.cameras.values()))
                  if doubt is not None]
    doubt = _worst([one for one in (_doubt(facts.fusion), *of_cameras) if one is not None])
    if facts.silent_s <= SILENT_S:
        return doubt or CellState('ok', 'ok', _published(facts))
    return _no_node(FUSION, facts.cell.fusion, facts.fusion, facts) or doubt or CellState(
        'waiting', 'warn', 'waiting for the first positions of camera_fusion')


def _no_node(
    node: str, running: Optional[str], report: Optional[Report], facts: Facts
) -> Optional[CellState]:
    """Tell that the node from which objects come does not run, or hangs; None if it is well."""
    if running is None and facts.was_seen:
        return CellState('node_ended', 'error', (
            f'{node} has ended: its terminal says why. {_start(node, facts.cell).capitalize()}'))
    if running is None:
        return CellState('not_running', 'error', (
            f'{node} does not run, or this machine does not find it: '
            + _start(node, facts.cell)))
    if report is not None and report.is_stale:
        return CellState('node_hangs', 'error', (
            f'{node} has not reported for {report.age_s:.0f} s, and publishes nothing: '
            'look at its terminal, and start it again'))
    return None


def _silence(facts: Facts) -> CellState:
    report = facts.camera
    missing = _no_node(CAMERA, facts.cell.camera, report, facts)
    if missing is not None:
        return missing
    kind = '' if report is None else report.reason
    if facts.has_new_surface and kind in _OUTDATED:
        return CellState('background_next', 'calm', (
            'The surface is calibrated. Take the board away, and take the background of the empty '
            'surface: no positions are published before.'))
    if facts.sees_board and kind in _COVERED:
        return CellState('board_covers', 'calm', (
            'No positions are published while the board covers the view. This is normal.'))
    return _doubt(report) or CellState(
        'waiting', 'warn', 'waiting for the first positions of camera_publisher')


def _without_base(facts: Facts) -> Optional[CellState]:
    if facts.cell.transform is None:
        return CellState('transform_not_running', 'warn', (
            'robot_base_publisher does not run, so there are no positions in the base frame: '
            + _start(TRANSFORM, facts.cell)))
    if facts.owed_s <= _LONGEST_OWED_S:
        return None
    report = facts.transform
    if report is not None and report.is_stale:
        return CellState('transform_hangs', 'error', (
            f'robot_base_publisher has not reported for {report.age_s:.0f} s, and there are no '
            'positions in the base frame: look at its terminal. If it has ended, '
            + _start(TRANSFORM, facts.cell)))
    cause = _doubt(report)
    return CellState('no_base_positions', 'error', (
        'no positions come in the base frame: '
        + (cause.sentence if cause else 'robot_base_publisher publishes none; see its messages')))


def _uncalibrated(facts: Facts) -> Optional[CellState]:
    is_worse = facts.camera is not None and facts.camera.reason in _BEFORE_BASE
    if is_worse or facts.parts is None or SURFACE not in facts.parts or BASE in facts.parts:
        return None
    return CellState('base_not_calibrated', 'warn', (
        'The base frame is not calibrated: positions in the base frame are wrong, those in the '
        'camera frame are right. Measure with the robot where it stands, or start '
        'robot_base_publisher with the file that has it.'))


def _doubt(report: Optional[Report]) -> Optional[CellState]:
    # What was told last holds until another report comes, however late that is.
    if report is None or report.level == 'ok':
        return None
    return CellState(report.reason, report.level, report.sentence)


def _not_kept(problem: Optional[str]) -> Optional[CellState]:
    if problem is None:
        return None
    return CellState('steps_not_kept', 'warn', (
        'What you have measured is not on the disk, and is lost when the dashboard ends: '
        f'{problem}'))


def _published(facts: Facts) -> str:
    # No rate: a screen reader would read out each change of it.
    count = facts.object_count
    if not count and facts.has_left_out:
        return 'No object is published: Watch lists what is left out, with the reason.'
    if not count:
        return 'The surface is empty: an empty list of objects is published.'
    return '1 object is published.' if count == 1 else f'{count} objects are published.'


def _start(node: str, cell: GraphCell) -> str:
    in_cell = '' if cell.namespace == '/' else f' -r __ns:={cell.namespace}'
    return f'start it, for example with: ros2 run camera_to_base {node}' + (
        f' --ros-args{in_cell}' if in_cell else '')
