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

"""Declares and checks the nodes' parameters; hands out frozen values."""

from dataclasses import dataclass
from typing import Any, Callable, Dict, Generic, List, Mapping, Optional, Tuple, TypeVar

from rcl_interfaces.msg import (
    FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult)
from rclpy.node import Node
from rclpy.parameter import Parameter

from camera_to_base.absolute_difference import AbsoluteDifferenceDetector
from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.overlay import check_picture_path
from camera_to_base.surface import (
    check_image_size, HomographySurface, ParallelSurface, PolynomialSurface, Surface)

T = TypeVar('T')
Values = Mapping[str, Any]


@dataclass(frozen=True)
class ParameterSpec:
    """
    One parameter, as `ros2 param describe` shows it.

    :param limits: Lowest and highest number, both allowed.
    :param step: Distance of allowed whole numbers; 0 allows all.
    :param constraints: What else must hold, in words.
    :param fixed: Cannot be changed while the node runs.
    """

    name: str
    default: Any
    description: str
    limits: Optional[Tuple[float, float]] = None
    step: int = 0
    constraints: str = ''
    fixed: bool = False

    def descriptor(self) -> ParameterDescriptor:
        """Make the descriptor that ROS shows and checks."""
        descriptor = ParameterDescriptor(
            description=self.description, additional_constraints=self.constraints,
            read_only=self.fixed)
        if self.limits and isinstance(self.default, int):
            descriptor.integer_range = [IntegerRange(
                from_value=self.limits[0], to_value=self.limits[1], step=self.step)]
        elif self.limits:
            descriptor.floating_point_range = [FloatingPointRange(
                from_value=float(self.limits[0]), to_value=float(self.limits[1]))]
        return descriptor

    def converted(self, value: Any) -> Any:
        """Make a double of an int and a text of a device index, as a user would expect."""
        if isinstance(self.default, str) and type(value) is int:
            return str(value)
        if isinstance(self.default, float) and type(value) is int:
            return float(value)
        if _is_list_of(self.default, float) and _is_list_of(value, int):
            return [float(number) for number in value]
        return value


class NodeParameters(Generic[T]):
    """
    A node's parameters as one frozen value that is replaced as a whole.

    :param node: The node that declares them.
    :param specs: What to declare.
    :param build: Makes the frozen value of the parameters' values, or raises CameraToBaseError.
    :param on_change: Called after the frozen value was replaced at run time.
    :raises CameraToBaseError: If the values at start cannot be used.
    :raises rclpy.exceptions.ParameterException: If one has the wrong type or is out of range.
    """

    def __init__(
        self,
        node: Node,
        specs: List[ParameterSpec],
        build: Callable[[Values], T],
        on_change: Callable[[], None] = lambda: None,
    ) -> None:
        self._specs = {spec.name: spec for spec in specs}
        self._build = build
        self._on_change = on_change
        self._values: Dict[str, Any] = {spec.name: _declare(node, spec) for spec in specs}
        self.current: T = build(self._values)
        self._next: Tuple[Dict[str, Any], T] = self._values, self.current
        node.add_pre_set_parameters_callback(self._convert)
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._replace)

    def _convert(self, parameters: List[Parameter]) -> List[Parameter]:
        return [Parameter(parameter.name, value=self._specs[parameter.name].converted(
                    parameter.value)) if parameter.name in self._specs else parameter
                for parameter in parameters]

    def _check(self, parameters: List[Parameter]) -> SetParametersResult:
        values = {**self._values, **{parameter.name: parameter.value for parameter in parameters
                                     if parameter.name in self._specs}}
        try:
            self._next = values, self._build(values)
        except CameraToBaseError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _replace(self, parameters: List[Parameter]) -> None:
        if any(parameter.name in self._specs for parameter in parameters):
            self._values, self.current = self._next
            self._on_change()


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
class CameraSettings:
    """All that `camera_publisher` takes from its parameters."""

    source: str
    period: float
    annotated_picture: str
    image_size: Tuple[int, int]
    detector: DetectorSettings
    surface: Surface
    simulated: SimulationSettings


_MODELS = ('parallel', 'polynomial', 'homography')

