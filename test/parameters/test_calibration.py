# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The line that sums a calibration up."""

from datetime import datetime, timezone

from camera_to_base.parameters.file import calibration_record, calibration_summary

NOW = datetime(2026, 5, 17, 12, tzinfo=timezone.utc)
REPORT = {'date': '2026-05-01T10:00:00+00:00', 'model': 'homography', 'source': 'a chessboard',
          'rms_mm': 0.123, 'points': 54}


def test_summary_names_age_source_and_error_of_each_part():
    record = calibration_record(REPORT)
    summary = calibration_summary(
        {'calibration.surface': record, 'calibration.device': '/dev/v4l/by-id/cam'}, NOW)
    assert summary == (
        'calibration: surface of 2026-05-01T10:00:00+00:00 (16 days ago), homography from a '
        'chessboard, rms 0.12 mm at 54 points; base frame not calibrated; '
        'camera /dev/v4l/by-id/cam')


def test_without_a_record_that_is_said():
    assert calibration_summary({}, NOW) == (
        'calibration: surface not calibrated; base frame not calibrated')
    assert 'surface without a record' in calibration_summary({'surface.model': 'homography'}, NOW)
