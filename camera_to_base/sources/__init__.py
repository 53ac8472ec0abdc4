# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Sources of frames: cameras, streams, video files and bags.

In: the name of a device, a stream, a file or a bag. Out: frames of shape (h, w, 3), uint8, BGR,
each with its capture time, and the status of a source that gives no frames.

Callers: see the arrows in CONTRIBUTING. Nothing here detects or judges objects.
"""

from camera_to_base.sources.cameras import Camera, first_camera, FirstCamera
from camera_to_base.sources.decoding import (
    decode_compressed, frame_from_compressed_message, frame_from_image_message)
from camera_to_base.sources.files import BagFile, open_frame_source, open_repeated, VideoFile
from camera_to_base.sources.kinds import (
    AUTO, BAG, COMPRESSED_TOPIC, DEVICE, FrameSource, is_other_camera, kind_of, lasting_name,
    RANDOM, SIMULATED, SourceKind, STREAM, TOPIC, VIDEO_FILE)
from camera_to_base.sources.reader import FrameReader, is_reader_hanging, TakenFrame
from camera_to_base.sources.recording import (
    LiveRecording, median_frame, PlayedRecording, read_picture, Recording, still_frames,
    TimedFrame)
from camera_to_base.sources.status import (
    LOST_AFTER_S, ReaderFacts, ReaderSnapshot, ReaderState, ReaderStatus, SilenceLimit,
    source_reason, stamp_reason)

__all__ = [
    'AUTO', 'BAG', 'BagFile', 'Camera', 'COMPRESSED_TOPIC', 'decode_compressed', 'DEVICE',
    'first_camera', 'FirstCamera', 'frame_from_compressed_message', 'frame_from_image_message',
    'FrameReader', 'FrameSource', 'is_other_camera', 'is_reader_hanging', 'kind_of',
    'lasting_name', 'LiveRecording', 'LOST_AFTER_S', 'median_frame', 'open_frame_source',
    'open_repeated', 'PlayedRecording', 'RANDOM', 'read_picture', 'ReaderFacts', 'ReaderSnapshot',
    'ReaderState', 'ReaderStatus', 'Recording', 'SilenceLimit', 'SIMULATED', 'source_reason',
    'SourceKind', 'stamp_reason', 'still_frames', 'STREAM', 'TakenFrame', 'TimedFrame', 'TOPIC',
    'VIDEO_FILE', 'VideoFile',
]
