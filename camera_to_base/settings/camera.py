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

"""The parameters of `camera_publisher`, and the settings that they make."""

from dataclasses import dataclass
from typing import Any, Dict, Optional, Tuple

from camera_to_base.checks import frame_id
from camera_to_base.detection import DetectorSettings, METHODS
from camera_to_base.drawing import (
    base_label, camera_label, check_background_path, check_picture_path, Label)
from camera_to_base.errors import InvalidValueError
from camera_to_base.parameter_spec import ParameterSpec, Values
from camera_to_base.simulation import simulation_settings, SIMULATION_SPECS, SimulationSettings
from camera_to_base.surface import (
    check_image_size, Hull, make_hull, make_surface, Surface, SURFACE_SPECS)
from camera_to_base.transform_parameters import PLACEMENT_SPECS, transform_settings
from camera_to_base.trust import Limits


@dataclass(frozen=True)
class CameraSettings:
    """All that `camera_publisher` takes from its parameters."""

    source: str
    period: float
    wait_for_subscribers: int
    wait_for_camera: bool
    background_frames: int
    background_file: str
    limits: Limits
    annotated_picture: str
    camera_frame_id: str
    image_size: Tuple[int, int]
    detector: DetectorSettings
    surface: Surface
    hull: Optional[Hull]
    simulated: SimulationSettings
    debug_label: Label


CAMERA_SPECS = [
    ParameterSpec(
        'source', 'auto',
        'Where frames come from: auto (the first attached camera, or random pixels where none '
        "is attached), random, a device index or path, a video file, a stream's URL, topic (a "
        "camera driver's image), compressed_topic (its image/compressed), or simulated.",
        fixed=True),
    ParameterSpec('period', 3.0, 'Time between two random pixels, in s.', (0.001, 3600)),
    ParameterSpec(
        'wait_for_subscribers', 1,
        'A video file is not started before this many listen to pos_in_cam_frame, its point, or '
        'objects_in_cam_frame, but 10 s later at the latest.', (0, 100), fixed=True),
    ParameterSpec(
        'wait_for_camera', True,
        'Whether a device or a stream that is not there at the start is waited for; otherwise '
        'the node ends with an error.', fixed=True),
    ParameterSpec(
        'background_frames', 1,
        'The background is the median of this many frames; 1 takes the first one, as the '
        'tutorial does (of a camera, the first one that the next one confirms).', (1, 1000)),
    ParameterSpec(
        'background_file', '',
        'A file (.png) that keeps the background: it is written whenever one is taken, and read '
        'at the start, if it is there. Cameras and topics only; empty for none.', fixed=True),
    ParameterSpec(
        'max_frame_age', 0.3,
        'No position is published from a frame of a camera that is older than this, in s.',
        (0.01, 60)),
    ParameterSpec(
        'confirm_jump_px', 8.0,
        'A position that jumps farther than this, in px, is published when a second frame '
        'confirms it; 0 for at once. Cameras only.', (0, 100000)),
    ParameterSpec(
        'view.max_shift_px', 3.0,
        'Nothing is published while the view has moved by more than this since the background '
        'was taken, in px; 0 for no check.', (0, 100000)),
    ParameterSpec(
        'view.max_changed_share', 0.7,
        "Nor while more than this share of the surface's structure is covered or has changed.",
        (0, 1)),
    ParameterSpec('view.check_period', 2.0, 'Time between two checks of the view, in s.',
                  (0.01, 3600)),
    ParameterSpec(
        'annotated_picture', '',
        'A file (.png or .jpg) that is kept up to date with the frame of the largest object so '
        'far, its box, centre and position drawn; empty for none.', fixed=True),
    ParameterSpec('camera_frame_id', 'camera_surface',
                  "The stamped topics' name for the camera frame, which lies on the surface."),
    ParameterSpec('debug_image.coordinates', 'camera',
                  'In which frame the debug image tells where objects are: camera, or base, by '
                  'rotation_deg and displacement_cm.', constraints='one of camera, base'),
    *PLACEMENT_SPECS,
    ParameterSpec('detector.method', 'precise',
                  "tutorial: the tutorial's result, to the pixel; precise: right to a tenth of a "
                  'pixel, also in changing light.',
                  constraints=f'one of {", ".join(METHODS)}'),
    ParameterSpec('detector.threshold', 95,
                  "tutorial: a pixel whose grey level differs from the background's by more than "
                  'this belongs to an object.', (0, 255)),
    ParameterSpec('detector.closing_size', 20,
                  'tutorial: edge of the square kernel that closes gaps, in px.', (1, 500)),
    ParameterSpec('detector.median_size', 5,
                  "tutorial: edge of the median filter's window, in px, odd.", (1, 99), step=2),
    ParameterSpec('detector.faintest', 13.0,
                  'precise: how faint an object may be: the grey levels by which it must at least '
                  'differ from the surface, in one of the colours. Noise raises it.', (0, 255)),
    ParameterSpec('detector.precise_threshold', -1.0,
                  'precise: the old name of detector.faintest, until the next release; -1 for '
                  'not given.', (-1, 255)),
    ParameterSpec('detector.min_area_cm2', 0.0,
                  'Smaller objects are not published, in cm² on the surface.', (0, 1e6)),
    ParameterSpec('detector.max_area_cm2', 1e6,
                  'Larger objects (a hand) are not published, in cm² on the surface.', (0, 1e6)),
    ParameterSpec('detector.publish_cut_off', False,
                  "precise: whether an object that touches the picture's edge is published; the "
                  'tutorial publishes it.'),
    *SURFACE_SPECS,
    *SIMULATION_SPECS,
]


def camera_settings(values: Values) -> CameraSettings:
    """
    Make the camera node's settings of its parameters.

    :raises CameraToBaseError: If they cannot be used together.
    """
    if not values['source']:
        raise InvalidValueError('source is empty: use auto, random, simulated, a camera or a file')
    hull = make_hull(values)
    if values['annotated_picture']:
        check_picture_path(values['annotated_picture'])
    return CameraSettings(
        source=values['source'],
        period=values['period'],
        wait_for_subscribers=values['wait_for_subscribers'],
        wait_for_camera=values['wait_for_camera'],
        background_frames=values['background_frames'],
        background_file=check_background_path(values['background_file']),
        limits=Limits(
            max_frame_age_s=values['max_frame_age'],
            confirm_jump_px=values['confirm_jump_px'],
            max_shift_px=values['view.max_shift_px'],
            max_changed_share=values['view.max_changed_share'],
            check_period_s=values['view.check_period']),
        annotated_picture=values['annotated_picture'],
        camera_frame_id=frame_id('camera_frame_id', values['camera_frame_id']),
        image_size=check_image_size(values['surface.image_size']),
        detector=DetectorSettings(
            **_group(values, 'detector.'),
            area=hull if values['surface.reject_outside_hull'] else None),
        surface=make_surface(values),
        hull=hull,
        simulated=simulation_settings(**_group(values, 'simulated.')),
        debug_label=_debug_label(values))


def _debug_label(values: Values) -> Label:
    coordinates = values['debug_image.coordinates']
    if coordinates == 'camera':
        return camera_label
    if coordinates == 'base':
        return base_label(transform_settings(values))
    raise InvalidValueError(
        f"debug_image.coordinates must be 'camera' or 'base', got '{coordinates}'")


def _group(values: Values, prefix: str) -> Dict[str, Any]:
    return {name[len(prefix):]: value for name, value in values.items()
            if name.startswith(prefix)}
