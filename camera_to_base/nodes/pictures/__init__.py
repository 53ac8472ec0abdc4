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

"""
The pictures that a camera node publishes while somebody subscribes to them.

In: frames, and what was found in them. Out: raw and compressed image messages.

Caller: `nodes.camera_publisher`.
"""

from camera_to_base.nodes.pictures.camera_pictures import CameraPictures
from camera_to_base.nodes.pictures.debug_images import DebugImages

__all__ = ['CameraPictures', 'DebugImages']
