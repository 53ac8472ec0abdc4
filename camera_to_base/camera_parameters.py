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
from typing import Any, Dict, Tuple

from camera_to_base.absolute_difference import AbsoluteDifferenceDetector
from camera_to_base.checks import finite_numbers
from camera_to_base.errors import InvalidValueError
from camera_to_base.overlay import check_picture_path
from camera_to_base.parameters import ParameterSpec, Values
from camera_to_base.surface import (
    check_image_size, HomographySurface, ParallelSurface, PolynomialSurface, Surface)
import numpy as np


@dataclass(frozen=True)
class DetectorSettings:
    """The detector's parameters, see :class:`AbsoluteDifferenceDetector`."""

    threshold: int
    closing_size: int
    median_size: int


@dataclass(frozen=True)
class SimulationSettings:
    """The simulated board's parameters, see :class:`SimulatedBoard`."""

    tilt_deg: float
    noise: float
    seed: int
    frame_rate: float


@dataclass(frozen=True)
class ViewSettings:
    """When a camera counts as moved, see :func:`view_problem`."""

    max_shift_px: float
    max_changed_share: float
    check_period: float


@dataclass(frozen=True)
class CameraSettings:
    """All that `camera_publisher` takes from its parameters."""

    source: str
    period: float
    wait_for_subscribers: int
    wait_for_camera: bool
    background_frames: int
    max_frame_age: float
    confirm_jump_px: float
    annotated_picture: str
    image_size: Tuple[int, int]
    detector: DetectorSettings
    surface: Surface
    simulated: SimulationSettings
    view: ViewSettings


_MODELS = ('parallel', 'polynomial', 'homography')

CAMERA_SPECS = [
    ParameterSpec(
        'source', 'auto',
        'Where frames come from: auto (the first attached camera, or random pixels where none '
        "is attached), random, a device index or path, a video file, a stream's URL, or "
        'simulated.', fixed=True),
    ParameterSpec('period', 3.0, 'Time between two random pixels, in s.', (0.001, 3600)),
    ParameterSpec(
        'wait_for_subscribers', 1,
        'A video file is not started before this many listen to pos_in_cam_frame, but 10 s '
        'later at the latest.', (0, 100), fixed=True),
    ParameterSpec(
        'wait_for_camera', True,
        'A device or a stream that is not there yet is waited for; otherwise the node ends with '
        'an error.', fixed=True),
    ParameterSpec(
        'background_frames', 1,
        'The background is the median of this many frames; 1 takes the first one, as the '
        'tutorial does.', (1, 1000)),
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
        'Nor while the shift cannot be told and more than this share of the view differs.',
        (0, 1)),
    ParameterSpec('view.check_period', 2.0, 'Time between two checks of the view, in s.',
                  (0.01, 3600)),
    ParameterSpec(
        'annotated_picture', '',
        'A file (.png or .jpg) that is kept up to date with the frame of the largest object so '
        'far, its box, centre and position drawn; empty for none.', fixed=True),
    ParameterSpec('detector.threshold', 95,
                  "A pixel whose grey level differs from the background's by more than this "
                  'belongs to an object.', (0, 255)),
    ParameterSpec('detector.closing_size', 20,
                  'Edge of the square kernel that closes gaps, in px.', (1, 500)),
    ParameterSpec('detector.median_size', 5,
                  "Edge of the median filter's window, in px, odd.", (1, 99), step=2),
    ParameterSpec('surface.model', 'parallel',
                  'How the camera looks at the surface.',
                  constraints=f'one of {", ".join(_MODELS)}'),
    ParameterSpec('surface.image_size', [640, 480],
                  'Width and height of the pictures that the calibration holds for, in px; a '
                  'camera device is asked for it when it is opened.'),
    ParameterSpec('surface.parallel.width_cm', 36.0,
                  "parallel: what the picture's width sees of the surface, in cm.",
                  (0.001, 100000)),
    ParameterSpec('surface.polynomial.y_of_v', [0.00006, -0.0833, 25.848],
                  'polynomial: coefficients of v², v and 1 (v in px), for y in cm.'),
    ParameterSpec('surface.polynomial.px_per_cm_of_y', [0.0625, -1.6393, 29.071],
                  'polynomial: coefficients of y², y and 1 (y in cm), for the scale in px/cm.'),
    ParameterSpec('surface.polynomial.centre_u', 292.0,
                  'polynomial: u of the line x = 0, in px.', (-100000, 100000)),
    ParameterSpec('surface.homography.surface_from_pixel',
                  [0.05625, 0.0, 0.0, 0.0, 0.05625, 0.0, 0.0, 0.0, 1.0],
                  'homography: the 3 x 3 matrix from px to cm, row by row.'),
    ParameterSpec('simulated.tilt_deg', 0.0,
                  "simulated: the camera's tilt, 0 looks straight down, in degrees.", (0, 60),
                  fixed=True),
    ParameterSpec('simulated.noise', 2.0,
                  'simulated: standard deviation of the noise, in grey levels.', (0, 100),
                  fixed=True),
    ParameterSpec('simulated.seed', 0, 'simulated: makes the noise.', (0, 2**31 - 1), fixed=True),
    ParameterSpec('simulated.frame_rate', 10.0, 'simulated: frames per second.', (0.1, 1000),
                  fixed=True),
]


def camera_settings(values: Values) -> CameraSettings:
    """
    Make the camera node's settings of its parameters.

    :raises CameraToBaseError: If they cannot be used together.
    """
    if not values['source']:
        raise InvalidValueError('source is empty: use auto, random, simulated, a camera or a file')
    if values['annotated_picture']:
        check_picture_path(values['annotated_picture'])
    settings = CameraSettings(
        source=values['source'],
        period=values['period'],
        wait_for_subscribers=values['wait_for_subscribers'],
        wait_for_camera=values['wait_for_camera'],
        background_frames=values['background_frames'],
        max_frame_age=values['max_frame_age'],
        confirm_jump_px=values['confirm_jump_px'],
        annotated_picture=values['annotated_picture'],
        image_size=check_image_size(values['surface.image_size']),
        detector=DetectorSettings(**_group(values, 'detector.')),
        surface=_surface(values),
        simulated=SimulationSettings(**_group(values, 'simulated.')),
        view=ViewSettings(**_group(values, 'view.')))
    detector = settings.detector
    AbsoluteDifferenceDetector.check_parameters(
        detector.threshold, detector.closing_size, detector.median_size)
    return settings


def _surface(values: Values) -> Surface:
    model = values['surface.model']
    image_size = check_image_size(values['surface.image_size'])
    if model == 'parallel':
        return ParallelSurface(values['surface.parallel.width_cm'], image_size[0])
    if model == 'polynomial':
        return PolynomialSurface(**_group(values, 'surface.polynomial.'), image_size=image_size)
    if model == 'homography':
        return HomographySurface(
            _matrix('surface.homography.surface_from_pixel', values), image_size)
    raise InvalidValueError(f'surface.model must be one of {", ".join(_MODELS)}, got \'{model}\'')


def _matrix(name: str, values: Values) -> np.ndarray:
    return finite_numbers(name, values[name], 9).reshape(3, 3)


def _group(values: Values, prefix: str) -> Dict[str, Any]:
    return {name[len(prefix):]: value for name, value in values.items()
            if name.startswith(prefix)}
