# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.drawing.files import AnnotatedVideo, check_video_path
from camera_to_base.errors import InvalidValueError
import cv2
import numpy as np
import pytest
from recordings import disc_frame


def test_video_holds_the_pictures_at_its_rate_and_none_of_another_size(tmp_path):
    path = str(tmp_path / 'seen.mp4')
    video = AnnotatedVideo(path, 12.5)
    for picture in (disc_frame((60, 60)), disc_frame(None, (160, 120)), disc_frame((90, 90))):
        video.add(picture)
    video.release()
    capture = cv2.VideoCapture(path)
    assert capture.get(cv2.CAP_PROP_FPS) == pytest.approx(12.5)
    for position in ((60, 60), (90, 90)):
        assert np.abs(capture.read()[1].astype(int) - disc_frame(position)).mean() < 6
    assert not capture.read()[0]


def test_missing_encoder_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr('camera_to_base.drawing.files._CODEC', '????')
    with pytest.raises(InvalidValueError, match=r'cannot write video .*seen.mp4.*encoder'):
        AnnotatedVideo(str(tmp_path / 'seen.mp4'), 10.0).add(disc_frame(None))


@pytest.mark.parametrize('path, said', [
    ('seen.avi', 'must end in .mp4'), ('seen', 'must end in .mp4'),
    ('no/seen.mp4', "there is no folder 'no'")])
def test_name_that_cannot_be_written_is_refused(path, said):
    with pytest.raises(InvalidValueError, match=said):
        check_video_path(path)
