# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Decides by age and jumps which objects of a frame may be published."""

from collections import deque
import time
from typing import Iterable, List, Optional, Sequence, Tuple

from camera_to_base.detection import LocatedObject, Pixel
from camera_to_base.errors import Level, Reason
from camera_to_base.pipeline.stage import FrameRecord, Stage

# A confirmed position is forgotten after this time, by the frames' own times: an object there must
# then be confirmed again.
_MEMORY_S = 1.0

_UNCONFIRMED = Reason(
    'unconfirmed', Level.WARN,
    'no position is published: not confirmed by a second frame: keep hands away, or raise the '
    "detector's threshold", is_passing=True)
_JUMPED = Reason('unconfirmed', Level.OK, 'not confirmed by a second frame', is_passing=True)


class JumpFilter:
    """
    Accepts positions that continue earlier ones.

    A damaged frame may show objects in wrong places, but two damaged frames do not agree. A
    position is accepted near a position that was accepted within the last second, near one of the
    last frame, or near the continuation of an object's last two positions. So an object is held
    back for two frames at most, at any speed.

    :param radius_px: Largest distance that counts as near, in px; 0 accepts all positions. It can
        be changed at any time.
    """

    def __init__(self, radius_px: float) -> None:
        self.radius_px = radius_px
        self._seen = deque(maxlen=2)
        self._believed: List[Tuple[Pixel, float]] = []

    def believed(self, pixels: Sequence[Pixel], taken_at: float) -> List[Pixel]:
        """
        Return those positions of a frame that are accepted.

        :param pixels: The positions of all its objects, the largest first.
        :param taken_at: The frame's capture time, in s of a monotonic clock.
        """
        self._believed = [(pixel, at) for pixel, at in self._believed
                          if 0 <= taken_at - at <= _MEMORY_S]
        expected = list(self._expected())
        believed = [pixel for pixel in pixels if not self.radius_px or any(
            self._is_near(pixel, other) for other in expected)]
        self._seen.append(pixels)
        # An object that one frame does not show is not doubted on the next one.
        self._believed = [(pixel, taken_at) for pixel in believed] + [
            (pixel, at) for pixel, at in self._believed
            if not any(self._is_near(pixel, other) for other in believed)]
        return believed

    def believes_empty(self) -> bool:
        """Return whether the last two frames both show no object."""
        return not self.radius_px or (len(self._seen) == 2 and not any(self._seen))

    def _expected(self) -> Iterable[Pixel]:
        yield from (pixel for pixel, _ in self._believed)
        if self._seen:
            yield from self._seen[-1]
        if len(self._seen) == 2:
            # The lists are sorted by size, so an object mostly keeps its index.
            for (u1, v1), (u2, v2) in zip(*self._seen):
                yield Pixel(2 * u2 - u1, 2 * v2 - v1)

    def _is_near(self, pixel: Pixel, other: Pixel) -> bool:
        return max(abs(pixel[0] - other[0]), abs(pixel[1] - other[1])) <= self.radius_px


class PositionGate(Stage):
    """
    Passes on the objects whose positions an arm may follow: confirmed ones, on a new frame.

    For live sources only: the frames of other sources do not age and are not damaged.

    :param max_age_s: Greatest age of a frame whose positions are published.
    :param jump_radius_px: See :class:`JumpFilter`.
    """

    def __init__(self, max_age_s: float, jump_radius_px: float) -> None:
        self._max_age_s = max_age_s
        self._jumps = JumpFilter(jump_radius_px)

    def configure(self, max_age_s: float, jump_radius_px: float) -> None:
        """Use new limits from now on; what was confirmed stays confirmed."""
        self._max_age_s = max_age_s
        self._jumps.radius_px = jump_radius_px

    def judge(self, record: FrameRecord) -> FrameRecord:
        """Hold back what is too old, and leave out what no second frame confirms."""
        # If the largest object is not confirmed, none is published. Other objects are left out
        # until they are confirmed.
        taken_at = time.monotonic() if record.taken_at is None else record.taken_at
        believed = self._believed(record.objects, taken_at)
        reason = _UNCONFIRMED if believed is None else self._age_reason(taken_at)
        if reason is not None:
            return record._replace(reason=reason)
        return record.without([
            None if any(found is other for other in believed) else _JUMPED
            for found in record.objects])

    def _age_reason(self, taken_at: float) -> Optional[Reason]:
        age_s = time.monotonic() - taken_at
        if age_s <= self._max_age_s:
            return None
        return Reason('too_late', Level.WARN, (
            f'no position is published: detection took too long, the frame is {age_s:.2f} s old, '
            f'at most {self._max_age_s:g} s are allowed: use smaller pictures or a faster '
            'computer, or raise max_frame_age'), is_passing=True)

    def _believed(
        self, objects: Sequence[LocatedObject], taken_at: float
    ) -> Optional[List[LocatedObject]]:
        pixels = [found.detection.centre for found in objects]
        believed = self._jumps.believed(pixels, taken_at)
        confirmed = pixels[0] in believed if pixels else self._jumps.believes_empty()
        return [found for found, pixel in zip(objects, pixels)
                if pixel in believed] if confirmed else None
