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

from dataclasses import asdict, dataclass
from typing import Any, Dict, Optional, Tuple

from camera_to_base.board_conditions import BoardConditions
from camera_to_base.errors import InvalidValueError
from camera_to_base.hull import Hull
from camera_to_base.object_locator import DetectorSettings, METHODS
from camera_to_base.overlay import base_label, camera_label, check_picture_path, Label
from camera_to_base.parameter_spec import ParameterSpec, Values
from camera_to_base.simulated_board import SimulatedBoard
from camera_to_base.surface import check_image_size, ImageSize, Surface
from camera_to_base.surface_parameters import (
    make_hull, make_surface, SURFACE_DEFAULTS, SURFACE_MODELS)
from camera_to_base.transform_parameters import PLACEMENT_SPECS, transform_settings


@dataclass(frozen=True)
class SimulationSettings:
    """How the simulated board is seen, and what kind of day it has."""

    tilt_deg: float
    seed: int
    frame_rate: float
    conditions: BoardConditions

    def board(self, image_size: ImageSize) -> SimulatedBoard:
        """Make the board, for pictures of a size."""
        return SimulatedBoard(
            image_size=image_size, tilt_deg=self.tilt_deg, seed=self.seed,
            frame_rate=self.frame_rate, **asdict(self.conditions))


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
    camera_frame_id: str
    image_size: Tuple[int, int]
    detector: DetectorSettings
    surface: Surface
    hull: Optional[Hull]
    simulated: SimulationSettings
    view: ViewSettings
    debug_label: Label


