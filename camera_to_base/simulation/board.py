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

"""A rendered work surface with moving objects: a frame source with known true positions."""

import math
from typing import List, NamedTuple, Optional, Tuple

from camera_to_base.coordinate_transform import TUTORIAL_WIDTH_CM
from camera_to_base.image_size import DEFAULT_IMAGE_SIZE, ImageSize
from camera_to_base.simulation.conditions import BoardConditions
from camera_to_base.simulation.disturbances import BoardDisturbances
from camera_to_base.simulation.drawing import draw_oval, draw_table
from camera_to_base.simulation.specs import SIMULATION_DEFAULTS as _DEFAULTS
from camera_to_base.simulation.view import BoardView, Oval
from camera_to_base.sources import SIMULATED
import numpy as np

# One round of the path takes this long; 2 and 3 rounds in x and y make a closed figure.
_ROUND_S = 60.0
_YAW_STEP_DEG = 50.0


class TrueObject(NamedTuple):
    """
    The true state of an object.

    :param point: Where its centre is on the surface, x and y, in cm, in the camera frame.
    :param pixel: The centroid of its picture, u and v, in px.
    :param radius: Radius of a disc of the same area in the picture, in px.
    :param cut_off: Distance by which it exceeds the picture's edge, in px; negative inside.
    :param hidden: Whether a hand covers or touches it.
    :param yaw: The direction of its length about the camera frame's z, from x towards y, in rad,
        in (-pi/2, pi/2]; None for a round one.
    """

    point: Tuple[float, float]
    pixel: Tuple[float, float]
    radius: float
    cut_off: float
    hidden: bool
    yaw: Optional[float]


class SimulatedBoard:
    """
    Frames of objects that move over a board, seen by a pinhole camera, see :class:`BoardView`.

    The first frame shows the empty board, unless the conditions say otherwise.

    :param image_size: Width and height, in px.
    :param width_cm: What the picture's width sees of the surface at tilt 0, in cm.
    :param tilt_deg: 0 looks straight down; up to 60, in degrees.
    :param seed: Seed of noise and texture; the same seed gives the same frames.
    :param frame_rate: Frames per second of simulated time.
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
        **conditions,
    ) -> None:
        self._view = BoardView(image_size, width_cm, tilt_deg)
        self._conditions = BoardConditions(**conditions)
        self._seed = seed
        self.frame_rate = frame_rate
        self.kind = SIMULATED._replace(frame_rate=frame_rate)
        self._disturbances = BoardDisturbances(image_size, self._conditions, self._seed)
        self._table = draw_table(self._view, self._conditions, self._seed)
        self._frame_count = 0
        self.true_objects: List[TrueObject] = []

    @property
    def pixel_from_surface(self) -> np.ndarray:
        """Homography from cm in the camera frame to px, shape (3, 3)."""
        return self._view.pixel_from_surface.copy()

    @property
    def surface_from_pixel(self) -> np.ndarray:
        """Homography from px to cm in the camera frame, shape (3, 3): what calibration finds."""
        return self._view.surface_from_pixel.copy()

    @property
    def true_point(self) -> Optional[Tuple[float, float]]:
        """Return x and y of the largest whole object on the last frame, in cm, or None."""
        whole = [true for true in self.true_objects if true.cut_off < 0 and not true.hidden]
        return max(whole, key=lambda true: true.radius).point if whole else None

    def read(self) -> np.ndarray:
        """
        Render the next frame, and set `true_objects` to the objects on it.

        :returns: Shape (h, w, 3), uint8, BGR.
        """
        number, self._frame_count = self._frame_count, self._frame_count + 1
        picture, rounds = self._table.copy(), self._rounds(number)
        self.true_objects = []
        if number > 0 or self._conditions.in_first_frame:
            for index in range(len(self._conditions.diameters_cm)):
                oval = self._oval(number, index)
                draw_oval(picture, oval, self._view, self._conditions)
                self.true_objects.append(self._true_object(oval, rounds))
        self._disturbances.disturb(picture, number, rounds)
        return np.clip(np.rint(picture), 0, 255).astype(np.uint8)

    def release(self) -> None:
        """Do nothing: there is no device to give back."""

    def object_point(self, number: int, index: int = 0) -> Tuple[float, float]:
        """
        Return the position of an object.

        :param number: The frame's, from 0.
        :param index: The object's; each object has its own part of the board, so they never meet.
        :returns: x and y, in cm, in the camera frame.
        """
        part = self._rounds(number)
        if self._conditions.rests:
            stage, within = divmod(part * 12, 1)
            part = (stage + min(2 * within, 1)) / 12
        angle = 2 * math.pi * part
        count = len(self._conditions.diameters_cm)
        reach_x, reach_y = (0.53, 0.53) if self._conditions.over_edge else (0.3, 0.25)
        width_cm = self._view.cm_per_px * self._view.width
        height_cm = self._view.cm_per_px * self._view.height
        return (width_cm / count * (index + 0.5 + reach_x * math.sin(2 * angle + index)),
                height_cm * (0.5 + reach_y * math.sin(3 * angle + index)))

    def _rounds(self, number: int) -> float:
        return number / self.frame_rate / _ROUND_S

    def _oval(self, number: int, index: int) -> Oval:
        length, elongation = self._conditions.diameters_cm[index], self._conditions.elongation
        yaw_deg = self._conditions.yaw_deg + index * _YAW_STEP_DEG if elongation > 1 else 0.0
        return Oval(self.object_point(number, index), length / 2, length / 2 / elongation,
                    math.radians(90 - (90 - yaw_deg) % 180))

    def _true_object(self, oval: Oval, rounds: float) -> TrueObject:
        ellipse = self._view.ellipse(oval)
        last = np.array([self._view.width, self._view.height]) - 0.5
        cut_off = max((ellipse.half - ellipse.centre).max() - 0.5,
                      (ellipse.centre + ellipse.half - last).max())
        return TrueObject(
            oval.point, tuple(ellipse.centre), ellipse.radius, float(cut_off),
            self._disturbances.hides(ellipse, rounds),
            oval.yaw if oval.half_length > oval.half_width else None)
