# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A driver's pictures for `calibrate board`, and its lens where it knows it."""

from typing import Optional

from camera_to_base.calibration import lens_of_camera_info
from camera_to_base.commands.calibrate.prompts import tell
from camera_to_base.sources import (
    COMPRESSED_TOPIC, frame_from_compressed_message, frame_from_image_message, TOPIC)
from camera_to_base.surface import LensModel
import numpy as np


class TopicFrames:
    """
    A `FrameSource` of the pictures on a topic.

    :param topic: Its name; with `/compressed` at its end, of JPEG or PNG.
    :raises InvalidValueError: If it is no topic's name.
    """

    def __init__(self, topic: str) -> None:
        # Imported here: only this way needs ROS.
        from camera_to_base.ros import is_rectified, PictureListener

        self._pictures = PictureListener(topic)
        self._is_rectified = is_rectified(self._pictures.topic)
        is_compressed = self._pictures.is_compressed
        self.kind = COMPRESSED_TOPIC if is_compressed else TOPIC
        self._decode = frame_from_compressed_message if is_compressed else frame_from_image_message

    def read(self) -> np.ndarray:
        """
        Wait for the next picture.

        :raises FrameSourceError: If none comes.
        :raises InvalidValueError: If it cannot be decoded.
        """
        return self._decode(self._pictures.next_picture())

    def lens(self) -> Optional[LensModel]:
        """
        Return the driver's lens, and say where it is from; None where it does not know it.

        :raises InvalidValueError: If its camera_info describes no lens.
        """
        topic = self._pictures.driver.topic
        info = self._pictures.wait_for_info()
        rectified = self._is_rectified
        lens = None if info is None else lens_of_camera_info(info, rectified)
        if lens is not None:
            tell(f'The lens is that of {topic}{", of rectified pictures" if rectified else ""}: '
                 'flat placements are enough.')
        elif info is not None:
            tell(f'{topic} knows no lens (K is 0): the board tells it.')
        return lens

    def release(self) -> None:
        """End the listener."""
        self._pictures.close()