def _surface_spec(name: str, *description: Any, **more: Any) -> ParameterSpec:
    return ParameterSpec(name, SURFACE_DEFAULTS[name], *description, **more)


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
        'A video file is not started before this many listen to pos_in_cam_frame, but 10 s '
        'later at the latest.', (0, 100), fixed=True),
    ParameterSpec(
        'wait_for_camera', False,
        'Whether a device or a stream that is not there at the start is waited for; otherwise '
        'the node ends with an error.', fixed=True),
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
    ParameterSpec('detector.precise_threshold', 45.0,
                  "precise: as detector.threshold, at the background's light.", (0, 255)),
    ParameterSpec('detector.min_area_cm2', 0.0,
                  'Smaller objects are not published, in cm² on the surface.', (0, 1e6)),
    ParameterSpec('detector.max_area_cm2', 1e6,
                  'Larger objects (a hand) are not published, in cm² on the surface.', (0, 1e6)),
    ParameterSpec('detector.publish_cut_off', False,
                  "precise: whether an object that touches the picture's edge is published; the "
                  'tutorial publishes it.'),
    _surface_spec('surface.model',
                  'How the camera looks at the surface.',
                  constraints=f'one of {", ".join(SURFACE_MODELS)}'),
    _surface_spec('surface.image_size',
                  'Width and height of the pictures that the calibration holds for, in px; a '
                  'camera device is asked for it when it is opened.'),
    _surface_spec('surface.hull',
                  'The area of the picture that the calibration was measured in, for an object '
                  'outside it the node warns: u and v of one corner after the other, in px; '
                  'empty for everywhere.', constraints='numbers, u and v in turn'),
    _surface_spec('surface.reject_outside_hull',
                  'Leave out objects outside surface.hull instead of warning of them.'),
    _surface_spec('surface.parallel.width_cm',
                  "parallel: what the picture's width sees of the surface, in cm.",
                  (0.001, 100000)),
    _surface_spec('surface.polynomial.y_of_v',
                  'polynomial: coefficients of v², v and 1 (v in px), for y in cm.'),
    _surface_spec('surface.polynomial.px_per_cm_of_y',
                  'polynomial: coefficients of y², y and 1 (y in cm), for the scale in px/cm.'),
    _surface_spec('surface.polynomial.centre_u',
                  'polynomial: u of the line x = 0, in px.', (-100000, 100000)),
    _surface_spec('surface.homography.surface_from_pixel',
                  'homography: the 3 x 3 matrix from undistorted px to cm, row by row.'),
    _surface_spec('surface.homography.distortion_coefficient',
                  "homography: the lens's radial distortion; an undistorted pixel lies at "
                  'centre + offset / (1 + coefficient r²), r being the distance to the centre in '
                  "halves of the picture's diagonal; 0 for none.", (-2, 2)),
    _surface_spec('surface.homography.distortion_centre',
                  'homography: the centre of the distortion, u and v, in px.'),
    _surface_spec('surface.camera_height_cm',
                  'How far above the surface the camera is, in cm; 0 for not known.', (0, 100000)),
    _surface_spec('surface.camera_foot_cm',
                  'The point of the surface below the camera, x and y, in cm, in the camera '
                  "frame; empty for not known: parallel then takes what the picture's centre "
                  'looks at.',
                  constraints='x and y, or nothing'),
    _surface_spec('object_height_cm',
                  'How far above the surface the face is whose outline is seen, in cm: the '
                  "object's height, or about 0.6 of it where its sides stand out from the "
                  'surface, too; 0 for flat objects; others need surface.camera_height_cm.',
                  (0, 10000)),
    ParameterSpec('simulated.tilt_deg', 0.0,
                  "simulated: the camera's tilt, 0 looks straight down, in degrees.", (0, 60),
                  fixed=True),
    ParameterSpec('simulated.seed', 0, 'simulated: makes the noise.', (0, 2**31 - 1), fixed=True),
    ParameterSpec('simulated.frame_rate', 10.0, 'simulated: frames per second.', (0.1, 1000),
                  fixed=True),
    ParameterSpec('simulated.noise', 2.0,
                  'simulated: standard deviation of the noise, in grey levels.', (0, 100),
                  fixed=True),
    ParameterSpec('simulated.light_drift', 0.0,
                  'simulated: what the table gains (or loses) in a minute, in grey levels.',
                  (-255, 255), fixed=True),
    ParameterSpec('simulated.exposure_step', 1.0,
                  "simulated: the factor by which the camera's exposure jumps every 15 s.",
                  (0.01, 100), fixed=True),
    ParameterSpec('simulated.shadow', 0.0,
                  'simulated: what a soft shadow takes away, in grey levels.', (0, 255),
                  fixed=True),
    ParameterSpec('simulated.hands', 0,
                  'simulated: how often a hand reaches into the picture in a minute.', (0, 100),
                  fixed=True),
    ParameterSpec('simulated.table_level', 202.0,
                  "simulated: the table's brightness, in grey levels.", (1, 255), fixed=True),
    ParameterSpec('simulated.contrast', 142.0,
                  'simulated: objects are that much darker than the table (lighter, where '
                  'negative), in grey levels.', (-255, 255), fixed=True),
    ParameterSpec('simulated.diameters_cm', [2.4],
                  'simulated: the diameter of each object, in cm.', fixed=True),
    ParameterSpec('simulated.elongation', 1.0,
                  'simulated: objects are ovals that much longer than wide, the diameter being '
                  'their length; 1 for coins.', (1, 10), fixed=True),
    ParameterSpec('simulated.yaw_deg', 0.0,
                  "simulated: the direction of the first oval's length, from x towards y, in "
                  'degrees; each further one is turned by 50 degrees more.', (-180, 180),
                  fixed=True),
    ParameterSpec('simulated.highlight', False,
                  'simulated: whether objects have a spot that looks like the table.', fixed=True),
    ParameterSpec('simulated.texture', 0.0,
                  "simulated: standard deviation of the table's pattern, in grey levels.",
                  (0, 100), fixed=True),
    ParameterSpec('simulated.over_edge', False,
                  "simulated: whether the objects' paths lead beyond the picture's edge.",
                  fixed=True),
    ParameterSpec('simulated.in_first_frame', False,
                  'simulated: whether the objects lie there on the first frame, the background.',
                  fixed=True),
    ParameterSpec('simulated.rests', False,
                  'simulated: whether the objects stop on their way.', fixed=True),
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
        max_frame_age=values['max_frame_age'],
        confirm_jump_px=values['confirm_jump_px'],
        annotated_picture=values['annotated_picture'],
        camera_frame_id=values['camera_frame_id'],
        image_size=check_image_size(values['surface.image_size']),
        detector=DetectorSettings(
            **_group(values, 'detector.'),
            area=hull if values['surface.reject_outside_hull'] else None),
        surface=make_surface(values),
        hull=hull,
        simulated=_simulated(**_group(values, 'simulated.')),
        view=ViewSettings(**_group(values, 'view.')),
        debug_label=_debug_label(values))


def _debug_label(values: Values) -> Label:
    coordinates = values['debug_image.coordinates']
    if coordinates == 'camera':
        return camera_label
    if coordinates == 'base':
        return base_label(transform_settings(values))
    raise InvalidValueError(
        f"debug_image.coordinates must be 'camera' or 'base', got '{coordinates}'")


def _simulated(
    tilt_deg: float, seed: int, frame_rate: float, **conditions
) -> SimulationSettings:
    return SimulationSettings(tilt_deg, seed, frame_rate, BoardConditions(**conditions))


def _group(values: Values, prefix: str) -> Dict[str, Any]:
    return {name[len(prefix):]: value for name, value in values.items()
            if name.startswith(prefix)}
