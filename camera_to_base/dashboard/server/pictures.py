# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Pictures on their way to pages: the newest ones alone, and smaller ones on a slow network."""

import time
from typing import Any, Callable, Dict, NamedTuple, Optional, Protocol, Set, Tuple

import cv2
import numpy as np

Key = Tuple[str, str]

# Shares of a picture's width: each has about a third of the bytes of the one before.
_SCALES = (1.0, 0.5, 0.25, 0.125)
_QUALITY = 70
# A page asks for the next picture 0.07 s after it has shown one.
_SLOW_S, _FAST_S = 0.8, 0.3
# Otherwise every second picture is one that is too large.
_BARRED_S = 10.0


class Picture(NamedTuple):
    """
    A picture file in memory.

    :param number: Counts the pictures of a kind.
    :param stamp_s: When it was taken; 0 if that is not known.
    """

    number: int
    content: bytes
    stamp_s: float = 0.0

    @property
    def age_ms(self) -> Optional[int]:
        """Time since it was taken; None if that is not known."""
        return round(1e3 * (time.time() - self.stamp_s)) if self.stamp_s else None


class Watcher(Protocol):
    """
    A page that looks at a kind of picture.

    `wants` is whether it waits for a picture, `last` the number of the last one that it got.
    """

    wants: bool
    last: int

    def show(self, picture: Picture) -> None:
        """Send a picture."""


class PictureHub:
    """
    Passes each picture on to the pages that wait for one; no page has more than one on its way.

    :param look_at: Called with a cell and a kind when the first page looks.
    :param look_away: Called likewise when the last one has gone.
    """

    def __init__(
        self, look_at: Callable[[str, str], None], look_away: Callable[[str, str], None]
    ) -> None:
        self._look_at, self._look_away = look_at, look_away
        self._newest: Dict[Key, Picture] = {}
        self._watchers: Dict[Key, Set[Watcher]] = {}

    def add(self, key: Key, watcher: Watcher) -> None:
        """Let a page look at a kind of picture."""
        if key not in self._watchers:
            self._watchers[key] = set()
            self._look_at(*key)
        self._watchers[key].add(watcher)

    def remove(self, key: Key, watcher: Watcher) -> None:
        """End that."""
        watchers = self._watchers.get(key, set())
        watchers.discard(watcher)
        if not watchers and self._watchers.pop(key, None) is not None:
            self._newest.pop(key, None)
            self._look_away(*key)

    def want(self, key: Key, watcher: Watcher) -> None:
        """Send the page the newest picture that it does not have, now or when it comes."""
        watcher.wants = True
        self._serve(key, watcher)

    def put(self, key: Key, content: bytes, stamp_s: float = 0.0) -> None:
        """Keep a new picture, and send it to those who wait."""
        if key in self._watchers:
            before = self._newest.get(key)
            self._newest[key] = Picture(before.number + 1 if before else 1, content, stamp_s)
            for watcher in self._watchers[key]:
                self._serve(key, watcher)

    def _serve(self, key: Key, watcher: Watcher) -> None:
        newest = self._newest.get(key)
        if watcher.wants and newest is not None and newest.number != watcher.last:
            watcher.wants, watcher.last = False, newest.number
            watcher.show(newest)


class Line:
    """Measures how fast pictures get to a page, and chooses their size."""

    def __init__(self) -> None:
        # The first picture shows how fast the network is; a small one is there soon.
        self._level = 2
        self._sent_at: Optional[float] = None
        self._took_s = 0.0
        # The last size that was too slow, and until when it is not tried again.
        self._barred: Tuple[int, float] = -1, 0.0

    def sent(self, picture: Picture) -> Tuple[bytes, Dict[str, Any]]:
        """
        Choose the size of a picture that is sent now.

        :returns: The picture file, and what the page is told: the camera's width and height if the
            picture is made smaller, and its age when it is there.
        """
        self._sent_at = time.monotonic()
        age = picture.age_ms
        told = {'age_ms': None if age is None else round(age + 1e3 * self._took_s)}
        image = None if self._level == 0 else cv2.imdecode(
            np.frombuffer(picture.content, np.uint8), cv2.IMREAD_COLOR)
        if image is None:
            return picture.content, told
        height, width = image.shape[:2]
        scale = _SCALES[self._level]
        small = cv2.resize(image, (max(1, round(width * scale)), max(1, round(height * scale))),
                           interpolation=cv2.INTER_AREA)
        content = cv2.imencode('.jpg', small, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])[1].tobytes()
        return content, {**told, 'width': width, 'height': height}

    def arrived(self) -> None:
        """Take note that the page has shown the last picture."""
        if self._sent_at is None:
            return
        now = time.monotonic()
        self._took_s = now - self._sent_at
        self._sent_at = None
        barred, until = self._barred
        if self._took_s > _SLOW_S:
            self._barred = self._level, now + _BARRED_S
            self._level = min(self._level + 1, len(_SCALES) - 1)
        elif self._took_s < _FAST_S and (self._level - 1 != barred or now > until):
            self._level = max(self._level - 1, 0)
