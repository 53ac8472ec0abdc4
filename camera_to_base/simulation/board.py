# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A rendered work surface with objects: a frame source with known true positions, and a robot."""

from dataclasses import asdict, dataclass, fields
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

from camera_to_base.checks import DEFAULT_IMAGE_SIZE, ImageSize
from camera_to_base.coordinate_transform import (
    CameraToRobotBaseConversion, TUTORIAL_DISPLACEMENT_CM, TUTORIAL_ROTATION_DEG,
    TUTORIAL_WIDTH_CM)
from camera_to_base.errors import HorizonError, InvalidValueError
from camera_to_base.markers import marker_cells
from camera_to_base.parameters import Values
from camera_to_base.simulation.disturbances import BoardConditions, BoardDisturbances
from camera_to_base.simulation.printed import placed_board, PrintedMarkers
from camera_to_base.simulation.solids import draw_solids, seen_ellipse
from camera_to_base.simulation.specs import (
    BOARD, OBJECTS, SIMULATION_DEFAULTS as _DEFAULTS, STILL_OBJECTS)
from camera_to_base.simulation.table import BoardObjects, draw_oval, Table, true_object, TrueObject
from camera_to_base.simulation.view import (
    BoardView, camera_move, CameraMove, largest_shift_px, Oval, random_bump)
from camera_to_base.sources import SIMULATED
from camera_to_base.surface import PinholeSurface
import numpy as np

# One round of the objects' path takes this long.
_ROUND_S = 60.0
# Corners along a row and a column, and the edge of a square in cm: what `calibrate sheet` prints.
_PRINTED_BOARD = 9, 6, 2.5

# Of a gripper tip on the middle of a coin, in each direction.
_TOUCH_ERROR_CM = 0.03

_DIAMETER_CM = 2.4


class SimulatedScene(NamedTuple):
    """
    What the simulated camera sees; it may change between two frames.

    :param shows: One of `specs.SHOWN`.
    :param placement: Where the chessboard lies, from 1, see `board_placement`.
    :param markers: Whether the markers lie on the table.
    :param table: One of `specs.TABLES`.
    :param move: How the camera was moved since the start.
    :param layout: Where the still objects lie, see `simulated.layout`.
    :param taken: Numbers of the still objects that are not there, from 1.
    """

    shows: str = _DEFAULTS['shows']
    placement: int = _DEFAULTS['placement']
    markers: bool = _DEFAULTS['markers']
    table: str = _DEFAULTS['table']
    move: CameraMove = CameraMove()
    layout: int = _DEFAULTS['layout']
    taken: Tuple[int, ...] = tuple(_DEFAULTS['taken'])


class Touch(NamedTuple):
    """
    What the simulated robot touches.

    :param number: The object's, 1 for the largest in the picture; 0 for none.
    :param marker: The marker's, which comes first; -1 for none.
    """

    number: int = _DEFAULTS['touched']
    marker: int = _DEFAULTS['touched_marker']


