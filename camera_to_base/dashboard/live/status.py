# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the pages show of a cell: its objects with their errors, and its state."""

import math
import time
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.coordinate_transform import Pose
from camera_to_base.dashboard.live.cells import (
    CAMERA, full_name, FUSION, GraphCell, TRANSFORM)
from camera_to_base.dashboard.live.geometry import Geometry, shapes_data
from camera_to_base.dashboard.live.health import CellHealth, Charts
from camera_to_base.dashboard.live.positions import CellPositions, SeenFrame
from camera_to_base.dashboard.live.state import cell_state, Facts, SILENT_S
from camera_to_base.dashboard.sessions.values import Setup
from camera_to_base.ros import UncertainPose
from camera_to_base.uncertainty import error_ellipse
import numpy as np

_SHARE = 0.95
_MM_PER_CM = 10.0
# A base position belongs to a camera position that is transformed to this close to it.
_SAME_CM = 0.05
_DIGITS = 4
# Slower than this, an object that moves by 10 cm/s is 2 cm farther with each frame, and 3 cm
# farther when its position comes.
_LEAST_HZ, _LONGEST_MS = 5.0, 300.0
# An object's last ellipse is held for so long, while it moves at most so far.
_HELD_S, _HELD_CM = 2.0, 3.0
_HELD_LEFT_OUT_S = 1.0


class HeldEllipses:
    """
    Keeps the last ellipse of each object: those of a frame come after its positions.

    An ellipse belongs to the frame that it was made in, 'base' or 'camera'; it is never shown
    for a position in the other one.
    """

    def __init__(self) -> None:
        self._held: Dict[str, Tuple[float, List[_HeldEllipse]]] = {}

    def of(
        self, name: str, poses: Sequence[Optional[Pose]], ellipses: Sequence[UncertainPose],
        now: float,
    ) -> List[Optional[Dict[str, Any]]]:
        """
        Return the ellipse of each object as JSON; None where none is known.

        :param name: 'base' or 'camera': the frame of the poses and of the ellipses.
        :param poses: Of a frame's objects, in cm; None for one that is not shown.
        :param ellipses: Those of the same frame that have come so far.
        :param now: From time.monotonic().
        """
        if ellipses:
            self._held[name] = now, [_HeldEllipse(one.pose, _ellipse_data(one, name))
                                     for one in ellipses]
        came_at, held = self._held.get(name, (-math.inf, []))
        if now - came_at > _HELD_S:
            return [None] * len(poses)
        reach = _SAME_CM if ellipses else _HELD_CM
        return [pose and _nearest(pose, held, reach) for pose in poses]


class _HeldEllipse(NamedTuple):
    pose: Pose
    data: Dict[str, Any]


def _nearest(
    pose: Pose, held: Sequence[_HeldEllipse], reach_cm: float
) -> Optional[Dict[str, Any]]:
    away = [math.dist(one.pose[:2], pose[:2]) for one in held]
    return held[int(np.argmin(away))].data if held and min(away) < reach_cm else None


def _ellipse_data(one: UncertainPose, name: str) -> Dict[str, Any]:
    ellipse = error_ellipse(one.covariance, _SHARE)
    return {'major_mm': round(_MM_PER_CM * ellipse.long, 3),
            'minor_mm': round(_MM_PER_CM * ellipse.short, 3),
            'angle_deg': round(math.degrees(ellipse.angle), 1), 'frame': name}


