# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The steps of a calibration on the disk, so that a restart of the dashboard loses none.

They are kept beside the parameter file that they are for, until they are stopped or removed.
"""

import io
import json
import os
import threading
import time
from typing import Any, Dict, List, NamedTuple, Optional
import zipfile

from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.files import write_files
import cv2
import numpy as np

_STEPS = 'steps.json'
# A file that somebody has made larger is not read.
_LARGEST_BYTES, _MOST_IMAGES = 300_000_000, 40
_RETRY_S = 5.0


class Steps(NamedTuple):
    """
    What people have measured, and not saved yet.

    :param board: The board session's, as JSON.
    :param robot: The robot session's, as JSON.
    :param prove: The proofs, as JSON.
    :param images: The pictures of the placements, each of shape (h, w, 3), uint8, BGR.
    """

    board: Dict[str, Any]
    robot: Dict[str, Any]
    prove: List[Any]
    images: List[np.ndarray]

    def is_same(self, other: Optional['Steps']) -> bool:
        """Return whether nothing has changed; the pictures are never drawn into."""
        return other is not None and self[:3] == other[:3] and (
            list(map(id, self.images)) == list(map(id, other.images)))

    @property
    def is_empty(self) -> bool:
        """Whether nothing is measured."""
        return not (self.images or self.robot['pairs'] or self.prove)


class KeptSteps:
    """
    A file with steps.

    :param params_file: The parameter file that they are for; '' for none, then nothing is kept.

    `problem` says why the newest steps are not on the disk; None if they are.
    """

    def __init__(self, params_file: str) -> None:
        folder, name = os.path.split(params_file)
        self.path = os.path.join(folder, f'.{name}.steps') if name else ''
        self._newest: Optional[Steps] = None
        self._is_written, self._writing = True, threading.Lock()
        self._pngs: Dict[int, bytes] = {}
        self._tried_at = 0.0
        self.problem: Optional[str] = None

    def read(self) -> Optional[Steps]:
        """Return what was kept; None for nothing, or what cannot be read."""
        try:
            if not self.path or os.path.getsize(self.path) > _LARGEST_BYTES:
                return None
            with zipfile.ZipFile(self.path) as file:
                content = json.loads(file.read(_STEPS))
                images = [_decoded(file.read(f'{number}.png'))
                          for number in range(min(int(content['images']), _MOST_IMAGES))]
            # Files of before have no proofs.
            return Steps(dict(content['board']), dict(content['robot']),
                         list(content.get('prove', ())), images)
        except (OSError, KeyError, TypeError, ValueError, zipfile.BadZipFile, cv2.error):
            return None

    def see(self, steps: Steps) -> bool:
        """Take the newest steps; return whether they are to be written."""
        if not self.path:
            return False
        if steps.is_same(self._newest):
            # The disk may have room again.
            return not self._is_written and time.monotonic() - self._tried_at > _RETRY_S
        self._newest, self._is_written = steps, False
        return True

    def write(self) -> None:
        """
        Write the newest steps, unless they are written.

        A disk that is full or read-only is no reason to stop: the steps are in memory, too.
        """
        with self._writing:
            self._write()

    def _write(self) -> None:
        if self._is_written:
            return
        steps, self._is_written = self._newest, True
        self._tried_at = time.monotonic()
        try:
            if not steps.is_empty:
                write_files({self.path: self._content(steps)})
            elif os.path.exists(self.path):
                os.remove(self.path)
            self.problem = None
        except (CameraToBaseError, OSError) as error:
            self.problem, self._is_written = str(error), False

    def _content(self, steps: Steps) -> bytes:
        self._pngs = {id(image): self._pngs.get(id(image)) or _png(image)
                      for image in steps.images}
        content = io.BytesIO()
        with zipfile.ZipFile(content, 'w') as file:
            file.writestr(_STEPS, json.dumps({
                'board': steps.board, 'robot': steps.robot, 'prove': steps.prove,
                'images': len(steps.images)}))
            for number, image in enumerate(steps.images):
                file.writestr(f'{number}.png', self._pngs[id(image)])
        return content.getvalue()


def _png(image: np.ndarray) -> bytes:
    return cv2.imencode('.png', image)[1].tobytes()


def _decoded(png: bytes) -> np.ndarray:
    image = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)
    if image is None:
        raise InvalidValueError('expected a picture, got other bytes')
    return image


class History:
    """
    What can be undone: the state before each removal.

    :param most: How many are kept.
    """

    def __init__(self, most: int = 20) -> None:
        self._most = most
        self._former: List[Any] = []

    @property
    def sentence(self) -> Optional[str]:
        """What the next :meth:`pop` undoes; None for nothing."""
        return self._former[-1][0] if self._former else None

    def push(self, sentence: str, state: Any) -> None:
        """Remember a state; `sentence` says what is done to it now."""
        self._former = [*self._former, (sentence, state)][-self._most:]

    def pop(self) -> Any:
        """
        Return the state before the last removal; it is forgotten.

        :raises InvalidValueError: If there is none.
        """
        if not self._former:
            raise InvalidValueError('there is nothing to undo')
        return self._former.pop()[1]
