# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Settings of the nodes: their parameters as frozen values.

In: parameter values by name. Out: the parameter list of `camera_publisher`, the settings of both
nodes, and the source that a name stands for. The parameters of each part are in its own room.

Callers: `nodes`, `commands`, `launching` and the tools that write documentation.
"""

from dataclasses import dataclass
from datetime import datetime
import os
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

from camera_to_base.checks import frame_id, ImageSize
from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from camera_to_base.detection import (
    AREA_SPECS, BACKGROUND_SPECS, DETECTOR_SPECS, DetectorSettings, HEIGHT_SPECS, object_heights,
    read_areas)
from camera_to_base.errors import FrameSourceError, InvalidValueError
from camera_to_base.files import check_background_path
from camera_to_base.markers import MarkedSurface, MARKER_SPECS, paper_corners
from camera_to_base.parameters import (
    all_names, calibration_date, calibration_summary, CAMERA_FRAME_SPEC, checked_values,
    file_warnings, grouped, name_warnings, node_namespaces, OWN_CAMERA_SPECS, ParameterSpec,
    PLACEMENT_SPECS, read_node_parameters, read_sections, RECORD_SPECS, transform_node_settings,
    transform_settings, TRANSFORM_SPECS, TransformSettings, Values, with_new_names)
from camera_to_base.pipeline import (
    CameraPipeline, DamageCheck, LIMIT_SPECS, Limits, make_limits, MarkerSettings, OwnCamera)
from camera_to_base.simulation import simulation_settings, SIMULATION_SPECS, SimulationSettings
from camera_to_base.sources import (
    AUTO, BAG, Camera, COMPRESSED_TOPIC, DEVICE, first_camera, FirstCamera, FrameSource, kind_of,
    open_frame_source, open_repeated, RANDOM, SIMULATED, SourceKind, STREAM, TOPIC)
from camera_to_base.surface import (
    Hull, make_hull, make_surface, read_thumbnail, Surface, SURFACE_SPECS)
from camera_to_base.uncertainty import position_uncertainty, PositionUncertainty, UNCERTAINTY_SPECS

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
    *PLACEMENT_SPECS, *AREA_SPECS, *DETECTOR_SPECS, *HEIGHT_SPECS, *SURFACE_SPECS,
    *UNCERTAINTY_SPECS, *MARKER_SPECS, *SIMULATION_SPECS, *RECORD_SPECS, *OWN_CAMERA_SPECS]

# Parameters that can be set without setting up a camera or a robot.
_NOT_OF_A_SETUP = (
    'source', 'period', 'wait_for_subscribers', 'wait_for_camera', 'repeat',
    'background_file', 'camera_frame_id', 'debug_image.coordinates')
_NOT_OF_A_CALIBRATION = (
    'surface.image_size', 'surface.reject_outside_hull', 'surface.covariance')

_CAMERA_NODE, _TRANSFORM_NODE = 'camera_publisher', 'robot_base_publisher'
_SPECS = {_CAMERA_NODE: CAMERA_SPECS, _TRANSFORM_NODE: TRANSFORM_SPECS}


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

    :param label_conversion: To the coordinates of labels on pictures; None for the camera frame's.
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
    label_conversion: Optional[CameraToRobotBaseConversion]
    calibrated_for: CalibratedFor
    markers: Optional[MarkerSettings]
    is_configured: bool
    is_calibrated: bool

    @property
    def warnings(self) -> List[str]:
        """Sentences about parameters that were set but have no effect."""
        warnings = [f'detector.{name} has no effect with detector.method {self.detector.method}'
                    for name in self.detector.without_effect]
        if self.detector.heights_cm and self.surface.pinhole is None:
            warnings.append(
                "object_height_cm is the objects' whole height: change a file in which it is 0.6 "
                'of it, as this package once advised')
        return warnings

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
            self.surface, self.detector if kind.is_live else self.detector.without_budget,
            self.limits,
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
        areas = areas.without(map(paper_corners, marked.corners.values()))
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
            area=hull if values['surface.reject_outside_hull'] else None, areas=areas,
            heights_cm=object_heights(values, surface),
            flat_middle_cm=values['flat_middle_cm']),
        surface=surface,
        hull=hull,
        uncertainty=position_uncertainty(values, surface),
        simulated=_simulation(values),
        label_conversion=_label_conversion(values),
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


def _label_conversion(values: Values) -> Optional[CameraToRobotBaseConversion]:
    return None if values['debug_image.coordinates'] == 'camera' else transform_settings(values)


class NamedSource(NamedTuple):
    """
    The source that a name stands for.

    :param name: Its name in messages; for auto, the device that was found.
    :param frames: None if the node itself makes the input: topics and random pixels.
    """

    name: str
    kind: SourceKind
    frames: Optional[FrameSource] = None


def open_named_source(settings: CameraSettings, may_be_random: bool) -> NamedSource:
    """
    Open the source that a camera node's parameter `source` names.

    A named camera is opened by its first read.

    :param may_be_random: Whether auto means random pixels if no camera is attached; otherwise the
        source waits for a camera.
    :raises FrameSourceError: If it names a file that holds no video, or a bag.
    """
    name, kind = settings.source, kind_of(settings.source)
    if kind == AUTO:
        camera = first_camera(settings.image_size)
        if camera is None and may_be_random:
            return NamedSource(name, RANDOM)
        frames = camera or FirstCamera(settings.image_size)
        return NamedSource(frames.name, frames.kind, frames)
    if kind in (RANDOM, TOPIC, COMPRESSED_TOPIC):
        return NamedSource(name, kind)
    if kind == BAG and os.path.exists(os.path.expanduser(name)):
        raise FrameSourceError(
            f"source '{name}' is no video; if it is a bag, `ros2 run camera_to_base locate {name}`"
            ' reads it, or play it (`ros2 bag play`) and name its image topic')
    if kind == SIMULATED:
        frames = settings.simulated.board(settings.image_size)
    elif kind in (DEVICE, STREAM):
        frames = Camera(name, settings.image_size, open_now=False)
    elif settings.repeat:
        frames = open_repeated(os.path.expanduser(name))
    else:
        frames = open_frame_source(name)
    return NamedSource(name, frames.kind, frames)


class NodeSettings(NamedTuple):
    """
    The settings of both nodes.

    :param warnings: Sentences about names that no parameter has.
    """

    camera: CameraSettings
    transform: TransformSettings
    warnings: List[str]


def read_node_settings(path: Optional[str], namespace: Optional[str] = None) -> NodeSettings:
    """
    Read the settings that both nodes would have with a parameter file.

    :param path: The file; None for the defaults.
    :param namespace: The nodes' namespace; None for the one that the file names, if any.
    :raises CameraToBaseError: If there is no such file, or a value cannot be used.
    """
    values, warnings = {}, []
    for node, specs in _SPECS.items():
        given, told = _given(path, namespace, node) if path is not None else ({}, [])
        values[node] = checked_values(specs, given)
        warnings += [warning for warning in told if warning not in warnings]
    return NodeSettings(camera_settings(values[_CAMERA_NODE]),
                        transform_node_settings(values[_TRANSFORM_NODE]), warnings)


def _given(path: str, namespace: Optional[str], node: str) -> Tuple[Dict[str, Any], List[str]]:
    name = f'{_namespace(path, namespace)}/{node}'
    given, old_names = with_new_names(_SPECS[node], read_node_parameters(path, name))
    known = [name for specs in _SPECS.values() for name in all_names(specs)]
    return given, [*file_warnings(path, name), *old_names, *name_warnings(given, known)]


def _namespace(path: str, wanted: Optional[str]) -> str:
    found = node_namespaces(path, _SPECS)
    if wanted is not None:
        name = f'/{wanted.strip("/")}'.rstrip('/')
        if not any(section.stands_for(f'{name}/{node}')
                   for section in read_sections(path) for node in _SPECS):
            raise InvalidValueError(
                f"'{path}' has no parameters for nodes in the namespace '{wanted}', but for those "
                f'in {", ".join(name or "/" for name in found) or "none"}: choose one of these')
        return name
    if len(found) > 1:
        raise InvalidValueError(
            f"'{path}' has parameters for nodes in several namespaces: choose one with "
            f'--namespace: {", ".join(name or "/" for name in found)}')
    return found[0] if found else ''
