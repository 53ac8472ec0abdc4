# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
What lies still is told once: what of a region is a thing is kept while nothing changes there.

To tell a thing from its shade takes most of a frame's time, and most objects lie still. What was
told of a region holds as long as the frame shows the same in the region and around it, but for
noise, in about the same light. Only that is kept: where a thing lies is measured on each frame.

What noise may turn over must not last: only what several frames in a row tell alike is kept, and
now and then the region that was told the longest ago is told again.
"""

from typing import List, Mapping, NamedTuple, Sequence, Tuple

from camera_to_base.detection.detection import Box, NoObject
from camera_to_base.detection.precise.light import Gain
from camera_to_base.detection.precise.piece import filled, grown, slices, square
from camera_to_base.detection.precise.placer import Placing
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.regions import Region
import cv2
import numpy as np

# How far around a region the frame must show the same, px.
_AROUND = 12
# Something has changed where means over this window, px, differ by more than this part of what an
# object must at least differ by: noise is below it, a faint object above. JPEG's blocks spread
# this part of a step over so many px.
_WINDOW, _OF_LEAST, _OF_STEP, _BLOCK = (5, 5), 0.75, 0.1, square(9)
# What was told holds while the gain has changed by no more steps: by 3 %, less than a rim shows.
_SAME_LIGHT = 3
# So many looks in a row must tell the same before it is kept: where one look of 30 is mistaken
# (a neighbour that noise joins to its object), three such looks are one case of 27,000. One region
# is told again in so many frames.
_LOOKS, _PERIOD = 3, 8
# What a frame says of them anew does not belong to what was told of a region.
_KEPT = 'shade', 'light', 'speck'
# A region is the same where its area differs by less than this part.
_SAME_AREA = 0.25


class Still(NamedTuple):
    """
    What was told of a region that lies still.

    :param window: The region and what is around it.
    :param picture: What the frame showed there, shape (height, width, 3), uint8, BGR.
    :param steps: The steps in it that JPEG spreads, of the same shape.
    :param gain: The frame's light.
    :param region: The region as it was found.
    :param things: What was told of it: the things in it; the region itself where that is not
        clear; nothing where it is light.
    :param boxes: Where objects were placed.
    :param no_objects: What else differs there.
    :param looks: How many looks in a row have told this.
    """

    window: Box
    picture: np.ndarray
    steps: np.ndarray
    gain: Gain
    region: Region
    things: Sequence[Region]
    boxes: Sequence[Box]
    no_objects: Sequence[NoObject]
    looks: int = 1

    def holds(self, frame: np.ndarray, reference: Reference) -> bool:
        """Tell whether a frame shows the same."""
        if any(abs(now - then) > _SAME_LIGHT for now, then in zip(reference.gain, self.gain)):
            return False
        away = cv2.blur(cv2.absdiff(frame[slices(self.window)], self.picture), _WINDOW)
        away = cv2.addWeighted(away, 1, self.steps, -_OF_STEP, 0)
        return (cv2.minMaxLoc(away.reshape(len(away), -1))[1]
                <= _OF_LEAST * reference.limits.least)

    def fills(self, part: Box) -> bool:
        """Tell whether a part of a frame that has changed is this region, and nothing else."""
        return part.is_inside(self.window) and self.region.box.is_mostly_inside(part)

    def is_at(self, region: Region) -> bool:
        """Tell whether most of this region lies in another, or most of that in this one."""
        if not self.region.box.overlaps(region.box):
            return False
        own, other = (filled(one.outline, self.region.box) for one in (self.region, region))
        return 2 * cv2.countNonZero(own & other) > min(
            cv2.countNonZero(own), cv2.contourArea(region.outline))

    def is_as_large_as(self, region: Region) -> bool:
        """Tell whether a region at this one's place is hardly more, and hardly less."""
        own, other = (cv2.contourArea(one.outline) for one in (self.region, region))
        return abs(own - other) <= _SAME_AREA * own

    def tells_the_same(self, other: 'Still') -> bool:
        """Tell whether another look has told the same of the region."""
        return (other.is_at(self.region) and len(self.boxes) == len(other.boxes)
                and all(any(box.is_mostly_inside(one) and one.is_mostly_inside(box)
                            for one in other.boxes) for box in self.boxes))


class StillRegions:
    """What was told of the last frames' regions, while it holds."""

    def __init__(self) -> None:
        self._kept: List[Still] = []
        self._unsure: List[Still] = []
        self._frame_count = 0

    def on(self, frame: np.ndarray, reference: Reference) -> List[Still]:
        """Give what a frame shows again; the rest is to be told anew."""
        self._frame_count += 1
        again = int(self._frame_count % _PERIOD == 0)
        known, self._kept = self._kept, []
        for index, one in enumerate(known):
            is_kept = index >= again and one.holds(frame, reference)
            # Where noise or a passing shadow has changed it, one look that tells the same will do.
            (self._kept if is_kept else self._unsure).append(one)
        return self._kept

    def remember(
        self, frame: np.ndarray, reference: Reference, held: Sequence[Still],
        told: Sequence[Tuple[Region, Sequence[Region]]],
        placed: Mapping[Box, Placing], no_objects: Sequence[NoObject],
    ) -> None:
        """
        Remember what was told of a frame's regions.

        :param held: What was not told anew.
        :param told: Each region, and the things in it.
        :param placed: How each thing was placed, by its box.
        :param no_objects: What differs on the frame, and is no object.
        """
        before, self._kept, self._unsure = self._unsure, [*held], []
        rest = [one for one in no_objects if one.kind in _KEPT]
        for region, things in told:
            window = grown(region.box, _AROUND, frame)
            own = [one for one in rest if _has(region, one)]
            rest = [one for one in rest if not _has(region, one)]
            places = [placed.get(thing.box, Placing([], thing)) for thing in things]
            boxes = [one.box for place in places for one in place.detections]
            picture = frame[slices(window)].copy()
            still = Still(window, picture, cv2.morphologyEx(picture, cv2.MORPH_GRADIENT, _BLOCK),
                          reference.gain, region, [place.region for place in places], boxes, own)
            looks = 1 + max(
                (one.looks for one in before if still.tells_the_same(one)), default=0)
            (self._unsure if looks < _LOOKS else self._kept).append(still._replace(looks=looks))

    def forget(self) -> None:
        """Forget all: the background is another one."""
        self._kept, self._unsure = [], []


def _has(region: Region, one: NoObject) -> bool:
    # Most lie elsewhere.
    (u, v), (x, y, width, height) = one.position, region.box
    return (x <= u < x + width and y <= v < y + height
            and cv2.pointPolygonTest(region.outline, one.position, False) >= 0)
