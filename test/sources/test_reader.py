# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import os
from pathlib import Path
import subprocess
import sys
import threading
import time

from camera_to_base.errors import FrameSourceError, Level, Reason
from camera_to_base.sources.cameras import Camera
from camera_to_base.sources.reader import FrameReader
from camera_to_base.sources.status import ReaderState
from mjpeg_server import MjpegServer
import numpy as np
import pytest
from rtsp_server import KeepingRtspServer, RtspServer
import scenes

ODD = Reason('odd', Level.ERROR, 'its first level is odd')
both_servers = pytest.mark.parametrize('server_class', [MjpegServer, RtspServer])

END_WHILE_IT_HANGS = """
import sys
import time
from camera_to_base.sources import Camera, FrameReader
import scenes
import mjpeg_server
import rtsp_server

server_class = {'mjpeg': mjpeg_server.MjpegServer, 'rtsp': rtsp_server.RtspServer}[sys.argv[1]]
with server_class(scenes.coin()) as server:
    reader = FrameReader(Camera(server.url, open_now=False))
    while reader.counts.read < 3:
        time.sleep(0.01)
    server.freeze()
    time.sleep(float(sys.argv[2]))
    begin = time.monotonic()
    closed = reader.close()
    print('closed', closed, round(time.monotonic() - begin, 2))
"""


class Numbers:
    """A camera whose frames are numbered; what it is told to do in their place it does."""

    def __init__(self, *instead, wait=0.01):
        self._instead = list(instead)
        self._wait = wait
        self.number = 0
        self.threads = set()
        self.read_at = []
        self.released = 0

    def read(self):
        self.threads.add(threading.current_thread().name)
        self.read_at.append(time.monotonic())
        time.sleep(self._wait)
        if self._instead:
            instead = self._instead.pop(0)
            if isinstance(instead, Exception):
                raise instead
        self.number += 1
        return np.full((4, 4, 3), self.number % 256, np.uint8)

    def release(self):
        self.threads.add(threading.current_thread().name)
        self.released += 1


def wait_until(condition, timeout=5.0):
    until = time.monotonic() + timeout
    while time.monotonic() < until:
        if condition():
            return True
        time.sleep(0.005)
    return False


@pytest.fixture
def read():
    readers = []

    def start(camera, **options):
        readers.append(FrameReader(camera, **{'may_lag': False, **options}))
        return readers[-1]

    yield start
    for reader in readers:
        assert reader.close()


def test_newest_frame_wins_and_is_given_once(read):
    camera = Numbers()
    reader = read(camera)
    assert wait_until(lambda: camera.number >= 10)
    taken = reader.take()
    assert taken.image[0, 0, 0] >= 9
    assert time.monotonic() - taken.taken_at < 0.1
    assert reader.counts.overwritten >= 8
    following = reader.take()
    assert following is None or following.image[0, 0, 0] > taken.image[0, 0, 0]


def test_only_the_readers_thread_touches_the_camera(read):
    camera = Numbers(FrameSourceError('away'))
    reader = read(camera)
    assert wait_until(lambda: camera.number > 2)
    reader.close()
    assert camera.threads == {'frame reader'}


@pytest.mark.slow
def test_states_are_waiting_running_and_lost(read):
    camera = Numbers(FrameSourceError('not there'), None, None, FrameSourceError('unplugged'))
    reader = read(camera)
    seen = []
    assert wait_until(lambda: seen.append(reader.state) or reader.counts.reconnects == 1)
    order = [state for state, before in zip(seen, [None, *seen]) if state is not before]
    assert order == [
        ReaderState.WAITING, ReaderState.RUNNING, ReaderState.LOST, ReaderState.RUNNING]


@pytest.mark.slow
def test_camera_that_hangs_is_lost_though_its_read_has_not_returned(read):
    camera = Numbers()
    reader = read(camera)
    assert wait_until(lambda: reader.state is ReaderState.RUNNING)
    camera._wait = 1.6
    assert wait_until(lambda: reader.state is ReaderState.LOST, 1.4)


@pytest.mark.slow
def test_pauses_between_attempts_grow_from_half_a_second(read):
    camera = Numbers(*[FrameSourceError('away')] * 4, wait=0.0)
    reader = read(camera)
    assert wait_until(lambda: reader.counts.read > 0, 5.0)
    pauses = np.diff(camera.read_at[:5])
    assert pauses[0] == pytest.approx(0.5, abs=0.1)
    assert all(0.4 < pause <= 5.0 for pause in pauses) and pauses[3] > pauses[0]


def test_first_attempt_that_fails_is_raised(read):
    reader = read(Numbers(FrameSourceError('not there')))
    with pytest.raises(FrameSourceError, match='not there'):
        reader.wait_for_first_attempt()


