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

"""Opens what the parameter source names."""

from typing import Optional

from camera_to_base.settings.camera import CameraSettings
from camera_to_base.sources import Camera, first_camera, FrameSource, is_camera, open_frame_source

TOPIC_SOURCES = ('topic', 'compressed_topic')


def open_named_source(settings: CameraSettings) -> Optional[FrameSource]:
    """
    Open what a camera node's parameter source names.

    A camera that is named is opened by its first read.

    :returns: None where no frame is read: for topics, and where pixels are random.
    :raises FrameSourceError: If it names a file that holds no video.
    """
    name, image_size = settings.source, settings.image_size
    if name == 'simulated':
        return settings.simulated.board(image_size)
    if name == 'auto':
        return first_camera(image_size)
    if name in ('random', *TOPIC_SOURCES):
        return None
    if is_camera(name):
        return Camera(name, image_size, open_now=False)
    return open_frame_source(name)