class SimulatedBoard:
    """
    Frames of objects that move over a board, seen by a pinhole camera, see :class:`BoardView`.

    The first frame shows the empty board, unless the conditions say otherwise.

    :param image_size: Width and height, in px.
    :param width_cm: What the picture's width sees of the surface at tilt 0, in cm.
    :param tilt_deg: 0 looks straight down; up to 60, in degrees.
    :param seed: Seed of noise and texture; the same seed gives the same frames.
    :param frame_rate: Frames per second of simulated time.
    :param scene: What the camera sees at first.
    :param conditions: Light, noise, objects: the fields of :class:`BoardConditions`.
    :raises InvalidValueError: If a value cannot be used.
    :raises HorizonError: If the picture would reach the horizon.
    """

    def __init__(
        self,
        *,
        image_size: ImageSize = DEFAULT_IMAGE_SIZE,
        width_cm: float = TUTORIAL_WIDTH_CM,
        tilt_deg: float = _DEFAULTS['tilt_deg'],
        seed: int = _DEFAULTS['seed'],
        frame_rate: float = _DEFAULTS['frame_rate'],
        scene: SimulatedScene = SimulatedScene(),
        **conditions,
    ) -> None:
        self._start = BoardView(image_size, width_cm, tilt_deg)
        self._conditions = BoardConditions(**conditions)
        self._seed = seed
        self.frame_rate = frame_rate
        self.kind = SIMULATED._replace(frame_rate=frame_rate)
        self._disturbances = BoardDisturbances(image_size, self._conditions, self._seed)
        self._objects = BoardObjects(self._start, self._conditions)
        self._markers = PrintedMarkers(self._start)
        self._frame_count = 0
        self.true_objects: List[TrueObject] = []
        self._surface: Optional[Table] = None
        self._scene = scene
        self.arrange(scene)

    def arrange(self, scene: SimulatedScene) -> None:
        """
        Show another scene from the next frame on.

        :raises HorizonError: If the picture would reach the horizon; then nothing changes.
        """
        view = self._start if scene.move == CameraMove() else self._start.moved(scene.move)
        if self._surface is None or scene.table != self._scene.table:
            self._surface = Table(scene.table, self._start, self._conditions, self._seed)
        self._scene, self._view = scene, view
        self._table = self._lay_out()
        self._drawn: Tuple[Optional[List[Oval]], Optional[np.ndarray]] = None, None

    def random_bump(self, random: np.random.Generator) -> CameraMove:
        """Draw a bump of the camera, a few px from where it was at the start."""
        return random_bump(random, self._start)

    @property
    def shift_px(self) -> float:
        """How far the camera's move has taken the picture's corner that moved farthest, in px."""
        return largest_shift_px(self._start, self._view)

    @property
    def shift_cm(self) -> float:
        """The same on the table, by the scale at the picture's middle at tilt 0, in cm."""
        return self.shift_px * self._start.cm_per_px

    @property
    def pixel_from_surface(self) -> np.ndarray:
        """Homography from cm in the camera frame to px, shape (3, 3)."""
        return self._view.pixel_from_surface.copy()

    @property
    def surface_from_pixel(self) -> np.ndarray:
        """Homography from px to cm in the camera frame, shape (3, 3): what calibration finds."""
        return self._view.surface_from_pixel.copy()

    @property
    def pinhole(self) -> PinholeSurface:
        """The surface that a perfect calibration of the camera finds, with its place."""
        return self._view.pinhole

    @property
    def true_point(self) -> Optional[Tuple[float, float]]:
        """Return x and y of the largest whole object on the last frame, in cm, or None."""
        whole = self._whole_objects()
        return whole[0].point if whole else None

    @property
    def true_markers(self) -> Dict[int, np.ndarray]:
        """
        Where the markers lie, whether they are shown or not.

        :returns: By the marker's number its corners, as printed, from the top left clockwise:
            shape (4, 2), x and y, in cm, in the camera frame.
        """
        return self._markers.corners

    def point_of(self, touch: Touch) -> Optional[Tuple[float, float]]:
        """Return the middle of what is touched, x and y, in cm, or None where nothing is there."""
        if touch.marker >= 0:
            x, y = self.true_markers[touch.marker].mean(axis=0)
            return (float(x), float(y)) if self._scene.markers else None
        whole = self._whole_objects()
        return whole[touch.number - 1].point if 0 < touch.number <= len(whole) else None

    def read(self) -> np.ndarray:
        """
        Render the next frame, and set `true_objects` to the objects on it.

        :returns: Shape (h, w, 3), uint8, BGR.
        """
        number, self._frame_count = self._frame_count, self._frame_count + 1
        rounds, ovals = self._rounds(number), self._ovals(number)
        if ovals != self._drawn[0]:
            self._drawn = ovals, self._draw(ovals)
        picture = self._drawn[1].copy()
        self.true_objects = []
        for oval in ovals:
            ellipse = seen_ellipse(oval, self._view)
            self.true_objects.append(true_object(
                oval, ellipse, self._view, self._disturbances.hides(ellipse, rounds)))
        self._disturbances.disturb(picture, number, rounds)
        return np.clip(np.rint(picture), 0, 255).astype(np.uint8)

    def release(self) -> None:
        """Do nothing: there is no device to give back."""

    def object_point(self, number: int, index: int = 0) -> Tuple[float, float]:
        """
        Return the position of a moving object.

        :param number: The frame's, from 0.
        :param index: The object's; each object has its own part of the board, so they never meet.
        :returns: x and y, in cm, in the camera frame.
        """
        return self._objects.point(self._rounds(number), index)

    def _lay_out(self) -> np.ndarray:
        picture = self._surface.seen_by(self._view)
        if self._scene.markers:
            self._markers.paint(picture, self._view)
        if self._scene.shows == BOARD:
            board = placed_board(*_PRINTED_BOARD, self._start, self._scene.placement)
            picture = board.paint(picture, self._view).astype(np.float32)
        return picture

    def _draw(self, ovals: List[Oval]) -> np.ndarray:
        picture = self._table.copy()
        for oval in ovals:
            if oval.is_flat_disc:
                draw_oval(picture, oval, self._view, self._conditions)
        draw_solids(picture, [oval for oval in ovals if not oval.is_flat_disc], self._view,
                    self._conditions)
        return picture

    def _ovals(self, number: int) -> List[Oval]:
        if number == 0 and not self._conditions.in_first_frame:
            return []
        if self._scene.shows == STILL_OBJECTS:
            return self._objects.still(self._scene.layout, self._scene.taken)
        return self._objects.moving(self._rounds(number)) if self._scene.shows == OBJECTS else []

    def _whole_objects(self) -> List[TrueObject]:
        # In the order of the published ones.
        whole = [true for true in self.true_objects if true.cut_off < 0 and not true.hidden]
        return sorted(whole, key=lambda true: -true.radius)

    def _rounds(self, number: int) -> float:
        return number / self.frame_rate / _ROUND_S


