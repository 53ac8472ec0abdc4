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

"""What a frame, a position or the view must keep to."""

from typing import NamedTuple


class Limits(NamedTuple):
    """What a frame, a position or the view must keep to, see the node's parameters."""

    max_frame_age_s: float = 0.3
    confirm_jump_px: float = 8.0
    max_shift_px: float = 3.0
    max_changed_share: float = 0.7
    check_period_s: float = 2.0

    @property
    def for_recording(self) -> 'Limits':
        """The same without the view: no arm follows a recording, which is shown as it is."""
        return self._replace(max_shift_px=0.0)
