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

"""What was left out, and why, as markers for RViz."""

import textwrap
from typing import Iterable, Tuple

from camera_to_base.coordinate_transform import Pose
from camera_to_base.reason import Reason
from camera_to_base.ros.messages import pose_to_one
from geometry_msgs.msg import Vector3
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

_COLOUR = ColorRGBA(r=0.7, g=0.7, b=0.7, a=1.0)
_LETTER_M = 0.008
_LETTERS_PER_LINE = 32


def left_out_markers(
    header: Header, left_out: Iterable[Tuple[Tuple[float, float], Reason]]
) -> MarkerArray:
    """
    Make a text for each object that was left out: its reason's sentence, at its place.

    A marker's namespace is the reason's kind, so that RViz can hide each kind. The first marker
    deletes those of earlier messages.

    :param left_out: Of each, x and y in cm in the camera frame, and the reason.
    """
    markers = [Marker(header=header, action=Marker.DELETEALL)]
    for number, ((x, y), reason) in enumerate(left_out, start=1):
        markers.append(Marker(
            header=header, ns=reason.kind, id=number, type=Marker.TEXT_VIEW_FACING,
            action=Marker.ADD, pose=pose_to_one(Pose(x, y, 0.0, 0.0)), color=_COLOUR,
            scale=Vector3(z=_LETTER_M),
            text='\n'.join(textwrap.wrap(reason.sentence, _LETTERS_PER_LINE))))
    return MarkerArray(markers=markers)
