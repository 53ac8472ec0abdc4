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

"""The parameters of `camera_publisher`: the node's own, and those of the rooms that it uses."""

from camera_to_base.detection import AREA_SPECS, BACKGROUND_SPECS, DETECTOR_SPECS
from camera_to_base.markers import MARKER_SPECS
from camera_to_base.parameters import (
    CAMERA_FRAME_SPEC, OWN_CAMERA_SPECS, ParameterSpec, PLACEMENT_SPECS, RECORD_SPECS)
from camera_to_base.simulation import SIMULATION_SPECS
from camera_to_base.surface import SURFACE_SPECS
from camera_to_base.trust import LIMIT_SPECS
from camera_to_base.uncertainty import UNCERTAINTY_SPECS

_SOURCE_SPECS = [
    ParameterSpec(
        'source', 'auto',
        'Source of the frames: auto (the first attached camera; if none is attached, random '
        'pixels with the default parameters, and waiting for a camera with others), random, '
        "a device index or path, a video file, a stream's URL, topic (a "
        "camera driver's image), compressed_topic (its image/compressed), or simulated.",
        fixed=True),
    ParameterSpec('period', 3.0, 'Time between two random pixels.', (0.001, 3600), unit='s'),
    ParameterSpec(
        'wait_for_subscribers', 1,
        'A video file starts when pos_in_cam_frame, its point, or objects_in_cam_frame has this '
        'many subscribers, or after 10 s.', (0, 100), fixed=True),
    ParameterSpec(
        'wait_for_camera', True,
        'Whether to wait for a device or a stream that is missing at the start; otherwise '
        'the node ends with an error.', fixed=True),
    ParameterSpec(
        'repeat', False,
        'Whether a video file starts again when it has ended, and a picture is shown until the '
        'node ends, as a camera would show it.', fixed=True),
]
_FILE_SPECS = [
    ParameterSpec(
        'background_file', '',
        'A file (.png) that keeps the background: it is written whenever one is taken, and read '
        'at the start if it exists. Cameras and topics only; empty for none.', fixed=True),
]
_OUTPUT_SPECS = [
    CAMERA_FRAME_SPEC,
    ParameterSpec('debug_image.coordinates', 'camera',
                  'Coordinate frame of the positions on the debug image: camera, or base, by '
                  'rotation_deg and displacement_cm.', choices=('camera', 'base')),
]
CAMERA_SPECS = [
    *_SOURCE_SPECS, *BACKGROUND_SPECS, *_FILE_SPECS, *LIMIT_SPECS, *_OUTPUT_SPECS,
    *PLACEMENT_SPECS, *AREA_SPECS, *DETECTOR_SPECS, *SURFACE_SPECS, *UNCERTAINTY_SPECS,
    *MARKER_SPECS, *SIMULATION_SPECS, *RECORD_SPECS, *OWN_CAMERA_SPECS]
