# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A nudged table and the pipeline that sees it."""

import time

from camera_to_base.pipeline import CameraPipeline, Limits
from camera_to_base.sources import DEVICE
from camera_to_base.surface import make_surface, SURFACE_DEFAULTS
from nudged_table import CM_PER_PX, nudge, NudgedTable, SIZE
import numpy as np

COIN = 300, 200
MATRIX = nudge(7, -5, 3, 3, (4, -3))
LIMITS = Limits(max_frame_age_s=60.0)


def calibrated(**changed):
    """Give the surface of a camera whose lens is that of the table."""
    return make_surface({
        **SURFACE_DEFAULTS, 'surface.model': 'homography', 'surface.image_size': list(SIZE),
        'surface.homography.surface_from_pixel':
            [CM_PER_PX, 0.0, 0.0, 0.0, CM_PER_PX, 0.0, 0.0, 0.0, 1.0],
        'surface.homography.distortion_centre': [(side - 1) / 2 for side in SIZE], **changed})


class Watched:
    """A pipeline that sees a table; times are in the future, so that no frame is too old."""

    def __init__(self, table=None, limits=LIMITS, kind=DEVICE, begin=True):
        self.table = table or NudgedTable()
        self.pipeline = CameraPipeline(calibrated(), limits=limits, kind=kind)
        self._now = time.monotonic() + 3600
        if begin:
            self.see(count=3)

    def see(self, matrix=None, coins=(), count=1, **scene):
        """Let it see some frames; give what the last one shows."""
        for _ in range(count):
            self._now += 0.1
            self.sighting = self.pipeline.process(
                self.table.shoot(matrix, coins, **scene), self._now)
        return self.sighting


def point_errors_mm(sighting, *coins):
    assert sighting.reason is None and len(sighting.objects) == len(coins)
    return [10 * min(np.hypot(*(np.array(one.point) - np.array(coin) * CM_PER_PX))
                     for coin in coins) for one in sighting.objects]
