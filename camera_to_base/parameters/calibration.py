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

"""What a parameter file records of its calibration, and the line that sums it up."""

from datetime import datetime
from typing import Any, Mapping, Optional

from camera_to_base.parameters.spec import ParameterSpec

_CHANGE = '; '
# Both nodes have these: they log the same line at their start.
RECORD_SPECS = [
    ParameterSpec('calibration.surface', '',
                  'When the surface was calibrated, from what, and how well; written by '
                  'calibrate.'),
    ParameterSpec('calibration.base', '',
                  'When the base frame was calibrated, from what, and how well; written by '
                  'calibrate.'),
    ParameterSpec('calibration.device', '',
                  'The camera that the surface was calibrated with: a lasting link to a device, '
                  'the URL of a stream, or simulated; written by calibrate.'),
]
# Only the camera node has frames to compare.
OWN_CAMERA_SPECS = [
    ParameterSpec('calibration.thumbnail', '',
                  'A small picture of the calibrated surface, PNG in base64: the node compares '
                  'its background with it; written by calibrate.'),
    ParameterSpec('calibration.strict', False,
                  'Whether to publish nothing if the calibration belongs to another camera, or to '
                  'another view. Otherwise the node only warns.'),
]


def calibration_record(report: Mapping[str, Any]) -> str:
    """
    Write in one line when a part was calibrated, from what, and how well.

    :param report: The report of the calibration.
    """
    return (f'{report["date"]}, {report["model"]} from {report["source"]}, '
            f'rms {report["rms_mm"]:.2f} mm at {report["points"]} points')


def changed_record(record: str, how: str, now: datetime) -> str:
    """
    Write in one line that a calibration was changed, and what it was made from.

    :param record: Its line before; '' for none.
    :param how: What was done to it.
    :param now: When.
    """
    date, _, made_from = record.partition(', ')
    if made_from and _CHANGE not in made_from:
        made_from += f' on {date[:10]}'
    made_from = made_from.partition(_CHANGE)[0]
    words = f'{made_from}{_CHANGE}{how}' if made_from else how
    return f'{now.isoformat(timespec="seconds")}, {words}'


def calibration_summary(values: Mapping[str, Any], now: Optional[datetime] = None) -> str:
    """
    Say in one line what the parameters hold of a calibration.

    :param values: By full name; missing ones have their defaults.
    :param now: With its time zone; None for the present time.
    """
    now = now or datetime.now().astimezone()
    surface = _part('surface', values.get('calibration.surface'),
                    values.get('surface.model', 'parallel') != 'parallel', now)
    base = _part('base frame', values.get('calibration.base'), False, now)
    device = values.get('calibration.device')
    return f'calibration: {surface}; {base}' + (f'; camera {device}' if device else '')


def calibration_date(values: Mapping[str, Any]) -> Optional[datetime]:
    """
    Tell when the surface was calibrated; None where that is not recorded.

    :param values: By full name.
    """
    date = str(values.get('calibration.surface') or '').partition(', ')[0]
    try:
        return datetime.fromisoformat(date).astimezone()
    except ValueError:
        return None


def age_text(date: str, now: datetime) -> str:
    """
    Say how long ago a date is.

    :param date: In ISO 8601.
    :param now: With its time zone.
    :returns: The date itself where it is none.
    """
    try:
        days = (now - datetime.fromisoformat(date)).days
    except (TypeError, ValueError):
        return date
    return f'{date} ({"less than a day" if days < 1 else f"{days} days"} ago)'


def _part(name: str, record: Optional[str], is_set: bool, now: datetime) -> str:
    if not record:
        return f'{name} {"without a record" if is_set else "not calibrated"}'
    date, _, rest = record.partition(', ')
    return f'{name} of {age_text(date, now)}, {rest}'
