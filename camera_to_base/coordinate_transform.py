# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Converts points from the camera frame, on the work surface, to the robot's base frame."""

import math
import random
from typing import NamedTuple, Sequence, Tuple

from camera_to_base.checks import DEFAULT_IMAGE_SIZE, finite_numbers
from camera_to_base.errors import InvalidValueError
import numpy as np

# The tutorial's set-up: the width that the picture shows, and the pose of the camera frame.
TUTORIAL_WIDTH_CM = 36.0
TUTORIAL_ROTATION_DEG = (180.0, 0.0, 0.0)
TUTORIAL_DISPLACEMENT_CM = (-17.8, 24.4, 0.0)
# A shape that is less elongated has no yaw. A coin measures up to 1.02 times longer than wide
# (20 px, noise 10, tilt 50), plus the percentage by which the calibration is off, and a disc whose
# height two cameras measure up to 1.04 times. At this elongation an error of 0.02 turns the axis
# by 3 degrees.
LEAST_ELONGATION = 1.2


def rotation_matrix(roll_deg: float, pitch_deg: float, yaw_deg: float) -> np.ndarray:
    """
    Build a rotation matrix from roll, pitch and yaw about the fixed axes x, y and z.

    Source: REP-103, "fixed axis roll, pitch, yaw": R = Rz(yaw) @ Ry(pitch) @ Rx(roll).

    :returns: Shape (3, 3).
    """
    roll, pitch, yaw = np.deg2rad([roll_deg, pitch_deg, yaw_deg])
    about_x = np.array([[1, 0, 0],
                        [0, np.cos(roll), -np.sin(roll)],
                        [0, np.sin(roll), np.cos(roll)]])
    about_y = np.array([[np.cos(pitch), 0, np.sin(pitch)],
                        [0, 1, 0],
                        [-np.sin(pitch), 0, np.cos(pitch)]])
    about_z = np.array([[np.cos(yaw), -np.sin(yaw), 0],
                        [np.sin(yaw), np.cos(yaw), 0],
                        [0, 0, 1]])
    return about_z @ about_y @ about_x


def homogeneous_matrix(
    rotation_deg: Sequence[float], displacement_cm: Sequence[float]
) -> np.ndarray:
    """
    Build the homogeneous matrix that first rotates and then displaces.

    :param rotation_deg: Roll, pitch and yaw about the fixed axes x, y and z, in degrees.
    :param displacement_cm: x, y and z, in cm.
    :returns: Shape (4, 4), read-only.
    :raises InvalidValueError: If either is not three finite numbers.
    """
    matrix = np.eye(4)
    matrix[:3, :3] = rotation_matrix(*finite_numbers('rotation_deg', rotation_deg, 3))
    matrix[:3, 3] = finite_numbers('displacement_cm', displacement_cm, 3)
    matrix.setflags(write=False)
    return matrix


def axis_angle(x: float, y: float) -> float:
    """
    Return the direction of an axis: (-x, -y) has the same direction as (x, y).

    :returns: From the x axis towards the y axis, in rad, in (-pi/2, pi/2].
    """
    angle = math.atan2(y, x)
    return angle - math.copysign(math.pi, angle) if not -math.pi / 2 < angle <= math.pi / 2 \
        else angle


class Pose(NamedTuple):
    """
    The position and the direction of an object.

    :param x: In cm; y and z, too.
    :param yaw: Direction of its long axis about the frame's z, from x towards y, in rad, in
        (-pi/2, pi/2], as an axis has no front. 0 for a round object.
    """

    x: float
    y: float
    z: float
    yaw: float


class CameraPlace(NamedTuple):
    """
    Where the camera is above the work surface.

    :param foot_cm: The point of the surface below it, x and y, in the camera frame.
    :param height_cm: Its height above the surface.
    """

    foot_cm: Tuple[float, float]
    height_cm: float

    def below(self, seen: np.ndarray, height_cm: float) -> np.ndarray:
        """
        Give what lies below points that are higher than the surface on which they are seen.

        :param seen: Shape (..., 2), x and y on the surface, in cm.
        :param height_cm: How high they are.
        """
        return seen + (np.asarray(self.foot_cm) - seen) * (height_cm / self.height_cm)


class CoordinateConversion:
    """A conversion between two coordinate frames (the tutorial's parent class)."""

    def convert(self, frame_coordinates: np.ndarray) -> np.ndarray:
        """
        Convert points from one coordinate frame to another.

        :param frame_coordinates: Shape (4, n), rows x, y, z and 1.
        :returns: Shape (4, n), rows x, y, z and 1.
        """
        raise NotImplementedError


