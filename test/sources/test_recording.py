# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import itertools

from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.sources.files import VideoFile
from camera_to_base.sources.kinds import DEVICE
from camera_to_base.sources.recording import LiveRecording, PlayedRecording, TimedFrame
import numpy as np
from recordings import disc_frame, write_video


def test_frames_of_a_video_have_their_numbers_and_times(tmp_path):
    source = VideoFile(write_video(tmp_path / 'disc.avi', [None, (60, 60), (90, 90)], fps=25.0))
    recording = PlayedRecording(source, source.frame_count)
    frames = list(recording.frames())
    recording.release()
    assert recording.frame_count == 3 and recording.kind.ends
    assert [(timed.number, timed.stamp_ns, timed.taken_at) for timed in frames] == [
        (0, 0, 0.0), (1, 40_000_000, 0.04), (2, 80_000_000, 0.08)]
    for timed, position in zip(frames, [None, (60, 60), (90, 90)]):
        assert np.abs(timed.frame.astype(int) - disc_frame(position)).mean() < 3


def test_of_a_source_without_an_end_only_so_many_frames_are_read():
    board = SimulatedBoard(image_size=(64, 48), frame_rate=5.0)
    assert [timed.stamp_ns for timed in PlayedRecording(board, 3, last=3).frames()] == [
        0, 200_000_000, 400_000_000]


def test_frames_of_a_camera_have_the_time_of_day_and_their_age():
    class Camera:
        kind = DEVICE

        def read(self):
            return disc_frame(None)

    recording = LiveRecording(Camera())
    first, second = itertools.islice(recording.frames(), 2)
    assert recording.kind.is_live and (first.number, second.number) == (0, 1)
    assert 1.7e18 < first.stamp_ns <= second.stamp_ns and first.taken_at <= second.taken_at


def test_frame_is_decoded_once_and_only_if_asked_for():
    calls = []
    timed = TimedFrame(0, 0, lambda: calls.append(1) or disc_frame(None))
    assert calls == []
    assert timed.frame is timed.frame and calls == [1]
