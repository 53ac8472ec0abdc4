# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Pairs for `calibrate base --live`: seen by a node or a camera, touched by a robot."""

from dataclasses import replace
from datetime import datetime
from itertools import islice
import os
from typing import Any, Iterator, List, Optional, Protocol, Sequence, Tuple

from camera_to_base.calibration import (
    FRAMES, measured_place, pairs_text, read_kept_pairs, read_typed_position, same_touch,
    suggested_places, Suggestion, TouchedPair)
from camera_to_base.commands.calibrate.live_camera import CameraPositions, SimulatedPositions
from camera_to_base.commands.calibrate.prompts import ask, ask_for_object, tell, until_right
from camera_to_base.errors import InputEndedError, InvalidValueError
from camera_to_base.files import refuse_same_file, regular_target, write_files
from camera_to_base.parameters import read_parameter_file
from camera_to_base.settings import CameraSettings, open_named_source, read_node_settings
from camera_to_base.sources import kind_of, SIMULATED

_TOUCH = '  Touch its middle with the robot, and'


class Positions(Protocol):
    """
    Sees the objects on the surface.

    `name` says where positions come from. `thumbnail` is the view of the empty surface, for the
    parameter; '' if it is not known.
    """

    name: str
    thumbnail: str

    def prepare(self) -> None:
        """Ask for what is needed before the first object."""

    def suggestions(self) -> Iterator[Suggestion]:
        """Suggest places, one after the other."""

    def see(self, suggestion: Suggestion) -> List[List[Tuple[float, float]]]:
        """Ask for an object, and return the positions of all objects of each frame, in cm."""

    def robot_hint(self) -> str:
        """Return what a simulated robot's display shows; '' for a real one."""

    def close(self) -> None:
        """Release the source."""


class Robot(Protocol):
    """Tells where the robot is that touches the object."""

    def touch(self) -> Tuple[float, float]:
        """Ask for the touch, and return x and y, in cm, in the base frame."""

    def close(self) -> None:
        """Release what it listens with."""


class TypedRobot:
    """A robot whose position a person types."""

    def touch(self) -> Tuple[float, float]:
        """Ask for the touch, see :class:`Robot`."""
        while True:
            try:
                return read_typed_position(ask(
                    f'{_TOUCH} type x and y as its display shows them, in cm, or with mm or m '
                    'behind:'))
            except InputEndedError:
                raise
            except InvalidValueError as error:
                tell(f'  {error}')

    def close(self) -> None:
        """Do nothing."""


class TopicRobot:
    """
    A robot that publishes its tool's pose.

    :param listener: Gives the tool's position, see `ros.ToolListener`.
    """

    def __init__(self, listener: Any) -> None:
        self._listener = listener

    def touch(self) -> Tuple[float, float]:
        """Ask for the touch, see :class:`Robot`."""
        ask(f'{_TOUCH} press Enter:')
        return self._listener.position()

    def close(self) -> None:
        """End the listener."""
        self._listener.close()


class NodePositions:
    """
    Positions from a running camera node.

    :param listener: See `ros.ObjectListener`.
    :param settings: The camera node's settings from the file.
    """

    thumbnail = ''

    def __init__(self, listener: Any, settings: CameraSettings) -> None:
        self.name = f'the running node, topic {listener.topic}'
        self._listener, self._settings = listener, settings

    def prepare(self) -> None:
        """Do nothing: the node has a background."""

    def suggestions(self) -> Iterator[Suggestion]:
        """Suggest places, see :class:`Positions`."""
        return suggested_places(
            self._settings.surface, self._settings.hull, self._settings.image_size)

    def see(self, suggestion: Suggestion) -> List[List[Tuple[float, float]]]:
        """Ask for an object, see :class:`Positions`."""
        ask_for_object(suggestion)
        return self._listener.frames(FRAMES)

    def robot_hint(self) -> str:
        """Return nothing: the robot is a real one."""
        return ''

    def close(self) -> None:
        """End the listener."""
        self._listener.close()


def open_positions(path: str, namespace: Optional[str], camera: Optional[str]) -> Positions:
    """
    Listen to a running camera node; where none runs, open the camera.

    :param path: The parameter file with the surface.
    :param namespace: The node's namespace; None for the one that the file names, if any.
    :param camera: The camera to open, whatever runs; None for the one that the file names.
    :raises CameraToBaseError: If the node has another surface, or there is no camera.
    """
    settings = read_node_settings(path, namespace).camera
    listener = None if camera is not None else _running_node(namespace)
    if listener is not None:
        listener.check_same_surface(read_parameter_file(path).values, path)
        return NodePositions(listener, settings)
    settings = settings if camera is None else replace(settings, source=camera)
    if kind_of(settings.source) == SIMULATED:
        return SimulatedPositions(settings)
    source = open_named_source(settings, may_be_random=False)
    if not source.kind.is_live or source.frames is None:
        raise InvalidValueError(
            f"no camera_publisher is running, and the source '{source.name}' is no camera that "
            'can be opened here: start the node with this file, or give --camera')
    return CameraPositions(settings, source)


