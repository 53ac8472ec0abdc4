# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Takes the background: the surface without an object, as the median of frames that agree."""

from typing import List, Optional, Sequence

from camera_to_base.checks import check_frame, check_same_size
from camera_to_base.errors import InvalidValueError, Level, Reason
import cv2
import numpy as np

_MASK = np.outer([1.0, -2.0, 1.0], [1.0, -2.0, 1.0])

_BLOCK_PX = 16
_BLOCK_CHANGE = 12.0

# Two frames of which a larger share differs do not agree. A coin that moves changes 1 % of it; a
# damaged frame or a hand in motion changes more.
_LARGEST_SHARE = 0.05
# Nor do two whose brightness differs by a larger share: the exposure is still settling.
_LARGEST_STEP = 0.05
# The first frames of a camera may be dark. With a background of 10 grey levels the precise
# detector is accurate to 0.03 px at full light; with one of 4 it finds hundreds of specks.
_DARKEST = 8.0


def white_noise(grey: np.ndarray, step: int = 1) -> float:
    """
    Estimate the standard deviation of a pixel's noise, in levels.

    J. Immerkaer, Fast noise variance estimation, 1996, with the median for the mean: edges count
    for little.

    :param grey: Shape (h, w), float32.
    :param step: Of so many columns and rows only one is asked.
    """
    if min(grey.shape) < len(_MASK):
        return 0.0
    second = cv2.filter2D(grey, cv2.CV_32F, _MASK)[::step, ::step]
    return float(np.median(np.abs(second))) / 0.6745 / 6


def smoothed_noise(grey: np.ndarray, sigma: float, step: int = 1) -> float:
    """Estimate what a Gaussian filter leaves of it; see :func:`white_noise`."""
    return white_noise(grey, step) / (2 * np.sqrt(np.pi) * sigma)


def mean_blocks(frame: np.ndarray) -> np.ndarray:
    """
    Return about the mean of each block of a frame, from every eighth row.

    Rows and columns at the top and at the right that do not fill a block are left out.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :returns: Shape (h / 16, w / 16, 3), uint8.
    """
    columns, rows = (length // _BLOCK_PX for length in frame.shape[1::-1])
    if not rows or not columns:
        size = max(1, columns), max(1, rows)
        return cv2.resize(frame, size, interpolation=cv2.INTER_AREA)
    # OpenCV is many times faster at halving a picture than at any other ratio.
    blocks = cv2.resize(frame[3 - _BLOCK_PX * rows::8, :_BLOCK_PX * columns], (8 * columns, rows),
                        interpolation=cv2.INTER_AREA)
    return cv2.resize(blocks, (columns, rows), interpolation=cv2.INTER_AREA)


def changed_blocks(blocks: np.ndarray, others: np.ndarray) -> np.ndarray:
    """
    Return which blocks differ by more than flickering light does.

    :param blocks: See :func:`mean_blocks`; `others` is of the same shape.
    :returns: Shape (h / 16, w / 16), bool.
    """
    calm = cv2.inRange(cv2.absdiff(blocks, others), 0, (_BLOCK_CHANGE,) * 3)
    return calm == 0


def has_changed_block(blocks: np.ndarray, others: np.ndarray) -> bool:
    """Return whether any block has changed, see :func:`changed_blocks`, in a tenth of its time."""
    return cv2.norm(blocks, others, cv2.NORM_INF) > _BLOCK_CHANGE


def _waiting(kind: str, cure: str) -> Reason:
    return Reason(kind, Level.WARN, f'taking the background: {cure}')


_MISSING = _waiting('background_missing', 'keep the surface clear')
_DARK = _waiting(
    'background_dark', 'the picture is black: switch the light on, and uncover the lens')
_UNSETTLED = _waiting(
    'background_unsettled', 'the pictures differ: let nothing move on the surface')


# Limit of the memory for the frames: 200 at 640 x 480 px, 32 at 1920 x 1080 px.
_MOST_BYTES = 200_000_000
# A median of fewer frames may show a moving hand.
_FEWEST = 9


class BackgroundTaker:
    """
    Collects frames until there are enough for a background, or no more fit into 200 MB.

    `reason` is why there is no background yet, `taken_count` the number of its frames.

    :param count: Number of frames; 1 takes the next frame as it is, as the tutorial does.
    """

    def __init__(self, count: int) -> None:
        self._count = count
        self._frames: List[np.ndarray] = []
        self._doubted: Optional[np.ndarray] = None
        self.taken_count = 0
        self.reason: Reason = _MISSING

    def add(self, frame: np.ndarray, confirm: bool = False) -> Optional[np.ndarray]:
        """
        Add a frame; a frame of another size discards the earlier ones.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param confirm: Whether a frame counts only if the next one agrees with it: a camera's
            frame may be damaged or dark.
        :returns: The background, of the same shape, once there are enough frames.
        """
        if confirm:
            frame, self._doubted = self._confirmed(frame), frame
            if frame is None:
                return None
        if self._frames and self._frames[0].shape != frame.shape:
            self._frames.clear()
        self._frames.append(frame)
        if len(self._frames) < min(self._count, max(_FEWEST, _MOST_BYTES // frame.nbytes)):
            return None
        self.taken_count = len(self._frames)
        return _median(self._frames)

    @property
    def is_unsettled(self) -> bool:
        """Whether the last two frames differ too much."""
        return self.reason is _UNSETTLED

    def begun_again(self, frame: np.ndarray) -> 'BackgroundTaker':
        """
        Give one that begins with a frame, which the next one must agree with.

        :param frame: Shape (h, w, 3), uint8, BGR, the last one that was added.
        """
        taker = BackgroundTaker(self._count)
        taker._doubted = frame
        return taker

    def _confirmed(self, frame: np.ndarray) -> Optional[np.ndarray]:
        # Returns the previous frame, if this one agrees with it.
        before = self._doubted
        self.reason = _MISSING
        if max(frame.mean(axis=(0, 1))) < _DARKEST:
            self.reason = _DARK
        elif before is not None and not _agree(before, frame):
            self.reason = _UNSETTLED
        return before if self.reason is _MISSING else None


def median_of(frames: Sequence[np.ndarray]) -> np.ndarray:
    """
    Make a background of frames of the empty surface.

    :param frames: Each of shape (h, w, 3), uint8, BGR, all of one size.
    :returns: Their median, of the same shape.
    :raises InvalidValueError: If there is none, or one of them is no frame.
    :raises FrameSizeError: If their sizes differ.
    """
    if not frames:
        raise InvalidValueError('a background needs at least one frame')
    for frame in frames:
        check_frame(frame)
        check_same_size(frame, frames[0])
    return _median(frames)


def _agree(frame: np.ndarray, other: np.ndarray) -> bool:
    if frame.shape != other.shape:
        return False
    is_settled = abs(frame.mean() - other.mean()) <= _LARGEST_STEP * frame.mean()
    return is_settled and changed_blocks(
        mean_blocks(frame), mean_blocks(other)).mean() <= _LARGEST_SHARE


def _median(frames: Sequence[np.ndarray]) -> np.ndarray:
    if len(frames) == 1:
        return frames[0]
    # Row by row: the median of a whole stack of many large frames would not fit into memory.
    rows = [np.median([frame[row] for frame in frames], axis=0) for row in range(len(frames[0]))]
    return np.rint(rows).astype(np.uint8)
