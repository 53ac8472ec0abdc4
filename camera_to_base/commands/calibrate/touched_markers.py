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
"""`calibrate markers --base`: the surface and the base frame from markers that a robot touches."""

import argparse
from functools import lru_cache
from typing import Any, Dict, List

from camera_to_base.calibration import (
    calibrate_touched_markers, markers_to_touch, Report, report_lines, SURFACE,
    TouchedCalibration)
from camera_to_base.checks import finite_number
from camera_to_base.commands.calibrate.files import (
    camera_values, check_outputs, Outputs, write_part)
from camera_to_base.commands.calibrate.live import open_robot, Robot
from camera_to_base.commands.calibrate.marker_base import touch_marker, touch_markers
from camera_to_base.commands.calibrate.marker_frames import marker_frames, markers_in
from camera_to_base.commands.calibrate.prompts import tell, until_it_fits
from camera_to_base.errors import InvalidValueError
from camera_to_base.image_size import DEFAULT_IMAGE_SIZE
from camera_to_base.markers import Corners
from camera_to_base.parameters import checked_values
from camera_to_base.settings import camera_settings, CAMERA_SPECS, CameraSettings
from camera_to_base.sources import kind_of, SIMULATED
from camera_to_base.surface import RadialDistortion
from camera_to_base.trust import view_thumbnail
import numpy as np


def run_touched_markers(options: argparse.Namespace) -> Report:
    """Calibrate surface and base frame, and write the file with both and the markers."""
    if options.marker_mm is None:
        raise InvalidValueError(
            '--base needs --marker-mm: measure the edge of a black square, such as 40')
    finite_number('--marker-mm', options.marker_mm, 1, 1000)
    outputs = check_outputs(options, SURFACE, *options.pictures, may_picture=False)
    settings = _settings(options, outputs)
    frames, name = marker_frames(options, settings)
    numbers = markers_to_touch(markers_in(
        frames, RadialDistortion.of_picture(_size(frames))))
    robot = open_robot(options.robot_topic)
    try:
        found = _agreed(frames, name, numbers, robot, options)
    finally:
        robot.close()
    values = {**_source_values(options, settings),
              'calibration.thumbnail': view_thumbnail(frames[-1])}
    return write_part(found.calibration, outputs, SURFACE, values,
                      ['', *report_lines(found.base_report)])


def _agreed(
    frames: List[np.ndarray], name: str, numbers: List[int], robot: Robot,
    options: argparse.Namespace,
) -> TouchedCalibration:
    """Let the robot touch the markers, again where a touch does not fit."""
    tell(f'The markers {", ".join(map(str, numbers))} are seen. Let the robot touch each.')
    touched = touch_markers(numbers, robot)

    @lru_cache(maxsize=None)
    def look(lens: RadialDistortion) -> List[Corners]:
        return markers_in(frames, lens)

    def touch_again(number: int) -> None:
        touched[number] = touch_marker(number, robot)

    return until_it_fits(
        lambda: calibrate_touched_markers(
            look, touched, options.marker_mm, _size(frames), source=name,
            base_z=options.base_z),
        'touches', 'a marker to touch it again', touched, touch_again)


def _settings(options: argparse.Namespace, outputs: Outputs) -> CameraSettings:
    """Return the camera's settings of the file, without a calibration."""
    old = outputs.old.values if outputs.old else {}
    kept = {name: value for name, value in old.items()
            if name == 'source' or name.startswith('simulated.')}
    size = options.image_size or old.get('surface.image_size', DEFAULT_IMAGE_SIZE)
    return camera_settings(checked_values(
        CAMERA_SPECS, {**kept, 'surface.image_size': list(size)}))


def _source_values(options: argparse.Namespace, settings: CameraSettings) -> Dict[str, Any]:
    if options.pictures:
        return {}
    name = options.camera or settings.source
    if kind_of(name) != SIMULATED:
        return camera_values(name)
    return {'source': name, 'calibration.device': name, 'simulated.markers': True}


def _size(frames: List[np.ndarray]) -> Any:
    height, width = frames[0].shape[:2]
    return width, height
