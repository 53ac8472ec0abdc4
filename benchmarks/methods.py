# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The methods that the benchmarks compare; each is made from a background and has `detect`."""

from typing import List

from camera_to_base.detection import Box, Detection, Pixel, PreciseDifferenceDetector, touches_edge
import cv2
import numpy as np


class TutorialReference:
    """The tutorial's OpenCV calls, one after the other, on the whole frame."""

    def __init__(self, background: np.ndarray) -> None:
        self._kernel = np.ones((20, 20), np.uint8)
        self._background = self._smooth(background)

    def detect(self, frame: np.ndarray) -> List[Detection]:
        """Find the objects on a frame, the largest first."""
        difference = cv2.absdiff(self._smooth(frame), self._background)
        _, mask = cv2.threshold(difference, 95, 255, cv2.THRESH_BINARY)
        outlines, _ = cv2.findContours(mask, cv2.RETR_TREE, cv2.CHAIN_APPROX_SIMPLE)
        areas = [cv2.contourArea(outline) for outline in outlines]
        if not areas:
            return []
        outline = outlines[areas.index(max(areas))]
        x, y, width, height = cv2.boundingRect(outline)
        centre = Pixel(x + int(width / 2), y + int(height / 2))
        return [Detection(Box(x, y, width, height), centre, max(areas), outline[:, 0], False)]

    def _smooth(self, frame: np.ndarray) -> np.ndarray:
        grey = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
        closed = cv2.morphologyEx(grey, cv2.MORPH_CLOSE, self._kernel)
        return cv2.medianBlur(closed, 5)


class BackgroundModel:
    """One of OpenCV's background models as people use it: mask without shadows, cleaned."""

    def __init__(self, background: np.ndarray, model: cv2.BackgroundSubtractor) -> None:
        self._model = model
        self._model.apply(background)

    def detect(self, frame: np.ndarray) -> List[Detection]:
        """Find the objects on a frame, the largest first; the model learns from the frame."""
        _, mask = cv2.threshold(self._model.apply(frame), 200, 255, cv2.THRESH_BINARY)
        mask = cv2.medianBlur(mask, 5)
        outlines, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
        detections = []
        for outline in outlines:
            moments = cv2.moments(outline)
            if moments['m00'] >= 50:
                box = Box(*cv2.boundingRect(outline))
                centre = Pixel(moments['m10'] / moments['m00'], moments['m01'] / moments['m00'])
                detections.append(Detection(
                    box, centre, moments['m00'], outline[:, 0], touches_edge(box, frame)))
        return sorted(detections, key=lambda detection: -detection.area)


class OneRead:
    """Not a detector: a single pass over the frame's bytes, as a lower limit of the time."""

    def __init__(self, background: np.ndarray) -> None:
        """Ignore the background."""

    def detect(self, frame: np.ndarray) -> List[Detection]:
        """Read every byte; return no object."""
        frame.max()
        return []


METHODS = {
    'tutorial': TutorialReference,
    'precise': PreciseDifferenceDetector,
    'MOG2': lambda background: BackgroundModel(background, cv2.createBackgroundSubtractorMOG2()),
    'KNN': lambda background: BackgroundModel(background, cv2.createBackgroundSubtractorKNN()),
    'one read': OneRead,
}