class SimulatedRobot:
    """
    A robot that stands beside the table as the tutorial's does.

    :param random: Makes the errors of its touches.
    """

    def __init__(self, random: np.random.Generator) -> None:
        self._random = random
        self._base_from_camera = CameraToRobotBaseConversion.from_roll_pitch_yaw(
            TUTORIAL_ROTATION_DEG, TUTORIAL_DISPLACEMENT_CM)
        self.renew_error()

    def renew_error(self) -> None:
        """Touch anew: with another error, which stays the same while the tool touches."""
        self._error = self._random.normal(0.0, _TOUCH_ERROR_CM, 2)

    def touch(self, point: Tuple[float, float]) -> Tuple[float, float]:
        """
        Return where the tool is.

        :param point: What it touches, x and y, in cm, in the camera frame of the uncalibrated
            simulated camera.
        :returns: x and y, in cm, in the base frame, with an error of a few tenths of a mm.
        """
        x, y, _ = self._base_from_camera.convert_point(*point)
        return float(x + self._error[0]), float(y + self._error[1])


class SimulatedTouchTable(SimulatedBoard):
    """
    The simulated board with one coin at rest, or none.

    :param image_size: Width and height, in px.
    :param others: See :class:`SimulatedBoard`.
    """

    def __init__(self, image_size: ImageSize, **others) -> None:
        super().__init__(image_size=image_size, **others)
        self._point: Optional[Tuple[float, float]] = None
        self._robot = SimulatedRobot(np.random.default_rng(self._seed))

    def lay_coin(self, pixel: Tuple[float, float]) -> None:
        """Lay the coin on the surface where a pixel shows it."""
        self._point = self._view.point(pixel)

    def robot_position(self) -> Tuple[float, float]:
        """
        Return what the display of the tutorial's robot shows when it touches the coin.

        :returns: x and y, in cm, in the base frame, with an error of a few tenths of a mm.
        """
        return self._shown(self._point)

    def robot_position_at(self, marker: int) -> Optional[Tuple[float, float]]:
        """Return what the display shows when it touches a marker's middle; None without it."""
        corners = self.true_markers.get(marker)
        return None if corners is None else self._shown(tuple(corners.mean(axis=0)))

    def _shown(self, point: Tuple[float, float]) -> Tuple[float, float]:
        x, y = self._robot.touch(point)
        self._robot.renew_error()
        return round(x, 2), round(y, 2)

    def _ovals(self, number: int) -> List[Oval]:
        if self._point is None:
            return []
        return [Oval(self._point, _DIAMETER_CM / 2, _DIAMETER_CM / 2, 0.0)]


@dataclass(frozen=True)
class SimulationSettings:
    """
    How the simulated board is seen, and what kind of day it has.

    :param scene: What the camera sees; may change while the node runs.
    :param touch: What the robot touches; may change, too.
    """

    tilt_deg: float
    seed: int
    frame_rate: float
    scene: SimulatedScene
    touch: Touch
    conditions: BoardConditions

    def check_scene(self, image_size: ImageSize) -> None:
        """
        Check that the camera sees the table in all of its picture, and that markers can be drawn.

        :raises InvalidValueError: If the picture would reach the horizon.
        :raises CalibrationError: If OpenCV has no module aruco, and there are to be markers.
        """
        if self.scene.markers:
            marker_cells(0)
        try:
            BoardView(image_size, TUTORIAL_WIDTH_CM, self.tilt_deg, self.scene.move)
        except HorizonError as error:
            raise InvalidValueError(
                'simulated.tilt_deg and simulated.camera_tilt_deg tilt the camera so far that its '
                'picture reaches the horizon: tilt it less') from error

    def board(self, image_size: ImageSize) -> SimulatedBoard:
        """Make the board, for pictures of a size."""
        return SimulatedBoard(image_size=image_size, **self._everything)

    def touch_table(self, image_size: ImageSize) -> SimulatedTouchTable:
        """Make the same table with one object at rest."""
        return SimulatedTouchTable(image_size, **self._everything)

    @property
    def _everything(self) -> Dict[str, Any]:
        return {'tilt_deg': self.tilt_deg, 'seed': self.seed, 'frame_rate': self.frame_rate,
                'scene': self.scene, **asdict(self.conditions)}


def simulation_settings(values: Values) -> SimulationSettings:
    """Make the simulation's settings of its parameters, named without 'simulated.'."""
    return SimulationSettings(
        values['tilt_deg'], values['seed'], values['frame_rate'],
        SimulatedScene(values['shows'], values['placement'], values['markers'], values['table'],
                       camera_move(values), values['layout'], tuple(values['taken'])),
        Touch(values['touched'], values['touched_marker']),
        BoardConditions(**{field.name: values[field.name] for field in fields(BoardConditions)}))
