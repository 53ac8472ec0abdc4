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
Files that hold frames: videos, bags, and files that are played again when they have ended.

In: a path. Out: a frame source or a recording.

Callers: the modules of `sources`.
"""

from camera_to_base.sources.files.bag_file import BagFile
from camera_to_base.sources.files.repeated_file import open_repeated
from camera_to_base.sources.files.video_file import VideoFile

__all__ = ['BagFile', 'open_repeated', 'VideoFile']