CAMERA_SPECS = [
    ParameterSpec(
        'source', 'auto',
        'Where frames come from: auto (the first attached camera, or random pixels where none '
        'is attached), random, a device index or path, a video file, a stream\'s URL, or '
        'simulated.', fixed=True),
    ParameterSpec('period', 3.0, 'Time between two random pixels, in s.', (0.001, 3600)),
    ParameterSpec(
        'annotated_picture', '',
        'A file (.png or .jpg) that is kept up to date with the frame of the largest object so '
        'far, its box, centre and position drawn; empty for none.', fixed=True),
    ParameterSpec('detector.threshold', 95,
                  'A pixel whose grey level differs from the background\'s by more than this '
                  'belongs to an object.', (0, 255)),
    ParameterSpec('detector.closing_size', 20,
                  'Edge of the square kernel that closes gaps, in px.', (1, 500)),
    ParameterSpec('detector.median_size', 5,
                  'Edge of the median filter\'s window, in px, odd.', (1, 99), step=2),
    ParameterSpec('surface.model', 'parallel',
                  'How the camera looks at the surface.',
                  constraints=f'one of {", ".join(_MODELS)}'),
    ParameterSpec('surface.image_size', [640, 480],
                  'Width and height of the pictures that the calibration holds for, in px; a '
                  'camera device is asked for it when it is opened.'),
    ParameterSpec('surface.parallel.width_cm', 36.0,
                  'parallel: what the picture\'s width sees of the surface, in cm.',
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
                  'simulated: the camera\'s tilt, 0 looks straight down, in degrees.', (0, 60),
                  fixed=True),
    ParameterSpec('simulated.noise', 2.0,
                  'simulated: standard deviation of the noise, in grey levels.', (0, 100),
                  fixed=True),
    ParameterSpec('simulated.seed', 0, 'simulated: makes the noise.', (0, 2**31 - 1), fixed=True),
    ParameterSpec('simulated.frame_rate', 10.0, 'simulated: frames per second.', (0.1, 1000),
                  fixed=True),
]

TRANSFORM_SPECS = [
    ParameterSpec('rotation_deg', [180.0, 0.0, 0.0],
                  'Rotation of the camera frame in the base frame: roll, pitch and yaw about the '
                  'fixed axes x, y and z, in degrees.'),
    ParameterSpec('displacement_cm', [-17.8, 24.4, 0.0],
                  'The camera frame\'s origin in the base frame: x, y and z, in cm.'),
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
        annotated_picture=values['annotated_picture'],
        image_size=check_image_size(values['surface.image_size']),
        detector=DetectorSettings(**_group(values, 'detector.')),
        surface=_surface(values),
        simulated=SimulationSettings(**_group(values, 'simulated.')))
    detector = settings.detector
    AbsoluteDifferenceDetector.check_parameters(
        detector.threshold, detector.closing_size, detector.median_size)
    return settings


def transform_settings(values: Values) -> CameraToRobotBaseConversion:
    """
    Make the transform node's conversion of its parameters.

    :raises CameraToBaseError: If either is not three finite numbers.
    """
    return CameraToRobotBaseConversion.from_roll_pitch_yaw(
        values['rotation_deg'], values['displacement_cm'])


def _surface(values: Values) -> Surface:
    model = values['surface.model']
    image_size = check_image_size(values['surface.image_size'])
    if model == 'parallel':
        return ParallelSurface(values['surface.parallel.width_cm'], image_size[0])
    if model == 'polynomial':
        return PolynomialSurface(**_group(values, 'surface.polynomial.'), image_size=image_size)
    if model == 'homography':
        return HomographySurface(values['surface.homography.surface_from_pixel'], image_size)
    raise InvalidValueError(f'surface.model must be one of {", ".join(_MODELS)}, got \'{model}\'')


def _group(values: Values, prefix: str) -> Dict[str, Any]:
    return {name[len(prefix):]: value for name, value in values.items()
            if name.startswith(prefix)}


def _declare(node: Node, spec: ParameterSpec) -> Any:
    # rclpy refuses an int where a double is declared. So an override is first read whatever its
    # type is, and the parameter is then declared with the converted value.
    anything = ParameterDescriptor(dynamic_typing=True)
    value = spec.converted(node.declare_parameter(spec.name, spec.default, anything).value)
    node.undeclare_parameter(spec.name)
    if _type_of(value) != _type_of(spec.default):
        raise InvalidValueError(
            f'parameter {spec.name} must be of type {_type_of(spec.default).name}, '
            f'got {value!r} of type {_type_of(value).name}')
    return node.declare_parameter(
        spec.name, value, spec.descriptor(), ignore_override=True).value


def _type_of(value: Any) -> Parameter.Type:
    return Parameter.Type.from_parameter_value(value)


def _is_list_of(value: Any, kind: type) -> bool:
    return hasattr(value, '__len__') and not isinstance(value, str) and len(value) > 0 and all(
        type(item) is kind for item in value)
