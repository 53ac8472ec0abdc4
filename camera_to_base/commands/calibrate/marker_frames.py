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
"""The frames that `calibrate markers` learns from."""

import argparse
from dataclasses import replace
from typing import List, Tuple

from camera_to_base.errors import InvalidValueError
from camera_to_base.markers import Corners, see_markers
from camera_to_base.settings import CameraSettings, open_named_source
from camera_to_base.sources import read_picture, still_frames
from camera_to_base.surface import RadialDistortion
import numpy as np


def marker_frames(
    options: argparse.Namespace, settings: CameraSettings
) -> Tuple[List[np.ndarray], str]:
    """
    Return frames that show the markers, and where they come from.

    :param options: Name pictures or a camera.
    :param settings: The camera node's, which name the camera where the options do not.
    :raises CameraToBaseError: If there is no such picture, or no camera.
    """
    if options.pictures:
        return ([read_picture(path).frame for path in options.pictures],
                ', '.join(options.pictures))
    scene = settings.simulated.scene._replace(markers=True, shows='empty')
    source = open_named_source(replace(
        settings, source=options.camera or settings.source,
        simulated=replace(settings.simulated, scene=scene)), may_be_random=False)
    if source.frames is None:
        raise InvalidValueError(
            f"'{source.name}' is no camera that can be opened here: give --camera with a device "
            'or a stream, or pictures of the markers')
    try:
        return still_frames(source.frames), f'camera {source.name}'
    finally:
        source.frames.release()


def markers_in(frames: List[np.ndarray], lens: RadialDistortion) -> List[Corners]:
    """Find the markers in each frame."""
    return [see_markers(frame, lens).corners for frame in frames]
