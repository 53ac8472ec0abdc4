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
"""`calibrate markers`: where the markers of a table lie, on a surface that is calibrated."""

import argparse
from typing import Tuple

from camera_to_base.calibration import learned_markers, MARKERS, Report, SURFACE
from camera_to_base.commands.calibrate.files import check_outputs, refuse_without, write_part
from camera_to_base.commands.calibrate.marker_frames import marker_frames, markers_in
from camera_to_base.errors import InvalidValueError
from camera_to_base.markers import lens_of_values
from camera_to_base.parameters import checked_values
from camera_to_base.settings import CAMERA_SPECS, read_node_settings
import numpy as np


def run_markers(options: argparse.Namespace) -> Report:
    """Learn the markers, and write the file."""
    outputs = check_outputs(options, MARKERS, *options.pictures, may_picture=False)
    old = outputs.old.values if outputs.old else {}
    refuse_without(SURFACE, options.output, old)
    values = checked_values(CAMERA_SPECS, old)
    frames, name = marker_frames(options, read_node_settings(options.output).camera)
    _refuse_other_size(frames[0], values['surface.image_size'])
    calibration = learned_markers(
        markers_in(frames, lens_of_values(values)), values, source=name,
        marker_mm=options.marker_mm)
    return write_part(calibration, outputs, MARKERS)


def _refuse_other_size(frame: np.ndarray, image_size: Tuple[int, int]) -> None:
    height, width = frame.shape[:2]
    if [width, height] != list(image_size):
        raise InvalidValueError(
            'the picture is {} x {} px, but the surface was calibrated for {} x {} px: use '
            'pictures of that size, from that camera'.format(width, height, *image_size))