def objects_data(
    frame: SeenFrame, geometry: Optional[Geometry], held: HeldEllipses
) -> List[Dict[str, Any]]:
    """
    Describe the objects of a frame, the largest first; the ellipses contain 95 % of errors.

    An object that has a base position has the ellipse of that, and no other.
    """
    camera_poses = frame.camera or []
    bases = _bases(camera_poses, frame.base or [], geometry)
    now = time.monotonic()
    of_camera = held.of('camera', camera_poses, frame.camera_ellipses, now)
    of_base = held.of('base', bases, frame.base_ellipses, now)
    pixels = _pixels([pose[:2] for pose in camera_poses], geometry)
    return [{
        'number': number + 1, 'pixel': pixels[number],
        'camera': None if frame.is_fused else _flat(pose),
        'base': None if bases[number] is None else _in_space(bases[number], pose),
        'ellipse': of_camera[number] if bases[number] is None else of_base[number],
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


class CellStatus:
    """
    Puts together what came from a cell's nodes.

    :param positions: What they publish.
    :param health: What they say about themselves.
    :param namespace: The cell's.
    """

    def __init__(
        self, positions: CellPositions, health: CellHealth, namespace: str
    ) -> None:
        self._positions, self._health = positions, health
        self._camera, self._transform, self._fusion = (
            full_name(namespace, name) for name in (CAMERA, TRANSFORM, FUSION))
        self._charts, self._held = Charts(), HeldEllipses()
        self._was_seen = False
        self._left_out_at = -math.inf
        self._old_surface: Any = None
        self._state: Dict[str, Any] = {}

    def cameras(self, cell: GraphCell) -> List[str]:
        """Return the namespaces whose silhouettes a fused cell is made of, as its node told."""
        report = self._health.report(self._fusion)
        told = report.values.get('source', '') if cell.is_fused and report else ''
        return [full_name(cell.namespace, name) for name in told.split(', ') if name]

    def node_names(self, cell: GraphCell) -> List[str]:
        """Return the full names of the nodes that are a cell's, or that a fused cell lives on."""
        of_cameras = [full_name(camera, name) for camera in self.cameras(cell)
                      for name in (CAMERA, TRANSFORM)]
        return ([self._fusion, *of_cameras] if cell.is_fused else
                [self._camera, self._transform])

    def watch_data(
        self, cell: GraphCell, geometry: Optional[Geometry], setup: Setup
    ) -> Dict[str, Any]:
        """
        Return the part `watch` as JSON.

        :param cell: The nodes that run.
        :param geometry: Where things are; None where it is not known.
        :param setup: What is calibrated, and what is being done.
        """
        self._was_seen |= (cell.fusion if cell.is_fused else cell.camera) is not None
        frame = self._positions.newest
        shown = self._shown
        self._state = cell_state(self._facts(cell, setup, shown)).data
        return {
            'state': self._state, 'rate_hz': round(self._positions.rate_hz, 1),
            'looks_solid': self._looks_solid,
            'stamp_s': None if frame is None else round(frame.stamp_s, 3),
            'age_s': None if frame is None else round(time.time() - frame.stamp_s, 1),
            'latency_ms': self._latency_ms, 'pace': self._pace,
            'objects': objects_data(shown, geometry, self._held) if shown else [],
            'left_out': left_out_data(shown, geometry) if shown else [],
            'cameras': self.cameras(cell) if cell.is_fused else None,
            'map': geometry and geometry.map_data, 'image': geometry and geometry.image_data}

    def shapes_data(self, geometry: Optional[Geometry]) -> List[Dict[str, Any]]:
        """Return the part `shapes` as JSON: the boxes and footprints of the objects."""
        return shapes_data(self._positions.newest_with_boxes if self._shown else None, geometry)

    def frame_data(
        self, stamp: Tuple[int, int], geometry: Optional[Geometry]
    ) -> Optional[Dict[str, Any]]:
        """Describe the frame with a stamp as JSON; None while its positions are not there."""
        frame = self._positions.at(stamp)
        return frame and {
            'state': self._state, 'objects': objects_data(frame, geometry, self._held),
            'left_out': left_out_data(frame, geometry), 'units': 'cm, degrees, px; ellipses: mm'}

    def health_data(self) -> Dict[str, Any]:
        """Return the part `health` as JSON; it is called once a second."""
        self._charts.add(round(self._positions.rate_hz, 1), self._latency_ms)
        return {'state': self._state, 'nodes': self._health.data, 'charts': self._charts.data}

    def _facts(
        self, cell: GraphCell, setup: Setup, shown: Optional[SeenFrame]
    ) -> Facts:
        if shown is not None:
            # Its background fits: positions are published.
            self._old_surface = setup.new_surface
        return Facts(
            cell, self._was_seen, self._positions.silent_s, self._positions.owed_s,
            *map(self._health.report, (self._camera, self._transform, self._fusion)),
            {name: self._health.report(full_name(name, CAMERA)) for name in self.cameras(cell)},
            setup.parts, setup.sees_board,
            setup.new_surface is not None and setup.new_surface is not self._old_surface,
            len(shown.camera or []) if shown else 0, self._has_left_out(shown),
            setup.not_kept)

    def _has_left_out(self, shown: Optional[SeenFrame]) -> bool:
        # Held: it comes after the objects of its frame.
        if shown is not None and shown.left_out:
            self._left_out_at = time.monotonic()
        return time.monotonic() - self._left_out_at < _HELD_LEFT_OUT_S

    @property
    def _looks_solid(self) -> bool:
        report = self._health.report(self._camera)
        return (report is not None and not report.is_stale
                and report.reason == 'looks_solid')

    @property
    def _shown(self) -> Optional[SeenFrame]:
        return self._positions.newest if self._positions.silent_s <= SILENT_S else None

    @property
    def _pace(self) -> Dict[str, Optional[str]]:
        """Whether the rate is 'low' and the latency 'high'; None where they are not."""
        if self._shown is None or self._state['reason'] == 'random':
            return {'rate': None, 'latency': None}
        return {'rate': 'low' if self._positions.rate_hz < _LEAST_HZ else None,
                'latency': 'high' if self._latency_ms > _LONGEST_MS else None}

    @property
    def _latency_ms(self) -> Optional[float]:
        shown = self._shown
        return None if shown is None else round(1e3 * shown.latency_s, 1)
