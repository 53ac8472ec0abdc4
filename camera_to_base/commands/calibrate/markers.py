# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""`calibrate markers`: where the markers of a table lie, on a surface that is calibrated."""

import argparse
from dataclasses import replace
from typing import List, Tuple

from camera_to_base.calibration import learned_markers, MARKERS, Report, SURFACE
from camera_to_base.commands.calibrate.files import check_outputs, refuse_without, write_part
from camera_to_base.errors import InvalidValueError
from camera_to_base.markers import Corners, lens_of_values, see_markers
from camera_to_base.parameters import checked_values
from camera_to_base.settings import (
    CAMERA_SPECS, CameraSettings, open_named_source, read_node_settings)
from camera_to_base.sources import read_picture, still_frames
from camera_to_base.surface import RadialDistortion
import numpy as np


def marker_frames(
    options: argparse.Namespace, settings: CameraSettings
) -> Tuple[List[np.ndarray], str]:
    """
    Return frames that show the markers, and where they come from.

    :param options: Name pictures or a camera.
    :param settings: The camera node's, which name the camera where the options do not.
    :raises CameraToBaseError: If there is no such picture, or no camera.
    """
    if options.pictures:
        return ([read_picture(path).frame for path in options.pictures],
                ', '.join(options.pictures))
    scene = settings.simulated.scene._replace(markers=True, shows='empty')
    source = open_named_source(replace(
        settings, source=options.camera or settings.source,
        simulated=replace(settings.simulated, scene=scene)), may_be_random=False)
    if source.frames is None:
        raise InvalidValueError(
            f"'{source.name}' is no camera that can be opened here: give --camera with a device "
            'or a stream, or pictures of the markers')
    try:
        return still_frames(source.frames), f'camera {source.name}'
    finally:
        source.frames.release()


def markers_in(frames: List[np.ndarray], lens: RadialDistortion) -> List[Corners]:
    """Find the markers in each frame."""
    return [see_markers(frame, lens).corners for frame in frames]


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
