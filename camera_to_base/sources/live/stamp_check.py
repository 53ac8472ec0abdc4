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

"""Compares the stamp of a driver's picture with the clock of the node that receives it."""

from typing import Optional

from camera_to_base.reason import Level, Reason

# The clocks of two computers, and a simulation's stepped clock, normally differ by less.
_LARGEST_LEAD_S = 0.1
_DAY_S = 86400.0
_CLOCKS = ("synchronise the clocks of the driver's computer and of this one (chrony); set "
           'use_sim_time to true where a simulation or a played bag publishes /clock, and only '
           'there')
STAMP_KINDS = ('no_stamp', 'stamp_ahead', 'stamp_old')


def stamp_reason(stamp_ns: int, arrived_ns: int, max_age_s: float) -> Optional[Reason]:
    """
    Return why a picture's stamp cannot be its capture time, or is too old.

    :param stamp_ns: In ns; 0 for none.
    :param arrived_ns: Its arrival time, by the same clock.
    :param max_age_s: Its greatest allowed age on arrival.
    :returns: None for a stamp that can be used.
    """
    age_s = (arrived_ns - stamp_ns) / 1e9
    if stamp_ns == 0 and age_s > max_age_s:
        return _reason('no_stamp', 'has no stamp: choose a camera driver that stamps its pictures')
    if age_s < -_LARGEST_LEAD_S:
        return _reason('stamp_ahead', f'was stamped {_span(-age_s)} in the future: {_CLOCKS}')
    if age_s > max_age_s:
        return _reason('stamp_old', (
            f'is {_span(age_s)} old by its stamp when it arrives, at most {max_age_s:g} s are '
            f'allowed (max_frame_age): {_CLOCKS}'))
    return None


def _reason(kind: str, what: str) -> Reason:
    return Reason(kind, Level.ERROR, f'the picture {what}', is_passing=True)


def _span(seconds: float) -> str:
    return f'{seconds:.2f} s' if seconds < _DAY_S else f'{seconds / _DAY_S:.0f} days'
