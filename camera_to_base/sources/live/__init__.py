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
A camera that is read all the time: the newest frame, its age, and whether the camera is lost.

In: a frame source, or the times at which a driver's pictures arrive. Out: fresh frames, the status
of the source, and the reason why no good frame arrives.

Callers: the modules of `sources`.
"""

from camera_to_base.sources.live.reader import FrameReader, is_reader_hanging, TakenFrame
from camera_to_base.sources.live.reader_status import (
    LOST_AFTER_S, ReaderFacts, ReaderSnapshot, ReaderState, ReaderStatus)
from camera_to_base.sources.live.silence_limit import SilenceLimit
from camera_to_base.sources.live.source_reasons import source_reason
from camera_to_base.sources.live.stamp_check import stamp_reason

__all__ = [
    'FrameReader', 'is_reader_hanging', 'LOST_AFTER_S', 'ReaderFacts', 'ReaderSnapshot',
    'ReaderState', 'ReaderStatus', 'SilenceLimit', 'source_reason', 'stamp_reason', 'TakenFrame',
]
