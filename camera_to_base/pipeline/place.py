# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The surface in force and the background as the camera sees it, where they are not the first."""

from dataclasses import replace
from typing import NamedTuple, Optional, Tuple

from camera_to_base.detection import DetectorSettings, Found, LeftOut
from camera_to_base.errors import Level, Reason
from camera_to_base.surface import Hull, PictureMap, Surface
from camera_to_base.uncertainty import PositionUncertainty
import cv2
import numpy as np

# An object's outline keeps this far from what the background does not show, in px.
_MARGIN_PX = 2
_AROUND = np.ones((2 * _MARGIN_PX + 1, 2 * _MARGIN_PX + 1), np.uint8)
_OUTSIDE = Reason(
    'outside_background', Level.WARN, 'it touches a part of the picture that the background does '
    'not show, because the camera was nudged: move it into view, or clear the surface and call '
    '~/capture_background', is_passing=True)


class SurfaceInForce(NamedTuple):
    """
    What the pixels of the camera mean, at the place where it stands.

    :param surface: Maps the frame's pixels to the work surface.
    :param covariance: Of a warp of the frame, shape (14, 14), see the room `uncertainty`; None for
        no more than the calibration's own.
    :param reason: Why it is not the calibrated surface; None where it is.
    :param replaces: Whether the covariance is used in place of the calibration's, not added to it.
    :param frame_from_calibrated: Maps the pixels of the calibrated camera to those of the frame;
        None for the same, or where that is not known.
    """

    surface: Surface
    covariance: Optional[np.ndarray] = None
    reason: Optional[Reason] = None
    replaces: bool = False
    frame_from_calibrated: Optional[PictureMap] = None

    def uncertainty(self, calibrated: PositionUncertainty) -> PositionUncertainty:
        """
        Give the uncertainty of positions.

        :param calibrated: That of the calibration.
        """
        if self.covariance is None:
            return calibrated
        covariance = self.covariance + (0 if self.replaces else calibrated.warp_covariance)
        return replace(calibrated, surface=self.surface, camera=self.surface.camera_place,
                       warp_covariance=covariance, _places={})

    def detector(self, settings: DetectorSettings) -> DetectorSettings:
        """Give the detector's settings with the area of the calibration where the frame has it."""
        if settings.area is None or self.frame_from_calibrated is None:
            return settings
        return replace(settings, area=self.moved(settings.area))

    def moved(self, hull: Hull) -> Hull:
        """Give an area of the calibrated picture as the frame shows it."""
        if self.frame_from_calibrated is None:
            return hull
        return Hull(self.frame_from_calibrated.pixels(hull.corners))


class SeenBackground(NamedTuple):
    """
    A background as the camera sees it from where it stands.

    :param picture: Shape (h, w, 3), uint8, BGR.
    :param witness: Another frame from when the background was taken; None where there is none.
    :param unknown: What it does not show, shape (h, w), uint8, 255 there; None for nothing.
    """

    picture: np.ndarray
    witness: Optional[np.ndarray] = None
    unknown: Optional[np.ndarray] = None

    def seen_after(
        self, frame_from_background: PictureMap, frame: np.ndarray
    ) -> 'SeenBackground':
        """
        Give it as a nudged camera sees it.

        What was outside of the picture is taken from a frame of the nudged camera.

        :param frame: Shape (h, w, 3), uint8, BGR.
        """
        height, width = frame.shape[:2]
        places = frame_from_background.inverse.grid((width, height))
        known = cv2.inRange(places, (0.0, 0.0), (width - 1.0, height - 1.0))
        maps = cv2.convertMaps(places, None, cv2.CV_16SC2)
        if self.unknown is not None:
            known &= cv2.bitwise_not(cv2.remap(self.unknown, *maps, cv2.INTER_LINEAR))
            known = cv2.compare(known, 255, cv2.CMP_EQ)
        picture = _moved(self.picture, maps, known, frame)
        witness = None if self.witness is None else _moved(self.witness, maps, known, frame)
        return SeenBackground(picture, witness, cv2.bitwise_not(known))

    def as_calibrated(
        self, frame_from_calibrated: Optional[PictureMap], before: Optional['SeenBackground']
    ) -> 'SeenBackground':
        """
        Give it as the camera sees it from where it was calibrated.

        :param frame_from_calibrated: Maps the pixels of the calibration; None for no movement.
        :param before: The same of the background before it; None for none.
        """
        if frame_from_calibrated is None:
            return self
        if before is None or before.picture.shape != self.picture.shape:
            before = self
        seen = self.seen_after(frame_from_calibrated.inverse, before.picture)
        return seen._replace(unknown=before.unknown)

    def without_unknown(self, found: Found) -> Found:
        """Leave out the objects that touch what the background does not show."""
        if self.unknown is None or not found.objects:
            return found
        is_outside = [self._is_outside(one.detection.outline) for one in found.objects]
        left_out = (LeftOut(one.detection, _OUTSIDE)
                    for one, outside in zip(found.objects, is_outside) if outside)
        return found._replace(
            objects=[one for one, outside in zip(found.objects, is_outside) if not outside],
            left_out=(*found.left_out, *left_out))

    def _is_outside(self, outline: np.ndarray) -> bool:
        left, top, width, height = cv2.boundingRect(outline)
        left, top = max(left - _MARGIN_PX, 0), max(top - _MARGIN_PX, 0)
        unknown = self.unknown[top:top + height + 2 * _MARGIN_PX,
                               left:left + width + 2 * _MARGIN_PX]
        if not cv2.countNonZero(unknown):
            return False
        touched = np.zeros(unknown.shape, np.uint8)
        cv2.drawContours(touched, [outline], -1, 255, cv2.FILLED, offset=(-left, -top))
        return cv2.countNonZero(cv2.dilate(touched, _AROUND) & unknown) > 0


def _moved(
    picture: np.ndarray, maps: Tuple[np.ndarray, np.ndarray], known: np.ndarray,
    frame: np.ndarray
) -> np.ndarray:
    moved = cv2.remap(picture, *maps, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    # In the light of the background.
    ours, theirs = (np.array(cv2.mean(one, known)[:3]) for one in (moved, frame))
    gain = np.diag(ours / np.maximum(theirs, 1.0))
    return cv2.copyTo(cv2.transform(frame, gain), cv2.bitwise_not(known), moved)
