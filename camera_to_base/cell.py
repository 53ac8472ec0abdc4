# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
A calibrated cell for Python programs: frames in, objects in both frames out, without ROS.

In: the parameter file that `calibrate` and the dashboard write, and frames. Out: for each frame
the objects that the nodes would publish, or the reason why they would publish none.

Callers: users' programs, by `camera_to_base`, and examples.
"""

import math
from typing import NamedTuple, Optional, Tuple

from camera_to_base.coordinate_transform import Pose
from camera_to_base.detection import LeftOut, LocatedObject, Pixel
from camera_to_base.errors import HorizonError, OutOfReachError, Reason
from camera_to_base.pipeline import DamageCheck, FrameUncertainty
from camera_to_base.settings import NodeSettings, read_node_settings
from camera_to_base.sources import DEVICE, VIDEO_FILE
from camera_to_base.uncertainty import uncertain_transform
import numpy as np

__all__ = ['Cell', 'Seen', 'SeenObject']


class SeenObject(NamedTuple):
    """
    An object on the work surface.

    :param pixel: Its centre on the picture, u and v, in px.
    :param camera_xy_cm: x and y in the camera frame, in cm; its z is 0.
    :param base_xyz_cm: x, y and z in the robot's base frame, in cm; None beyond `reach_cm`.
    :param camera_yaw_deg: The direction of its length about z, from x towards y, in degrees, in
        (-90, 90]; None for an object without one, such as a coin.
    :param base_yaw_deg: The same in the base frame.
    :param size_cm: Length and width of what it stands on, in cm; None where a part of it is beyond
        the horizon.
    :param camera_covariance_cm2: Of x and y in the camera frame, shape (2, 2), in cm².
    :param base_covariance_cm2: The same in the base frame, with what the transform makes
        uncertain.
    :param yaw_deviation_deg: Standard deviation of the yaw in the base frame, in degrees.
    :param height_cm: Its height, see the parameter `object_height_cm`; 0 for a flat object.
    """

    pixel: Pixel
    camera_xy_cm: Tuple[float, float]
    base_xyz_cm: Optional[Tuple[float, float, float]]
    camera_yaw_deg: Optional[float]
    base_yaw_deg: Optional[float]
    size_cm: Optional[Tuple[float, float]]
    camera_covariance_cm2: np.ndarray
    base_covariance_cm2: np.ndarray
    yaw_deviation_deg: float
    height_cm: float = 0.0

    @property
    def base_xy_cm(self) -> Optional[Tuple[float, float]]:
        """Its x and y in the base frame, in cm, as on the topic; None beyond `reach_cm`."""
        return None if self.base_xyz_cm is None else self.base_xyz_cm[:2]


class Seen(NamedTuple):
    """
    What a frame shows.

    :param objects: The largest first. Empty where `reason` is set; otherwise empty means that no
        object is on the surface.
    :param left_out: What was detected, but is not among the objects; each has its own `reason`.
    :param reason: Why no position of this frame may be used; None where they may.
    :param warning: What is wrong with positions that may be used: another camera than the
        calibrated one, a nudge that is corrected, a marker that was moved; None for nothing.
    """

    objects: Tuple[SeenObject, ...]
    left_out: Tuple[LeftOut, ...]
    reason: Optional[Reason]
    warning: Optional[Reason]


class Cell:
    """
    A camera over a work surface, and a robot: locates objects on frames as the nodes do.

    It checks what the nodes check. A cell is for one camera, from one thread.

    :param settings: The parameters of both nodes.
    :param live: Whether frames come from a camera now, see :meth:`open`.
    :param source: Name of the camera, such as '/dev/video0', which is compared with the one that
        was calibrated; '' for not known.
    """

    def __init__(self, settings: NodeSettings, live: bool = False, source: str = '') -> None:
        self._settings = settings
        self._transform = uncertain_transform(settings.transform)
        self._pipeline = settings.camera.pipeline(
            source, DEVICE if live else VIDEO_FILE, damage=DamageCheck() if live else None)

    @classmethod
    def open(  # noqa: A003
        cls, file: str, live: bool = False, source: str = '', namespace: Optional[str] = None
    ) -> 'Cell':
        """
        Open a calibrated cell.

        :param file: The parameter file that `calibrate` and the dashboard write.
        :param live: Set it if an arm follows the positions. Then frames must come from a camera,
            in order, and nothing may be used of a frame that is damaged, too old, or of another
            view than the background, nor of an object that a second frame does not confirm. If it
            is false, frames are those of a recording or single pictures: each stands for itself,
            as with a node that plays a file.
        :param source: The camera's name, see :class:`Cell`.
        :param namespace: The nodes' namespace; None for the one that the file names, if any.
        :raises CameraToBaseError: If there is no such file, or a value cannot be used.
        """
        return cls(read_node_settings(str(file), namespace), live, source)

    def take_background(self, *frames: np.ndarray) -> None:
        """
        Take the background: the surface without objects, hands and robot.

        If it is never called, the first frames that are located are the background, as many as
        the parameter `background_frames` says.

        :param frames: Each of shape (h, w, 3), uint8, BGR; their median is the background. Several
            frames have less noise.
        :raises CameraToBaseError: If there is none, or one of them is no such frame.
        """
        self._pipeline.use_background(*frames)

    def locate(self, frame: np.ndarray, taken_at: Optional[float] = None) -> Seen:
        """
        Locate the objects on a frame.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size. It is not changed, and
            must not be changed while the next frames are located.
        :param taken_at: When it was taken, in s of `time.monotonic()`; None for now. It has no
            effect unless the cell is live.
        :returns: The objects, or the reason if there are none that may be used. No frame makes
            this method raise.
        """
        sighting = self._pipeline.process(frame, taken_at)
        doubt = self._pipeline.doubt
        if sighting.reason is not None:
            return Seen((), sighting.left_out, sighting.reason, doubt)
        uncertainty = self._pipeline.frame_uncertainty(frame, self._settings.camera.uncertainty)
        return Seen(tuple(self._seen(found, uncertainty) for found in sighting.objects),
                    sighting.left_out, None, doubt)

    def _seen(self, found: LocatedObject, uncertainty: FrameUncertainty) -> SeenObject:
        pose = Pose(*found.point, 0.0, found.yaw or 0.0)
        camera_covariance = uncertainty.of(found).matrix
        base_covariance = self._transform.base_covariance(pose[:3], camera_covariance)
        try:
            base = self._transform.settings.base_pose(pose)
        except OutOfReachError:
            base = None
        has_base_yaw = base is not None and found.yaw is not None
        return SeenObject(
            found.detection.centre, tuple(found.point), None if base is None else tuple(base[:3]),
            None if found.yaw is None else math.degrees(found.yaw),
            math.degrees(base.yaw) if has_base_yaw else None, self._size_cm(found),
            camera_covariance[:2, :2], base_covariance[:2, :2],
            math.degrees(math.sqrt(base_covariance[5, 5])),
            0.0 if found.solid is None else found.solid.height_cm)

    def _size_cm(self, found: LocatedObject) -> Optional[Tuple[float, float]]:
        try:
            size = found.size(self._pipeline.standpoint.surface.surface)
        except HorizonError:
            return None
        return size.length_cm, size.width_cm
