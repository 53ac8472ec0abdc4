# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Finds frames that were damaged in transfer; OpenCV reports most of them as good."""

from collections import deque
from typing import Any, Optional, Tuple

from camera_to_base.checks import check_frame
from camera_to_base.detection import changed_blocks, has_changed_block, mean_blocks
from camera_to_base.errors import Level, Reason
from camera_to_base.pipeline.stage import FrameRecord, Stage
import cv2
import numpy as np

_CABLE = 'check its cable and its network, or lower its rate'


def _damage(kind: str, what: str, cure: str = _CABLE) -> Reason:
    return Reason(kind, Level.ERROR, f'{what}: {cure}', is_passing=True)


_REPEATED = _damage(
    'repeated', 'it repeats the last one byte for byte',
    'restart the camera or its driver, and this node where the picture size was changed; a '
    "simulation's driver wants use_sim_time:=true")
_BLACK = _damage('black', 'it is black', 'switch the light on, and uncover the lens')
_OLD_END = _damage('old_end', 'its lower end is that of an earlier one')
_FLAT_END = _damage('flat_end', 'its lower end has one colour')
_LARGE_CHANGE = _damage('large_change', 'a large part of it has changed at once')

# A JPEG loses at least one row of blocks, which is 8 px high.
_TAIL_ROWS = 8
# FFmpeg reuses its buffers: the missing part of a JPEG shows an earlier frame.
_TAIL_COUNT = 16
_LARGEST_SHARE, _LARGEST_BOTTOM_SHARE = 0.25, 0.5
# Colours that decoders give to blocks without data: grey, or the green of YUV 0, 0, 0.
_CONCEALED = (128, 128, 128), (0, 135, 0)
# If the lower end has the same single colour in this many frames in a row, the surface looks like
# that, for example because it is overexposed. If the camera showed more there before, it takes
# the second number of frames.
_USUAL_COUNT, _LATER_USUAL_COUNT = 5, 25
# A video codec copies the blocks that have not changed. Copies lie all over the picture: 0.6 to
# 0.99 of the blocks of quiet MPEG-4 streams of 500 kbit/s. JPEG pictures of the same view have up
# to 0.64 equal blocks (quality 40, hardly any noise), those of a camera without JPEG none.
_BLOCK_PX, _LEAST_COPIED = 16, 0.7
# If the end of a picture was lost, more rows of blocks are equal than by such a chance.
_LEAST_CHANCE, _LEAST_ROW_SHARE = 1e-6, 0.05
# How often in a row a codec may repeat a whole picture: at 25 Hz, for 0.2 s.
_MOST_REPEATED = 5
# An encoder changes such a colour by up to this.
_SAME_COLOUR = 2
# Below these grey levels noise hides all objects: the surface would look empty.
_BLACK_LEVEL = 6
# From this grey level on noise may be cut off.
_OVEREXPOSED = 245


class FrameCheck(Stage):
    """
    The first stage: whether it is a frame, and undamaged.

    :param damage: Compares it with the frames before it. None where a reader has asked that of
        every frame that it read, also of those that it dropped; and for recordings, whose frames
        are not damaged.
    """

    def __init__(self, damage: Optional['DamageCheck'] = None) -> None:
        self._damage = damage

    def judge(self, record: FrameRecord) -> FrameRecord:
        """Check the frame itself."""
        check_frame(record.frame)
        reason = None if self._damage is None else self._damage.reason(record.frame)
        return record if reason is None else record.held(
            reason._replace(sentence=f'the frame cannot be used: {reason.sentence}'))


