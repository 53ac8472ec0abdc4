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

"""Opens a camera or a video file by its name."""

import os

from camera_to_base.image_size import DEFAULT_IMAGE_SIZE, ImageSize
from camera_to_base.sources.cameras import Camera
from camera_to_base.sources.files import VideoFile
from camera_to_base.sources.frame_source import FrameSource
from camera_to_base.sources.source_kind import kind_of


def open_frame_source(name: str, image_size: ImageSize = DEFAULT_IMAGE_SIZE) -> FrameSource:
    """
    Open a camera or a video file by its name.

    :param name: A device's index or path, a stream's URL, or a video file.
    :param image_size: The picture size to request from a device, in px.
    :raises FrameSourceError: If it cannot be opened.
    """
    if kind_of(name).is_live:
        return Camera(name, image_size)
    return VideoFile(os.path.expanduser(name))
