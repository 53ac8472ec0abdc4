# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under

"""
Recordings of the camera: short videos beside the parameter file, to be played as the source.

The first frames of a recording show the background in use: a node that plays it takes its first
frames as the background, and finds the same objects.
"""

import os
import re
import time
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple

from camera_to_base.checks import finite_number
from camera_to_base.dashboard.sessions.values import CellValues, sentence_of, Worker
from camera_to_base.errors import InvalidValueError
import cv2
import numpy as np

LONGEST_S = 60.0
# As many recordings of a cell are kept, and each has at most so many bytes of pictures.
KEPT = 3
_MOST_BYTES = 200_000_000
# What must stay free on the disk.
_FREE_BYTES = 500_000_000
_FEWEST_FRAMES, _MOST_BACKGROUNDS = 2, 100
_QUALITY = 95


class RecordSession:
    """
    Records the camera's frames for a while, and writes them as a video.

    :param values: The cell's parameters.
    :param file_path: Returns the cell's parameter file, whose folder it writes in and whose name a
        recording begins with.
    :param worker: Ends the recording in time, and writes.
    :param on_change: Called when the state has changed.
    """

    def __init__(
        self, values: CellValues, file_path: Callable[[], Tuple[str, str]], worker: Worker,
        on_change: Callable[[], None],
    ) -> None:
        self._values, self._file_path = values, file_path
        self._worker, self._on_change = worker, on_change
        self._background: Optional[bytes] = None
        self._frames: Optional[List[Tuple[float, bytes]]] = None
        self._length_s, self._began_at, self._bytes = LONGEST_S, 0.0, 0
        self._is_writing = False
        self._error: Optional[str] = None
        self._sentence: Optional[str] = None

    @property
    def wants_frames(self) -> bool:
        """Whether :meth:`see` is to be called."""
        return self._frames is not None

    @property
    def state(self) -> Dict[str, Any]:
        """The state as JSON."""
        step = 'recording' if self.wants_frames else 'writing' if self._is_writing else 'off'
        seconds = round(time.monotonic() - self._began_at) if self.wants_frames else 0
        return {'step': step, 'seconds': seconds, 'of': self._length_s, 'error': self._error,
                'frames': len(self._frames or ()), 'sentence': self._sentence}

    @property
    def actions(self) -> Dict[str, Callable[[Mapping[str, Any]], None]]:
        """What a page can ask for, by name."""
        return {'start': self.start, 'stop': self.stop}

    def start(self, body: Mapping[str, Any]) -> None:
        """
        Record from now on.

        :param body: {'seconds': how long, 60 at most}, or {}.
        :raises InvalidValueError: If it records already, or the disk is full.
        """
        if self.wants_frames or self._is_writing:
            raise InvalidValueError('a recording is being made: wait until it is written')
        length = finite_number('seconds', body.get('seconds', LONGEST_S), 1.0, LONGEST_S)
        folder, _ = self._file_path()
        free = _free_bytes(folder)
        if free < _FREE_BYTES:
            raise InvalidValueError(f'{folder} has {free / 1e6:.0f} MB free, a recording needs '
                                    f'{_FREE_BYTES / 1e6:.0f} MB: make room')
        self._length_s, self._began_at, self._bytes = length, time.monotonic(), 0
        self._error = self._sentence = self._background = None
        frames = self._frames = []
        self._worker.later(length, lambda: self._frames is frames and self.stop({}))
        self._on_change()

    def see(self, jpeg: bytes) -> None:
        """Take the newest frame."""
        if self._frames is None:
            return
        self._frames.append((time.monotonic(), jpeg))
        self._bytes += len(jpeg)
        if self._bytes > _MOST_BYTES:
            self.stop({})
        else:
            self._on_change()

    def see_background(self, png: bytes) -> None:
        """Take the background in use."""
        self._background = png

    def stop(self, body: Mapping[str, Any]) -> None:
        """
        End the recording, and write it.

        :raises InvalidValueError: If nothing is recorded.
        """
        if self._frames is None:
            raise InvalidValueError('nothing is being recorded')
        frames, self._frames = self._frames, None
        if len(frames) < _FEWEST_FRAMES:
            self._error = 'no pictures come from the camera node: nothing was recorded'
        else:
            self._is_writing = True
            folder, stem = self._file_path()
            first = [self._background] * self._background_count if self._background else []
            self._worker.run(lambda: write_recording(folder, stem, frames, first), self._take)
        self._on_change()

    @property
    def _background_count(self) -> int:
        # As many as a node takes the background from.
        wanted = (self._values.camera or {}).get('background_frames', 1)
        return min(int(wanted), _MOST_BACKGROUNDS)

    def _take(self, written: Any) -> None:
        self._is_writing = False
        if isinstance(written, Exception):
            self._error = sentence_of(written)
        else:
            self._sentence = (
                f'{written} is written. To play it as the camera, start the camera node with: '
                f'-p source:={written} -p repeat:=true')
        self._on_change()


def _free_bytes(folder: str) -> int:
    try:
        disk = os.statvfs(folder)
    except OSError:
        return 0
    return disk.f_bavail * disk.f_frsize


def write_recording(
    folder: str, stem: str, frames: List[Tuple[float, bytes]], first: Sequence[bytes] = ()
) -> str:
    """
    Write frames as a video, and remove the oldest of more than KEPT recordings.

    :param stem: What the file's name begins with.
    :param frames: When each came, in s, and its JPEG; those of another size are left out.
    :param first: Pictures before them.
    :returns: The video's path.
    :raises InvalidValueError: If it cannot be written.
    """
    name = time.strftime(f'{stem}_recording_%Y%m%d_%H%M%S.avi')
    path, part = os.path.join(folder, name), os.path.join(folder, f'.{name}.part.avi')
    rate = (len(frames) - 1) / max(frames[-1][0] - frames[0][0], 1e-3)
    try:
        jpegs = [jpeg for _, jpeg in frames]
        if _size(first[:1]) == _size(jpegs):
            jpegs = [*first, *jpegs]
        _encode(part, jpegs, min(max(rate, 1.0), 60.0))
        os.replace(part, path)
    except OSError as error:
        raise InvalidValueError(f"'{path}' cannot be written: {error.strerror}") from error
    finally:
        if os.path.lexists(part):
            os.remove(part)
    own = re.compile(re.escape(stem) + r'_recording_\d{8}_\d{6}\.avi')
    for old in sorted(filter(own.fullmatch, os.listdir(folder)))[:-KEPT]:
        os.remove(os.path.join(folder, old))
    return path


def _size(pictures: Sequence[bytes]) -> Optional[Tuple[int, int]]:
    sizes = (_decoded(one).shape[:2] for one in pictures if _decoded(one) is not None)
    return next(sizes, None)


def _decoded(picture: bytes) -> Optional[np.ndarray]:
    return cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_COLOR) if picture else None


def _encode(path: str, jpegs: List[bytes], rate_hz: float) -> None:
    writer, size = None, None
    try:
        for jpeg in jpegs:
            frame = _decoded(jpeg)
            if frame is None or size not in (None, frame.shape[1::-1]):
                continue
            if writer is None:
                size = frame.shape[1::-1]
                writer = cv2.VideoWriter(
                    path, cv2.CAP_OPENCV_MJPEG, cv2.VideoWriter_fourcc(*'MJPG'), rate_hz, size)
                writer.set(cv2.VIDEOWRITER_PROP_QUALITY, _QUALITY)
                if not writer.isOpened():
                    raise InvalidValueError(f"'{path}' cannot be written: is the disk read-only?")
            writer.write(frame)
    finally:
        if writer is not None:
            writer.release()
