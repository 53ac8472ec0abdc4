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

"""Opens the source that the parameter `source` names."""

import os
from typing import NamedTuple, Optional

from camera_to_base.errors import FrameSourceError
from camera_to_base.settings.camera import CameraSettings
from camera_to_base.sources import (
    AUTO, BAG, Camera, COMPRESSED_TOPIC, DEVICE, first_camera, FirstCamera, FrameSource, kind_of,
    open_frame_source, open_repeated, RANDOM, SIMULATED, SourceKind, STREAM, TOPIC)


class NamedSource(NamedTuple):
    """
    The source that a name stands for.

    :param name: Its name in messages; for auto, the device that was found.
    :param frames: None if the node itself makes the input: topics and random pixels.
    """

    name: str
    kind: SourceKind
    frames: Optional[FrameSource] = None


def open_named_source(settings: CameraSettings, may_be_random: bool) -> NamedSource:
    """
    Open the source that a camera node's parameter `source` names.

    A named camera is opened by its first read.

    :param may_be_random: Whether auto means random pixels if no camera is attached; otherwise the
        source waits for a camera.
    :raises FrameSourceError: If it names a file that holds no video, or a bag.
    """
    name, kind = settings.source, kind_of(settings.source)
    if kind == AUTO:
        camera = first_camera(settings.image_size)
        if camera is None and may_be_random:
            return NamedSource(name, RANDOM)
        frames = camera or FirstCamera(settings.image_size)
        return NamedSource(frames.name, frames.kind, frames)
    if kind in (RANDOM, TOPIC, COMPRESSED_TOPIC):
        return NamedSource(name, kind)
    if kind == BAG and os.path.exists(os.path.expanduser(name)):
        raise FrameSourceError(
            f"source '{name}' is no video; if it is a bag, `ros2 run camera_to_base locate {name}`"
            ' reads it, or play it (`ros2 bag play`) and name its image topic')
    if kind == SIMULATED:
        frames = settings.simulated.board(settings.image_size)
    elif kind in (DEVICE, STREAM):
        frames = Camera(name, settings.image_size, open_now=False)
    elif settings.repeat:
        frames = open_repeated(os.path.expanduser(name))
    else:
        frames = open_frame_source(name)
    return NamedSource(name, frames.kind, frames)
