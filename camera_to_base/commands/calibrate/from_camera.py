# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""`calibrate base --from`: the base frame of a camera from another one that has it."""

import argparse
from pathlib import Path
from typing import Any, List, Optional

from camera_to_base.calibration import (
    BASE, calibrate_base, Calibration, FRAMES, point_pairs, Report, resting_places, shared_places,
    SharedPlace, SURFACE)
from camera_to_base.commands.calibrate.files import base_outputs, write_part
from camera_to_base.commands.calibrate.prompts import ask, tell, until_it_fits, until_right
from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.parameters import read_parameter_file
from camera_to_base.settings import read_node_settings
from camera_to_base.surface import towards_camera

# With fewer, a bad one is not told from the others.
_FEWEST_PLACES = 5
_IN_CAMERA, _IN_BASE = 'objects_in_cam_frame', 'objects_in_robot_base_frame'


def run_base_from(options: argparse.Namespace) -> Report:
    """Calibrate the base frame by what another camera sees, too, and write the file."""
    outputs = base_outputs(options, '--live', SURFACE, {
        'a table': options.table, '--surface': options.surface, '--camera': options.camera,
        '--robot-topic': options.robot_topic})
    if options.places < _FEWEST_PLACES:
        raise InvalidValueError(
            f'--places must be {_FEWEST_PLACES} or more with --from, got {options.places}')
    listeners: List[Any] = []
    try:
        listeners.append(_own(options.live, options.namespace))
        listeners.append(_other(options.other))
        # Up is the side of the table on which the camera is.
        is_up = towards_camera(read_node_settings(options.live).camera.surface) > 0
        objects = _SharedObjects(*listeners, options.places, is_up != (options.base_z == 'up'))
        return write_part(objects.calibrated(outputs.old.values, options.base_z), outputs, BASE)
    finally:
        for listener in listeners:
            listener.close()


class _SharedObjects:
    """
    Objects that two running cameras see.

    :param own: Listens to the camera that is calibrated.
    :param other: Listens to the other one, in the base frame.
    :param count: How many are needed.
    :param is_mirrored: See `shared_places`.
    """

    def __init__(self, own: Any, other: Any, count: int, is_mirrored: bool) -> None:
        self._own, self._other, self._count = own, other, count
        self._is_mirrored = is_mirrored
        self._places: List[SharedPlace] = []

    def calibrated(self, surface_values: Any, base_z: str) -> Calibration:
        """Ask for objects until there are enough, and fit the base frame to them."""
        tell(f'Positions come from the running nodes, topics {self._own.topic} and '
             f'{self._other.topic}.')
        self._collect()
        return until_it_fits(
            lambda: calibrate_base(
                point_pairs(self._places), base_z=base_z, surface_values=surface_values,
                source=f'objects on {self._other.topic}', points_are='place'),
            'places', 'a place to leave it out', range(1, len(self._places) + 1), self._leave_out)

    def _collect(self) -> None:
        tell(f'Lay {self._count} flat objects or more where both cameras see them, far apart and '
             'in no pattern.')
        while len(self._places) < self._count:
            ask('Take your hands and the robot out of the pictures, and press Enter:')
            found = until_right(self._look, 'Press Enter to look again, q to stop:')
            self._places += found
            for number, place in enumerate(self._places, start=1):
                if place in found:
                    tell('  {}: at ({:.2f}, {:.2f}) cm in the camera frame, ({:.2f}, {:.2f}) cm '
                         'in the base frame'.format(
                             number, *place.camera_point, *place.base_point))
            if len(self._places) < self._count:
                tell(f'{len(self._places)} of {self._count} places: lay objects elsewhere.')

    def _look(self) -> List[SharedPlace]:
        return shared_places(
            resting_places(self._own.frames(FRAMES)), resting_places(self._other.frames(FRAMES)),
            self._is_mirrored, self._places)

    def _leave_out(self, number: int) -> None:
        if number <= len(self._places):
            del self._places[number - 1]
            self._collect()


def _listener(namespace: str, topic: str) -> Any:
    try:
        from camera_to_base.ros import ObjectListener
    except ModuleNotFoundError as error:
        raise InvalidValueError(
            '--from needs ROS 2: source /opt/ros/jazzy/setup.bash') from error
    return ObjectListener(namespace, topic)


def _own(path: str, namespace: Optional[str]) -> Any:
    """Listen to the camera of a file: in the namespace named after it, as launched, or in none."""
    name = Path(path).stem
    tried = ([name] * name.isidentifier() + ['']) if namespace is None else [namespace]
    for name in [*tried, *tried]:  # A busy machine may need more time to find it.
        listener = _listener(name, _IN_CAMERA)
        if listener.is_node_running():
            listener.check_same_surface(read_parameter_file(path).values, path, may_move=True)
            return listener
        listener.close()
    raise CalibrationError(
        f'no camera_publisher is running with {path}: start it, and name its namespace with '
        '--namespace')


def _other(namespace: str) -> Any:
    listener = _listener(namespace, _IN_BASE)
    if listener.is_node_running():
        return listener
    listener.close()
    raise CalibrationError(
        f'nobody publishes {listener.topic}: start both nodes of {namespace}, or name the '
        'namespace of another camera with --from')