class DamageCheck:
    """
    Compares each frame of a live camera with the frames before it.

    Because of the sensor's noise, no two pictures are equal, in any part. So a picture whose lower
    end equals an earlier one's to the byte was cut off, and a picture that equals an earlier one
    was not taken anew. A lower end of a single colour was not received. Flipped bits damage all
    data after them: a large change is damage if the next picture does not show it, too. A black
    picture is usually complete, but shows nothing.

    The pictures of a video codec (H.264, MPEG-4) hold copied blocks, scattered over the picture.
    There, a lower end counts as cut off only if more of it is copied than elsewhere.
    """

    def __init__(self) -> None:
        self._shape = None

    def reason(self, frame: np.ndarray) -> Optional[Reason]:
        """
        Return what is wrong with a frame.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :returns: None for an undamaged frame.
        """
        if frame.shape != self._shape:
            self._restart(frame)
        repeated, tail_repeated = self._repetition(frame)
        blocks = mean_blocks(frame)
        if cv2.norm(blocks, cv2.NORM_INF) < _BLACK_LEVEL:
            return _BLACK
        if repeated:
            self._repeated_count += 1
            is_copy = self._has_codec and self._repeated_count <= _MOST_REPEATED
            return None if is_copy else _REPEATED
        self._repeated_count = 0
        if tail_repeated:
            return _OLD_END
        if self._has_lost_its_tail(frame):
            return _FLAT_END
        return self._unconfirmed_change(blocks)

    def _restart(self, frame: np.ndarray) -> None:
        self._shape = frame.shape
        self._last = None
        self._repeated_count, self._has_codec = 0, False
        self._tails = deque(maxlen=_TAIL_COUNT)
        self._flat_tail_count, self._flat_tails_needed = 0, _USUAL_COUNT
        self._flat_colour: Optional[np.ndarray] = None
        self._usual_colour: Optional[np.ndarray] = None
        self._believed = self._doubted = None

    def _repetition(self, frame: np.ndarray) -> tuple:
        tail = frame[-_TAIL_ROWS:]
        content = tail.tobytes()
        is_known = content in self._tails
        repeated = is_known and np.array_equal(frame, self._last)
        # An overexposed edge is equal in undamaged frames, too.
        tail_repeated = is_known and not _is_flat(tail) and (
            repeated or _is_cut_off(*_copied(frame, self._last)))
        if not (repeated or self._last is None or self._has_codec):
            # A strip tells of a whole stream, sooner or later.
            strip = slice(len(frame) // 2, len(frame) // 2 + _BLOCK_PX)
            self._has_codec = _copied_share(
                *_copied(frame[strip], self._last[strip])) >= _LEAST_COPIED
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


def _copied(frame: np.ndarray, before: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """
    Compare whole blocks with those of the frame before, those at the lower edge included.

    :returns: Two arrays of shape (h / 16, w / 16), bool: which are equal, and which tell
        something. A black or overexposed block is equal without having been copied.
    """
    rows, columns = (length // _BLOCK_PX for length in frame.shape[:2])
    part = slice(len(frame) - rows * _BLOCK_PX, None), slice(columns * _BLOCK_PX)
    blocks, others = (picture[part].reshape(rows, _BLOCK_PX, columns, _BLOCK_PX * 3)
                      for picture in (frame, before))
    tells = (blocks.min(axis=(1, 3)) < _OVEREXPOSED) & (blocks.max(axis=(1, 3)) > _BLACK_LEVEL)
    return ~(blocks != others).any(axis=(1, 3)), tells


def _copied_share(is_equal: np.ndarray, tells: np.ndarray) -> float:
    return np.count_nonzero(is_equal & tells) / max(np.count_nonzero(tells), 1)


def _is_cut_off(is_equal: np.ndarray, tells: np.ndarray) -> bool:
    """Tell whether a lower end that is known was not received; see :func:`_copied`."""
    is_whole_row = is_equal.all(axis=1)
    changed = np.flatnonzero(~is_whole_row)
    above = int(changed[-1]) + 1 if len(changed) else 0
    if _copied_share(is_equal[:above], tells[:above]) < _LEAST_COPIED:
        return True
    row_share = max(is_whole_row[:above].mean(), _LEAST_ROW_SHARE)
    return row_share ** (len(is_equal) - above) < _LEAST_CHANCE


def _is_flat(rows: np.ndarray) -> bool:
    # The first row tells of most pictures that they are not.
    colour, width = rows[0, 0].tobytes(), rows.shape[1]
    return rows[0].tobytes() == colour * width and rows.tobytes() == colour * width * len(rows)


def _is_near(colour: np.ndarray, others: Any) -> bool:
    # Others: shape (3,) or (n, 3), or None for none.
    if others is None:
        return False
    distances = np.abs(np.subtract(others, colour, dtype=int)).max(axis=-1)
    return bool((distances <= _SAME_COLOUR).any())


def _differ(blocks: np.ndarray, others: np.ndarray) -> bool:
    if not has_changed_block(blocks, others):
        return False
    changed = changed_blocks(blocks, others)
    return (np.count_nonzero(changed) > _LARGEST_SHARE * changed.size
            or np.count_nonzero(changed[-1]) > _LARGEST_BOTTOM_SHARE * changed.shape[1])
