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

"""
The correction: how the camera was nudged, by the surface's own structure.

In: the background, and frames whose view has moved. Out: the movement as a homography of
undistorted pixels, with its covariance, where it is believed. `corners` and `warp_fit` measure,
`nudge_meter` judges a single frame, `corrector` decides from frame to frame, and `correction` says
what it does to positions. `kept` gives the parameters with which it is kept.

Callers: `trust.standpoint` and `trust.view.view_stage`.
"""

from camera_to_base.trust.correction.correction import corrected_surface, Correction
from camera_to_base.trust.correction.corrector import Corrector
from camera_to_base.trust.correction.kept import kept_values
from camera_to_base.trust.correction.nudge_meter import Nudge, NudgeMeter

__all__ = [
    'corrected_surface', 'Correction', 'Corrector', 'kept_values', 'Nudge', 'NudgeMeter']
