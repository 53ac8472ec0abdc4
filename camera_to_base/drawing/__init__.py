# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Drawing: pictures of the objects found, and picture files.

In: frames, located objects and labels. Out: annotated pictures and videos, masks, and the file
with the background for the next start.

Callers: `nodes` and `commands`.
"""

from camera_to_base.drawing.files import (
    AnnotatedVideo, BackgroundFile, check_picture_path, check_video_path, encoded_picture)
from camera_to_base.drawing.pictures import (
    AreaOverlay, draw_ellipses, draw_left_out, draw_note, draw_objects, Label, object_label,
    object_mask)

__all__ = [
    'AnnotatedVideo', 'AreaOverlay', 'BackgroundFile', 'check_picture_path', 'check_video_path',
    'draw_ellipses', 'draw_left_out', 'draw_note', 'draw_objects', 'encoded_picture', 'Label',
    'object_label', 'object_mask',
]
