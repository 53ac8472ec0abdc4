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
"""`calibrate base --markers`: the robot touches the markers that a file knows."""

import argparse
from typing import Any, Dict, List, Optional, Tuple

from camera_to_base.calibration import (
    BASE, calibrate_base, Calibration, MARKERS, Report, TouchedPair)
from camera_to_base.commands.calibrate.files import base_outputs, write_part
from camera_to_base.commands.calibrate.live import (
    display_text, open_robot, Robot, touch_elsewhere)
from camera_to_base.commands.calibrate.prompts import tell, until_it_fits
from camera_to_base.markers import known_markers, MARKER_SPECS
from camera_to_base.parameters import checked_values
from camera_to_base.settings import read_node_settings
from camera_to_base.simulation import SimulatedTouchTable
from camera_to_base.sources import kind_of, SIMULATED
from camera_to_base.surface import PointPairs, SURFACE_SPECS
import numpy as np

_Point = Tuple[float, float]


def run_marker_base(options: argparse.Namespace) -> Report:
    """Calibrate the base frame by touched markers, and write the file."""
    outputs = base_outputs(options, '--markers', MARKERS, {
        'a table': options.table, '--surface': options.surface, '--camera': options.camera})
    values = outputs.old.values
    middles = {number: tuple(corners.mean(axis=0).tolist()) for number, corners in known_markers(
        checked_values([*MARKER_SPECS, *SURFACE_SPECS], values)).items()}
    robot = open_robot(options.robot_topic)
    table = _simulated_table(options.markers)
    try:
        touched = {}
        for number in sorted(middles):
            touched[number] = _touch(number, middles, touched, robot, table)
        return write_part(
            _agreed(middles, touched, robot, table, values, options), outputs, BASE)
    finally:
        robot.close()


def touch_markers(numbers: List[int], robot: Robot) -> Dict[int, _Point]:
    """Ask for the touch of each marker; return x and y by its number, in cm, in the base frame."""
    return {number: touch_marker(number, robot) for number in numbers}


def touch_marker(number: int, robot: Robot) -> _Point:
    """Ask for the touch of a marker; return x and y, in cm, in the base frame."""
    return _touch(number, {number: (0.0, 0.0)}, {}, robot, None)


def _touch(
    number: int, middles: Dict[int, _Point], touched: Dict[int, _Point], robot: Robot,
    table: Optional[SimulatedTouchTable],
) -> _Point:
    """Ask for the touch of a marker; return x and y, in cm, in the base frame."""
    tell(f'Marker {number}: the small cross in its middle')
    shown = table and table.robot_position_at(number)
    if shown:
        tell(f'  {display_text(shown)}')
    return touch_elsewhere(robot, middles[number], [
        TouchedPair(None, middles[other], touched[other])
        for other in sorted(touched) if other != number])


def _simulated_table(path: str) -> Optional[SimulatedTouchTable]:
    """Return the simulated table with its robot, if the file names the simulated camera."""
    camera = read_node_settings(path).camera
    if kind_of(camera.source) != SIMULATED:
        return None
    return camera.simulated.touch_table(camera.image_size)


def _agreed(
    middles: Dict[int, _Point], touched: Dict[int, _Point], robot: Robot,
    table: Optional[SimulatedTouchTable], values: Dict[str, Any], options: argparse.Namespace,
) -> Calibration:
    """Fit the pairs; where they do not fit, let single markers be touched again."""
    def touch_again(number: int) -> None:
        touched[number] = _touch(number, middles, touched, robot, table)

    return until_it_fits(
        lambda: marker_base(middles, touched, values, options.base_z),
        'touches', 'a marker to touch it again', touched, touch_again)


def marker_base(
    middles: Dict[int, _Point], touched: Dict[int, _Point], values: Dict[str, Any], base_z: str
) -> Calibration:
    """
    Fit the base frame to touched markers.

    :param middles: By number, in cm, in the camera frame.
    :param touched: By number, in cm, in the base frame.
    :param values: The surface's parameters, by full name.
    """
    numbers = sorted(touched)
    pairs = PointPairs(np.array([(*middles[number], 0.0) for number in numbers]),
                       np.array([(*touched[number], 0.0) for number in numbers]), tuple(numbers))
    return calibrate_base(pairs, source='markers that the robot touched', base_z=base_z,
                          surface_values=values, points_are='marker')
