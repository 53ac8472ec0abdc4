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

"""Finds frames that were damaged on their way: OpenCV says True for most of these."""

from collections import deque
from typing import Any, Optional

from camera_to_base.detection import changed_blocks, mean_blocks
from camera_to_base.reason import Level, Reason
import numpy as np

_CABLE = 'check its cable and its network, or lower its rate'


def _damage(kind: str, what: str, cure: str = _CABLE) -> Reason:
    return Reason(kind, Level.ERROR, f'{what}: {cure}', is_passing=True)


_REPEATED = _damage(
    'repeated', 'it repeats the last one byte for byte',
    "restart the camera or its driver; a simulation's driver wants use_sim_time:=true")
_BLACK = _damage('black', 'it is black', 'switch the light on, and uncover the lens')
_OLD_END = _damage('old_end', 'its lower end is that of an earlier one')
_FLAT_END = _damage('flat_end', 'its lower end has one colour')
_LARGE_CHANGE = _damage('large_change', 'a large part of it has changed at once')

# JPEG's blocks are 8 px high: less than this cannot be lost.
_TAIL_ROWS = 8
# FFmpeg decodes into buffers that it uses again: what a JPEG lacks is an earlier frame's.
_TAIL_COUNT = 16
_LARGEST_SHARE, _LARGEST_BOTTOM_SHARE = 0.25, 0.5
# What decoders make of blocks that they have no data for: grey, or the green of YUV 0, 0, 0.
_CONCEALED = (128, 128, 128), (0, 135, 0)
# A lower end that has the same one colour in as many frames in a row is the surface's own:
# overexposed, say. A camera that has shown more there before must prove it for longer.
_USUAL_COUNT, _LATER_USUAL_COUNT = 5, 25
# As different as an encoder makes such a colour.
_SAME_COLOUR = 2
# Below these grey levels nothing can be told from noise: the surface would look empty.
_BLACK_LEVEL = 6


class DamageCheck:
    """
    Judges each frame of a live camera against the ones before it.

    A sensor's noise makes every picture, and every part of it, new. So a picture whose lower end
    is an earlier one's to the byte was cut off; one that is that altogether was not taken anew;
    and a lower end of one colour was never received. Flipped bits spoil all that follows them: a
    large change that the next picture does not share is damage, one that it shares is real.
    A black picture is whole, as a rule, but shows nothing.
    """

    def __init__(self) -> None:
        self._shape = None

    def reason(self, frame: np.ndarray) -> Optional[Reason]:
        """
        Tell what is wrong with a frame.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :returns: None for a frame that can be believed.
        """
        if frame.shape != self._shape:
            self._restart(frame)
        repeated, tail_repeated = self._repetition(frame)
        blocks = mean_blocks(frame)
        if blocks.max() < _BLACK_LEVEL:
            return _BLACK
        if repeated:
            return _REPEATED
        if tail_repeated:
            return _OLD_END
        if self._has_lost_its_tail(frame):
            return _FLAT_END
        return self._unconfirmed_change(blocks)

    def _restart(self, frame: np.ndarray) -> None:
        self._shape = frame.shape
        self._last = None
        self._tails = deque(maxlen=_TAIL_COUNT)
        self._flat_tail_count, self._flat_tails_needed = 0, _USUAL_COUNT
        self._flat_colour: Optional[np.ndarray] = None
        self._usual_colour: Optional[np.ndarray] = None
        self._believed = self._doubted = None

    def _repetition(self, frame: np.ndarray) -> tuple:
        tail = frame[-_TAIL_ROWS:]
        content = tail.tobytes()
        repeated = self._last is not None and np.array_equal(frame, self._last)
        # An overexposed edge repeats by itself.
        tail_repeated = content in self._tails and not _is_flat(tail)
        self._last = frame
        self._tails.append(content)
        return repeated, tail_repeated

    def _has_lost_its_tail(self, frame: np.ndarray) -> bool:
        tail = frame[-_TAIL_ROWS:]
        if not _is_flat(tail):
            self._flat_tail_count, self._flat_tails_needed = 0, _LATER_USUAL_COUNT
            return False
        colour = tail[0, 0]
        if _is_near(colour, _CONCEALED) or _is_flat(frame):
            return True
        if not _is_near(colour, self._usual_colour):
            self._count_flat_tail(colour)
        return not _is_near(colour, self._usual_colour)

    def _count_flat_tail(self, colour: np.ndarray) -> None:
        same = _is_near(colour, self._flat_colour)
        self._flat_tail_count = self._flat_tail_count + 1 if same else 1
        self._flat_colour = colour
        if self._flat_tail_count >= self._flat_tails_needed:
            self._usual_colour = colour

    def _unconfirmed_change(self, blocks: np.ndarray) -> Optional[Reason]:
        if (self._believed is None or not _differ(blocks, self._believed)
                or self._doubted is not None and not _differ(blocks, self._doubted)):
            self._believed, self._doubted = blocks, None
            return None
        self._doubted = blocks
        return _LARGE_CHANGE


def _is_flat(rows: np.ndarray) -> bool:
    return bool((rows == rows[0, 0]).all())


def _is_near(colour: np.ndarray, others: Any) -> bool:
    # Others: shape (3,) or (n, 3), or None for none.
    if others is None:
        return False
    distances = np.abs(np.subtract(others, colour, dtype=int)).max(axis=-1)
    return bool((distances <= _SAME_COLOUR).any())


def _differ(blocks: np.ndarray, others: np.ndarray) -> bool:
    changed = changed_blocks(blocks, others)
    return changed.mean() > _LARGEST_SHARE or changed[-1].mean() > _LARGEST_BOTTOM_SHARE
