# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Whether a calibration belongs to the camera that is used with it, and to its view."""

from typing import Optional

from camera_to_base.errors import Level, Reason
from camera_to_base.pipeline.stage import FrameRecord, Stage
from camera_to_base.sources import is_other_camera, lasting_name
from camera_to_base.surface import shares_structure
import numpy as np


class OwnCamera(Stage):
    """
    Compares the camera in use with the one that was calibrated.

    :param source: Name of the source in use; '' if it is not known.
    :param calibrated: Lasting name of the calibrated camera; '' if it is not known.
    :param thumbnail: The calibrated view, see `read_thumbnail`; None if it is not known.
    :param is_strict: Whether frames of another camera or view are held back; otherwise their
        positions are published with a warning.
    """

    def __init__(
        self, source: str = '', calibrated: str = '', thumbnail: Optional[np.ndarray] = None,
        is_strict: bool = False,
    ) -> None:
        self._thumbnail, self.is_strict = thumbnail, is_strict
        self._background: Optional[np.ndarray] = None
        self._other_view = False
        self._device_reason: Optional[Reason] = None
        if source and is_other_camera(source, calibrated):
            self._device_reason = _reason(
                'other_camera', f"the calibration was made with '{calibrated}', but the frames "
                f"come from '{lasting_name(source)}': use that camera, or calibrate this one")

    def reason(self, background: Optional[np.ndarray]) -> Optional[Reason]:
        """
        Return why the calibration is not this camera's; None if nothing shows that.

        :param background: Shape (h, w, 3), uint8, BGR; None if none was taken yet.
        :returns: An error if frames are held back for it, otherwise a warning.
        """
        reason = self._device_reason or self._view_reason(background)
        return reason._replace(level=Level.ERROR) if reason and self.is_strict else reason

    def judge(self, record: FrameRecord) -> FrameRecord:
        """Hold a frame back if the calibration is another camera's, where that is strict."""
        reason = self.reason(record.standpoint.taken.picture) if self.is_strict else None
        return record if reason is None else record.held(reason)

    def _view_reason(self, background: Optional[np.ndarray]) -> Optional[Reason]:
        if background is not None and background is not self._background:
            self._background = background
            self._other_view = self._thumbnail is not None and (
                shares_structure(self._thumbnail, background) is False)
        return _OTHER_VIEW if self._other_view else None


def _reason(kind: str, sentence: str) -> Reason:
    return Reason(kind, Level.WARN, sentence)


_OTHER_VIEW = _reason(
    'other_view', 'the picture shares nothing with the surface that was calibrated: is it another '
    'camera, or was it moved? Calibrate again; with the same camera in its place, take the '
    'background again')
