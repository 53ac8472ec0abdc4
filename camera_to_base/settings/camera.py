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

"""The settings of `camera_publisher`, made from its parameters."""

from dataclasses import dataclass
from datetime import datetime
from typing import List, NamedTuple, Optional

from camera_to_base.checks import frame_id
from camera_to_base.detection import DetectorSettings, read_areas
from camera_to_base.drawing import (
    AreaOverlay, base_label, camera_label, check_background_path, Label)
from camera_to_base.errors import InvalidValueError
from camera_to_base.image_size import ImageSize
from camera_to_base.markers import MarkedSurface
from camera_to_base.parameters import (
    calibration_date, calibration_summary, grouped, transform_settings, Values)
from camera_to_base.settings.camera_specs import CAMERA_SPECS
from camera_to_base.simulation import simulation_settings, SimulationSettings
from camera_to_base.sources import kind_of, SIMULATED, SourceKind
from camera_to_base.surface import Hull, make_hull, make_surface, Surface
from camera_to_base.trust import (
    CameraPipeline, DamageCheck, Limits, make_limits, MarkerSettings, OwnCamera, read_thumbnail)
from camera_to_base.uncertainty import position_uncertainty, PositionUncertainty

# Parameters that can be set without setting up a camera or a robot.
_NOT_OF_A_SETUP = (
    'source', 'period', 'wait_for_subscribers', 'wait_for_camera', 'repeat',
    'background_file', 'camera_frame_id', 'debug_image.coordinates')
_NOT_OF_A_CALIBRATION = (
    'surface.image_size', 'surface.reject_outside_hull', 'surface.covariance')


class CalibratedFor(NamedTuple):
    """
    The camera that the surface was calibrated with.

    :param device: Its lasting name; '' if it is not known.
    :param thumbnail: Its view, see `view_thumbnail`; '' if it is not known.
    :param date: When; None if it is not known.
    :param is_strict: Whether to publish nothing with another camera or view.
    :param summary: What the parameters hold of the calibration, in one line.
    """

    device: str
    thumbnail: str
    date: Optional[datetime]
    is_strict: bool
    summary: str

    def own_camera(self, source: str) -> OwnCamera:
        """
        Make the check that it is the camera in use.

        :param source: Name of the source in use.
        """
        return OwnCamera(source, self.device, read_thumbnail(self.thumbnail), self.is_strict)


@dataclass(frozen=True)
class CameraSettings:
    """
    The settings of `camera_publisher`.

    :param is_configured: Whether a parameter of the set-up differs from its default, so that an
        arm may follow the positions.
    :param is_calibrated: Whether a calibration of the surface is on record, or the surface differs
        from its default, the tutorial's.
    """

    source: str
    period: float
    wait_for_subscribers: int
    wait_for_camera: bool
    repeat: bool
    background_frames: int
    background_file: str
    limits: Limits
    camera_frame_id: str
    image_size: ImageSize
    detector: DetectorSettings
    surface: Surface
    hull: Optional[Hull]
    uncertainty: PositionUncertainty
    simulated: SimulationSettings
    debug_label: Label
    area_overlay: AreaOverlay
    calibrated_for: CalibratedFor
    markers: Optional[MarkerSettings]
    is_configured: bool
    is_calibrated: bool

    @property
    def warnings(self) -> List[str]:
        """Sentences about parameters that were set but have no effect."""
        return [f'detector.{name} has no effect with detector.method {self.detector.method}'
                for name in self.detector.without_effect]

    def pipeline(
        self, source: str, kind: SourceKind, background_frames: Optional[int] = None,
        damage: Optional[DamageCheck] = None,
    ) -> CameraPipeline:
        """
        Make the pipeline of a source: the same one for the node, the commands and `Cell`.

        :param source: The source's name.
        :param background_frames: None for as many as the parameter says.
        :param damage: None where a reader finds damaged frames, and for recordings.
        """
        return CameraPipeline(
            self.surface, self.detector, self.limits,
            self.background_frames if background_frames is None else background_frames, kind,
            self.markers, self.calibrated_for.own_camera(source), damage)


def camera_settings(values: Values) -> CameraSettings:
    """
    Make the camera node's settings from its parameters.

    :param values: By full name, each as its spec allows it.
    :raises CameraToBaseError: If they cannot be used together.
    """
    if not values['source']:
        raise InvalidValueError('source is empty: use auto, random, simulated, a camera or a file')
    hull, surface = make_hull(values), make_surface(values)
    areas = read_areas(values['work_area'], values['ignored_areas'])
    marked = MarkedSurface.of(values)
    if marked is not None:
        areas = areas.without_markers(list(marked.corners.values()))
    return CameraSettings(
        source=values['source'],
        period=values['period'],
        wait_for_subscribers=values['wait_for_subscribers'],
        wait_for_camera=values['wait_for_camera'],
        repeat=values['repeat'],
        background_frames=values['background_frames'],
        background_file=check_background_path(values['background_file']),
        limits=make_limits(values),
        camera_frame_id=frame_id('camera_frame_id', values['camera_frame_id']),
        image_size=tuple(values['surface.image_size']),
        detector=DetectorSettings(
            **grouped(values, 'detector.'),
            area=hull if values['surface.reject_outside_hull'] else None, areas=areas),
        surface=surface,
        hull=hull,
        uncertainty=position_uncertainty(values, surface),
        simulated=_simulation(values),
        debug_label=_debug_label(values),
        area_overlay=AreaOverlay(surface, areas),
        calibrated_for=_calibrated_for(values),
        markers=None if marked is None else MarkerSettings(
            marked, values['background_retake'] == 'auto', values['background_frames']),
        is_configured=any(name not in _NOT_OF_A_SETUP for name in _other_than_default(values)),
        is_calibrated=bool(values['calibration.surface']) or any(
            name.startswith('surface.') and name not in _NOT_OF_A_CALIBRATION
            for name in _other_than_default(values)))


def _simulation(values: Values) -> SimulationSettings:
    settings = simulation_settings(grouped(values, 'simulated.'))
    if kind_of(values['source']) == SIMULATED:
        settings.check_scene(tuple(values['surface.image_size']))
    return settings


def _calibrated_for(values: Values) -> CalibratedFor:
    thumbnail = values['calibration.thumbnail']
    read_thumbnail(thumbnail)  # refuses what is none
    return CalibratedFor(
        values['calibration.device'], thumbnail, calibration_date(values),
        values['calibration.strict'], calibration_summary(values))


def _other_than_default(values: Values) -> List[str]:
    return [spec.name for spec in CAMERA_SPECS if values[spec.name] != spec.default]


def _debug_label(values: Values) -> Label:
    if values['debug_image.coordinates'] == 'camera':
        return camera_label
    return base_label(transform_settings(values))
