# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Whether a calibration belongs to the camera in use."""

from camera_to_base.detection import LocatedObject, Point
from camera_to_base.errors import Level
from camera_to_base.pipeline.own_camera import OwnCamera
from camera_to_base.pipeline.stage import FrameRecord
from camera_to_base.pipeline.standpoint import Background, Standpoint
from camera_to_base.surface.models import ParallelSurface
from camera_to_base.surface.thumbnail import read_thumbnail, view_thumbnail
import cv2
import numpy as np
import pytest


def table(seed):
    noise = np.random.default_rng(seed).normal(0, 1, (480, 640))
    blurred = cv2.GaussianBlur(noise, (0, 0), 15)
    return np.repeat((150 + 25 * blurred / blurred.std()).astype(np.uint8)[:, :, None], 3, axis=2)


SURFACE = ParallelSurface(36.0, 640)
HOME = read_thumbnail(view_thumbnail(table(1)))


@pytest.mark.parametrize('source, calibrated, is_other', [
    ('/dev/video7', '/dev/v4l/by-id/usb-cam', True), ('0', '/dev/video0', False),
    ('rtsp://me:word@cam/1', 'rtsp://cam/1', False), ('rtsp://cam/2', 'rtsp://cam/1', True),
    ('simulated', 'simulated', False), ('simulated', '/dev/video0', True), ('0', '', False),
    ('topic', '/dev/video0', False), ('auto', '/dev/video0', False),
    ('a.avi', '/dev/video0', False)])
def test_another_device_is_told_where_it_is_certain(source, calibrated, is_other):
    reason = OwnCamera(source, calibrated).reason(None)
    assert (reason is not None) == is_other
    if is_other:
        assert (reason.kind, reason.level) == ('other_camera', Level.WARN)
        assert calibrated in reason.sentence


def test_another_view_is_told_once_there_is_a_background():
    camera = OwnCamera('0', '/dev/video0', HOME)
    assert camera.reason(None) is None
    assert camera.reason(table(1)) is None
    assert camera.reason(table(2)).kind == 'other_view'
    assert camera.reason(table(1)) is None


def judged(background, is_strict):
    standpoint = Standpoint.as_calibrated(SURFACE).with_background(Background(background, 0.0))
    return OwnCamera('0', '', HOME, is_strict).judge(
        FrameRecord(background, standpoint, objects=[
            LocatedObject(None, Point(1.0, 2.0))]))


def test_strict_holds_back_what_another_view_shows():
    for seed, is_strict in (1, True), (2, False):
        passed = judged(table(seed), is_strict)
        assert passed.objects and passed.reason is None
    held = judged(table(2), is_strict=True)
    assert held.objects == [] and held.reason.kind == 'other_view'
    assert [one.reason for one in held.left_out] == [held.reason]
    assert held.reason.level == Level.ERROR