class CameraToRobotBaseConversion(CoordinateConversion):
    """
    The conversion from the camera frame to the robot's base frame.

    :param rot_angle: Rotation about the x axis, in degrees.
    :param x_disp: x of the camera frame's origin in the base frame, in cm.
    :param y_disp: y of the camera frame's origin in the base frame, in cm.
    :param z_disp: z of the camera frame's origin in the base frame, in cm.
    :raises InvalidValueError: If a value is not a finite number.
    """

    def __init__(self, rot_angle: float, x_disp: float, y_disp: float, z_disp: float) -> None:
        self._set_matrix(homogeneous_matrix((rot_angle, 0.0, 0.0), (x_disp, y_disp, z_disp)))

    @classmethod
    def from_roll_pitch_yaw(
        cls, rotation_deg: Sequence[float], displacement_cm: Sequence[float]
    ) -> 'CameraToRobotBaseConversion':
        """
        Make the conversion for a camera frame that is rotated about any axis.

        :param rotation_deg: Roll, pitch and yaw about the fixed axes x, y and z, in degrees.
        :param displacement_cm: The camera frame's origin in the base frame: x, y, z in cm.
        :raises InvalidValueError: If either is not three finite numbers.
        """
        conversion = cls(0.0, 0.0, 0.0, 0.0)
        conversion._set_matrix(homogeneous_matrix(rotation_deg, displacement_cm))
        return conversion

    @property
    def base_from_camera(self) -> np.ndarray:
        """Homogeneous matrix, shape (4, 4), read-only: base_from_camera @ camera_point."""
        return self._base_from_camera

    def convert(self, frame_coordinates: np.ndarray) -> np.ndarray:
        """
        Convert points from the camera frame to the robot's base frame.

        :param frame_coordinates: Shape (4, n), rows x, y, z in cm and 1.
        :returns: Shape (4, n), rows x, y, z in cm and 1.
        :raises InvalidValueError: If the shape is another, or a number is not finite.
        """
        return self._base_from_camera @ finite_numbers('points', frame_coordinates, 4, -1)

    def convert_surface_points(self, camera_points: np.ndarray) -> np.ndarray:
        """
        Convert points on the work surface, where the camera frame's z is 0.

        :param camera_points: Shape (n, 2), columns x and y, in cm, in the camera frame.
        :returns: Shape (n, 3), columns x, y and z, in cm, in the base frame.
        :raises InvalidValueError: If the shape is another, or a number is not finite.
        """
        points = finite_numbers('points', camera_points, -1, 2)
        on_surface = np.zeros((4, len(points)))
        on_surface[:2] = points.T
        on_surface[3] = 1.0
        return self.convert(on_surface)[:3].T

    def convert_point(self, x: float, y: float, z: float = 0.0) -> Tuple[float, float, float]:
        """
        Convert one point, with floats: they are faster than arrays for a single point.

        :param x: In cm, in the camera frame; y and z, too. z is 0 on the work surface.
        :returns: x, y and z, in cm, in the base frame.
        :raises InvalidValueError: If a number is not finite, or the result is not.
        """
        base_point = tuple(
            from_x * x + from_y * y + from_z * z + displacement
            for from_x, from_y, from_z, displacement in self._rows)
        if not all(map(math.isfinite, base_point)):
            raise InvalidValueError(f'expected a finite point, got ({x}, {y}, {z}) cm')
        return base_point

    def convert_yaw(self, yaw: float) -> float:
        """
        Convert the direction of a long axis on the work surface.

        :param yaw: About the camera frame's z, in rad.
        :returns: About the base frame's z, seen along it, in rad, in (-pi/2, pi/2].
        :raises InvalidValueError: If it is not finite.
        """
        if not math.isfinite(yaw):
            raise InvalidValueError(f'expected a finite yaw, got {yaw} rad')
        (along_x, along_y, _, _), (across_x, across_y, _, _), _ = self._rows
        return axis_angle(along_x * math.cos(yaw) + along_y * math.sin(yaw),
                          across_x * math.cos(yaw) + across_y * math.sin(yaw))

    def _set_matrix(self, base_from_camera: np.ndarray) -> None:
        self._base_from_camera = base_from_camera
        self._rows = base_from_camera[:3].tolist()


def main() -> None:
    """Print three seconds of random positions, as the tutorial's helper program does."""
    conversion = CameraToRobotBaseConversion(TUTORIAL_ROTATION_DEG[0], *TUTORIAL_DISPLACEMENT_CM)
    cm_per_px = TUTORIAL_WIDTH_CM / DEFAULT_IMAGE_SIZE[0]
    print('Detecting an object for 3 seconds')
    for step in range(1, 31):
        u, v = random.randint(250, 450), random.randint(250, 450)
        base_point = conversion.convert_surface_points([[u * cm_per_px, v * cm_per_px]])[0]
        print(f'{step / 10:.1f}:x: {base_point[0]}, y: {base_point[1]}')


if __name__ == '__main__':
    main()
