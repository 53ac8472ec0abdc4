# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Locates objects on a work surface with a camera, as points in the robot's base frame.

    from camera_to_base import Cell

    cell = Cell.open('cell.yaml')              # the file that calibrate and the dashboard write
    cell.take_background(frame)                # (h, w, 3) uint8, BGR
    seen = cell.locate(frame)                  # objects in both frames, or a reason

`Cell`, `Seen` and `SeenObject` are loaded where they are first asked for: the transform node
starts without OpenCV.
"""

from importlib import import_module
from typing import Any, List

_OF_CELL = ['Cell', 'Seen', 'SeenObject']
__all__ = _OF_CELL


def __getattr__(name: str) -> Any:
    if name in _OF_CELL:
        return getattr(import_module('camera_to_base.cell'), name)
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')


def __dir__() -> List[str]:
    return sorted([*globals(), *_OF_CELL])