def open_robot(topic: Optional[str]) -> Robot:
    """
    Return the robot whose position is typed, or one that publishes it.

    :param topic: Its topic of geometry_msgs/PoseStamped; None for a robot with a display.
    :raises InvalidValueError: If ROS is missing.
    """
    if topic is None:
        return TypedRobot()
    try:
        from camera_to_base.ros import ToolListener
    except ModuleNotFoundError as error:
        raise InvalidValueError(
            '--robot-topic needs ROS 2: source /opt/ros/jazzy/setup.bash, or leave it out and '
            'type the positions') from error
    return TopicRobot(ToolListener(topic))


def _running_node(namespace: Optional[str]) -> Any:
    try:
        from camera_to_base.ros import ObjectListener
    except ModuleNotFoundError:
        return None
    tell('Looking for a running camera_publisher ...')
    listener = ObjectListener(namespace or '')
    if listener.is_node_running():
        return listener
    listener.close()
    return None


class KeptPairs:
    """
    The pairs of a calibration, in a file from the first one on, so that it can be gone on with.

    `pairs` are those so far.

    :param cell: The parameter file that is to be written; the pairs are kept beside it.
    :param surface: The record of the surface that the camera points are measured with.
    :raises InvalidValueError: If the file cannot be written, or is another one.
    """

    def __init__(self, cell: str, surface: str) -> None:
        self.path = f'{os.path.splitext(cell)[0]}_touched_pairs.csv'
        self.pairs: List[TouchedPair] = []
        self._surface = surface
        refuse_same_file([cell, self.path])
        regular_target(self.path)
        if os.path.exists(self.path):
            read_kept_pairs(self.path, surface, iter(()))

    def offer(self, positions: Positions, most: int) -> None:
        """Ask whether to go on with the pairs of a calibration that was interrupted."""
        if not os.path.exists(self.path):
            return
        kept = read_kept_pairs(self.path, self._surface, positions.suggestions())[:most]
        if not kept:
            tell(f'The pairs in {self.path} were measured with another surface: they are not '
                 'used.')
            return
        when = datetime.fromtimestamp(os.path.getmtime(self.path))
        answer = ask(
            f'{len(kept)} of {most} pairs are kept in {self.path}, of {when:%Y-%m-%d %H:%M}. If '
            'neither the camera nor the robot was moved since, press Enter to go on with them; '
            'type n to begin anew:')
        if not answer.lower().startswith('n'):
            self.pairs = kept

    def put(self, index: int, pair: TouchedPair) -> None:
        """Add a pair or replace one, and write the file."""
        self.pairs[index:index + 1] = [pair]
        write_files({self.path: pairs_text(self.pairs, self._surface).encode()})

    def remove(self) -> None:
        """Remove the file: the calibration is saved."""
        if os.path.exists(self.path):
            os.remove(self.path)


def collect(positions: Positions, robot: Robot, count: int, kept: KeptPairs) -> None:
    """
    Ask for one object after the other.

    :param positions: Where objects are seen.
    :param robot: Where the robot is.
    :param count: Number of places.
    :param kept: Gets the pairs, and may have some of them.
    """
    tell(f'Positions come from {positions.name}.')
    kept.offer(positions, count)
    until_right(positions.prepare, 'Press Enter to try again, q to stop:')
    first = len(kept.pairs)
    for number, suggestion in enumerate(islice(positions.suggestions(), first, count), first):
        tell(f'Place {number + 1} of {count}')
        kept.put(number, _pair(suggestion, positions, robot, kept.pairs))
        if number == 0:
            tell(f'  kept in {kept.path} until the calibration is saved')


def measure_again(kept: KeptPairs, index: int, positions: Positions, robot: Robot) -> None:
    """Replace one of the pairs."""
    tell(f'Place {index + 1} again')
    others = [pair for number, pair in enumerate(kept.pairs) if number != index]
    kept.put(index, _pair(kept.pairs[index].suggestion, positions, robot, others))


def touch_elsewhere(
    robot: Robot, camera_point: Tuple[float, float], others: Sequence[TouchedPair]
) -> Tuple[float, float]:
    """
    Ask for a touch until it is none of another place; return x and y, in cm, in the base frame.

    :param camera_point: Where the camera sees what is touched, x and y, in cm.
    :param others: The pairs of the other places.
    """
    while True:
        base_point = until_right(robot.touch, 'Press Enter to try again, q to stop:')
        refusal = same_touch(others, camera_point, base_point)
        if refusal is None:
            tell('  touched at ({:.2f}, {:.2f}) cm in the base frame'.format(*base_point))
            return base_point
        tell(f'  {refusal}')


def _pair(
    suggestion: Suggestion, positions: Positions, robot: Robot, others: Sequence[TouchedPair]
) -> TouchedPair:
    place = until_right(lambda: measured_place(positions.see(suggestion)),
                        'Press Enter to measure it again, q to stop:')
    tell(f'  seen at ({place.x:.2f}, {place.y:.2f}) cm in the camera frame, in '
         f'{place.frame_count} frames, spread {10 * place.spread_cm:.2f} mm')
    hint = positions.robot_hint()
    if hint:
        tell(f'  {hint}')
    point = (place.x, place.y)
    return TouchedPair(suggestion, point, touch_elsewhere(robot, point, others))
