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
"""What the markers are told of a frame, and what follows from it."""

from typing import NamedTuple, Optional

from camera_to_base.markers import MarkedSurface
from camera_to_base.trust.background import Background
from camera_to_base.trust.correction.seen_background import SeenBackground
from camera_to_base.trust.sighting import Sighting
from camera_to_base.trust.surface_in_force import SurfaceInForce


class MarkerSettings(NamedTuple):
    """
    Markers on the surface.

    :param marked: The calibration with its markers.
    :param retakes: Whether a new background may be taken without being asked for.
    :param background_frames: It is the median of this many frames.
    """

    marked: MarkedSurface
    retakes: bool = False
    background_frames: int = 1


class MarkerStep(NamedTuple):
    """
    What follows from a frame.

    :param sighting: What may be published of it.
    :param surface: The surface for where the background was taken; None for no change.
    :param retakes: Whether to take a new background.
    """

    sighting: Sighting
    surface: Optional[SurfaceInForce] = None
    retakes: bool = False


class MarkerView(NamedTuple):
    """
    What is known of a frame's view.

    :param background: What the frame was compared with.
    :param seen: The same as the camera sees it from where it stands.
    :param in_force: What its pixels mean.
    :param is_corrected: Whether the camera was nudged since the background was taken.
    :param shift_px: How far it is off, as far as that is known, in px.
    """

    background: Background
    seen: SeenBackground
    in_force: SurfaceInForce
    is_corrected: bool
    shift_px: float
