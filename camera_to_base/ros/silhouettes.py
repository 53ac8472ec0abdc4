# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Silhouettes on the surface, and where the camera is: what several cameras are fused from."""

import math
from types import SimpleNamespace
from typing import Iterable, List, NamedTuple, Optional

from camera_to_base.coordinate_transform import Pose
from camera_to_base.errors import InvalidValueError
from camera_to_base.ros.messages import (
    ellipse_markers, MOST_POSES, poses_of_markers, uncertain_pose_message, UncertainPose)
from camera_to_base.ros.position_topics import NO_EVENTS
from geometry_msgs.msg import Point, PoseWithCovarianceStamped, Vector3
import numpy as np
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

_NAMESPACE = 'silhouettes'
_COLOUR = ColorRGBA(r=0.2, g=0.9, b=0.3, a=1.0)
_CM_PER_M = 100.0
# A silhouette of a picture has a few dozen corners.
_FEWEST_CORNERS, _MOST_CORNERS = 3, 1000
# A place that has moved by less is not published again.
_SAME_PLACE_CM = 0.005


class SurfaceSilhouette(NamedTuple):
    """
    What a camera sees of an object, on the surface.

    :param corners: Of its outline, side faces included, shape (n, 3), x, y and z in cm.
    :param place: Its middle, and how far all of it may be off: x, y of a flat object.
    :param pixel_cm: How wide a pixel is there; the line is drawn as wide.
    """

    corners: np.ndarray
    place: UncertainPose
    pixel_cm: float = 0.07


def silhouette_markers(header: Header, silhouettes: Iterable[SurfaceSilhouette]) -> MarkerArray:
    """
    Make a closed line for each object, and an ellipse that holds 95 % of the errors of its place.

    The first marker deletes those of earlier messages. A line and its ellipse have the same id.
    """
    silhouettes = list(silhouettes)
    message = ellipse_markers(header, [one.place for one in silhouettes])
    for number, one in enumerate(silhouettes, start=1):
        corners = (one.corners / _CM_PER_M).tolist()
        message.markers.append(Marker(
            header=header, ns=_NAMESPACE, id=number, type=Marker.LINE_STRIP, action=Marker.ADD,
            scale=Vector3(x=one.pixel_cm / _CM_PER_M), color=_COLOUR,
            points=[Point(x=x, y=y, z=z) for x, y, z in [*corners, corners[0]]]))
    return message


def silhouettes_of_markers(message: MarkerArray) -> List[SurfaceSilhouette]:
    """
    Read silhouettes.

    :param message: The message, or what `markers_of_bytes` returns.
    :raises InvalidValueError: If a number is not finite, an outline has no ellipse, or there are
        far too many outlines or corners.
    """
    if len(message.markers) > 2 * MOST_POSES:
        raise InvalidValueError(f'expected at most {2 * MOST_POSES} markers, got '
                                f'{len(message.markers)}')
    lines = [one for one in message.markers if one.type == Marker.LINE_STRIP
             and one.action == Marker.ADD]
    ellipses = [one for one in message.markers if one.type == Marker.CYLINDER
                and one.action == Marker.ADD]
    if [one.id for one in lines] != [one.id for one in ellipses]:
        raise InvalidValueError(f'expected an ellipse for each outline, got {len(lines)} '
                                f'outlines and {len(ellipses)} ellipses')
    places = poses_of_markers(SimpleNamespace(markers=ellipses))
    return [SurfaceSilhouette(_corners(line), place, _width(line))
            for line, place in zip(lines, places)]


def _corners(line: Marker) -> np.ndarray:
    if not _FEWEST_CORNERS < len(line.points) <= _MOST_CORNERS:
        raise InvalidValueError(f'expected {_FEWEST_CORNERS + 1} to {_MOST_CORNERS} corners of an '
                                f'outline, got {len(line.points)}')
    points = line.points[:-1]
    corners = points if isinstance(points, np.ndarray) else np.array(
        [(point.x, point.y, point.z) for point in points])
    if not np.isfinite(corners).all():
        raise InvalidValueError('expected finite corners of an outline, got '
                                f'{corners[~np.isfinite(corners).all(axis=1)][0].tolist()}')
    return corners * _CM_PER_M


def _width(line: Marker) -> float:
    if not line.scale.x > 0:
        raise InvalidValueError('expected an outline with a width above 0: that of a pixel, got '
                                f'{line.scale.x:g}')
    return line.scale.x * _CM_PER_M


class SilhouetteTopics:
    """
    The topics that several cameras are fused from.

    :param node: The node that publishes.
    :param objects: Name of the topic of all objects; the silhouettes are beside it.
    :param camera: Name of the topic with the camera's place, which a late subscriber gets, too.
    """

    def __init__(self, node: Node, objects: str, camera: str) -> None:
        overrides = QoSOverridingOptions.with_default_policies
        self._silhouettes = node.create_publisher(
            MarkerArray, f'{objects}/silhouettes', 10, event_callbacks=NO_EVENTS,
            qos_overriding_options=overrides())
        self._camera = node.create_publisher(
            PoseWithCovarianceStamped, camera, latched(), event_callbacks=NO_EVENTS)
        self._sent: Optional[UncertainPose] = None

    @property
    def is_wanted(self) -> bool:
        """Whether the silhouettes have a subscriber."""
        return self._silhouettes.get_subscription_count() > 0

    def publish(self, header: Header, silhouettes: Iterable[SurfaceSilhouette]) -> None:
        """Publish the silhouettes of a frame; earlier ones are deleted."""
        self._silhouettes.publish(silhouette_markers(header, silhouettes))

    def publish_camera(self, header: Header, camera: UncertainPose) -> None:
        """
        Publish where the camera is, unless that is known.

        :param camera: Its position, in cm; it has no yaw.
        """
        if self._sent is None or _is_elsewhere(self._sent, camera):
            self._sent = camera
            self._camera.publish(uncertain_pose_message(header, camera))


def latched() -> QoSProfile:
    """Make the quality of service of what is sent once, and to late subscribers, too."""
    return QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def camera_pose(x: float, y: float, z: float, covariance: np.ndarray) -> UncertainPose:
    """
    Make the place of a camera.

    :param x: In cm; y and z, too.
    :param covariance: Of x, y and z, shape (3, 3), in cm².
    """
    whole = np.zeros((6, 6))
    whole[:3, :3] = covariance
    return UncertainPose(Pose(x, y, z, 0.0), whole)


def _is_elsewhere(before: UncertainPose, now: UncertainPose) -> bool:
    return math.dist(before.pose[:3], now.pose[:3]) > _SAME_PLACE_CM or not np.allclose(
        before.covariance, now.covariance)