def test_error_that_nobody_foresaw_is_told_and_the_camera_is_opened_anew(read):
    camera = Numbers(None, ValueError('odd\n  picture'))
    reader = read(camera)
    assert wait_until(lambda: reader.state is ReaderState.LOST, 0.5)
    assert 'ValueError: odd picture' in str(reader.error)
    assert wait_until(lambda: camera.released == 1, 0.3)
    assert wait_until(lambda: reader.counts.reconnects == 1, 1.0)
    assert reader.state is ReaderState.RUNNING and reader.error is None


def test_error_that_nobody_foresaw_ends_the_wait_for_the_first_attempt(read):
    reader = read(Numbers(ValueError('odd')))
    assert wait_until(lambda: reader.error is not None, 1.0)
    with pytest.raises(FrameSourceError, match='ValueError: odd'):
        reader.wait_for_first_attempt()


@pytest.mark.slow
def test_camera_whose_every_frame_makes_an_error_is_never_said_to_run(read):
    def fail(frame):
        raise ValueError('odd')

    reader = read(Numbers(wait=0.0), damage=fail)
    states = set()
    assert wait_until(lambda: states.add(reader.state) or reader.counts.attempts == 3)
    assert states == {ReaderState.WAITING}
    assert reader.take() is None


def test_damaged_frame_is_counted_and_never_given(read):
    camera = Numbers()
    reader = read(camera, damage=lambda frame: ODD if frame[0, 0, 0] % 2 else None)
    for _ in range(10):
        taken = []
        assert wait_until(lambda: taken.append(reader.take()) or taken[-1] is not None)
        assert taken[-1].image[0, 0, 0] % 2 == 0
    assert reader.counts.damaged >= 9 and reader.snapshot().last_damage is ODD


def test_consumer_is_told_of_each_frame(read):
    told = []
    reader = read(Numbers(), on_frame=lambda: told.append(1))
    assert wait_until(lambda: len(told) >= 5)
    assert reader.counts.read >= 5


@pytest.mark.slow
@both_servers
def test_reader_drains_a_stream_and_its_frames_are_new(server_class):
    with server_class(scenes.Clock(has_disc=True), 20.0) as server:
        reader = FrameReader(Camera(server.url, open_now=False))
        try:
            assert wait_until(lambda: reader.counts.read - reader.counts.old > 5)
            for _ in range(4):
                reader.take()
                time.sleep(0.4)
                taken = reader.take()
                seen_at = time.time() - (time.monotonic() - taken.taken_at)
                dark = np.argwhere(taken.image.max(axis=2) < 70)
                assert -0.05 < scenes.clock_age(dark[:, 1].mean(), seen_at) < 0.2
        finally:
            assert reader.close()


@pytest.mark.slow
@pytest.mark.parametrize('protocol', ['mjpeg', 'rtsp'])
@pytest.mark.parametrize('wait', ['0.1', '1.5'])
def test_process_ends_cleanly_while_the_camera_hangs(protocol, wait):
    here = str(Path(__file__).parents[2])
    child = subprocess.run(
        [sys.executable, '-c', END_WHILE_IT_HANGS, protocol, wait], capture_output=True, text=True,
        env={**os.environ, 'PYTHONPATH': os.pathsep.join([here, *filter(None, sys.path)])},
        timeout=20)
    assert child.returncode == 0, child.stderr
    assert 'closed True' in child.stdout
    assert float(child.stdout.split()[-1]) < 2.0


def test_snapshot_is_of_one_moment_and_stays_as_it_was(read):
    reader = read(Numbers(), damage=lambda frame: ODD)
    snapshots = []

    def is_long():
        snapshots.append(reader.snapshot())
        return snapshots[-1].damaged_in_a_row >= 5

    assert wait_until(is_long)
    reader.close()
    for seen in snapshots:
        assert (seen.last_damage is ODD) == (seen.damaged_in_a_row > 0)
        assert seen.counts.damaged in (seen.damaged_in_a_row, seen.damaged_in_a_row - 1)
    assert snapshots[0].damaged_in_a_row < snapshots[-1].damaged_in_a_row


def age_s(frame):
    """Tell how old a frame of :class:`scenes.Clock` is."""
    columns = np.nonzero(frame[200:280, :, 0] < 90)[1]
    return scenes.clock_age(columns.mean(), time.time())


@pytest.mark.slow
def test_frames_that_a_stream_has_kept_in_a_stall_are_not_given(read, tell):
    with KeepingRtspServer(scenes.Clock(has_disc=True, texture=10)) as server:
        reader = read(Camera(server.url, open_now=False), may_lag=True)
        ages, begin = [], time.monotonic()
        while time.monotonic() - begin < 18:
            (server.freeze if 3 < (time.monotonic() - begin) % 4.5 < 4 else server.thaw)()
            taken = reader.take()
            if taken is not None:
                ages.append(age_s(taken.image))
            time.sleep(0.005)
    tell(f'{len(ages)} frames of a stream that stalls, the oldest {max(ages):.2f} s old; '
         f'{reader.counts}')
    assert len(ages) > 60 and max(ages) < 0.4
