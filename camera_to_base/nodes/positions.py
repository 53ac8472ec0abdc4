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

"""Publishes the positions that the camera node has found, and the true ones where known."""

from typing import Callable, List, Optional, Sequence

from camera_to_base.coordinate_transform import Pose
from camera_to_base.detection import LocatedObject
from camera_to_base.nodes.simulated import TruePositions
from camera_to_base.ros import (
    left_out_markers, NO_EVENTS, PositionTopics, UncertainPose)
from camera_to_base.settings import NamedSource
from camera_to_base.simulation import SimulatedBoard
from camera_to_base.surface import Hull
from camera_to_base.trust import FrameUncertainty, Sighting
from camera_to_base.uncertainty import PositionCovariance
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import Header
from visualization_msgs.msg import MarkerArray

POSITION = 'pos_in_cam_frame'
# A message that is sent while two nodes still discover each other may take this long.
_LONGEST_DISCOVERY_S = 5.0


class PublishedPositions:
    """
    Publishes positions in the camera frame.

    :param node: The node that publishes.
    :param source: The source of its frames.
    """

    def __init__(self, node: Node, source: NamedSource) -> None:
        self._logger = node.get_logger()
        self._topics = PositionTopics(
            node, POSITION, 'objects_in_cam_frame', live=source.kind.is_live)
        self._left_out = node.create_publisher(
            MarkerArray, 'objects_in_cam_frame/left_out', 10, event_callbacks=NO_EVENTS,
            qos_overriding_options=QoSOverridingOptions.with_default_policies())
        self._truth: Optional[TruePositions] = None
        if isinstance(source.frames, SimulatedBoard):
            self._truth = TruePositions(node, source.frames)

    @property
    def topic(self) -> str:
        """Name of the tutorial's topic after remapping."""
        return self._topics.name

    @property
    def listener_count(self) -> int:
        """Number of subscribers, see :class:`PositionTopics`."""
        return self._topics.listener_count

    def publish_sighting(
        self, header: Header, sighting: Sighting, hull: Optional[Hull],
        uncertainty: FrameUncertainty,
    ) -> None:
        """
        Publish the objects of a frame, unless the sighting has a reason not to.

        :param hull: The area that the calibration was measured in; None where it is not known.
        """
        if self._truth is not None:
            self._truth.publish(header)
        if sighting.reason is None:
            self._warn_outside_hull(sighting.objects, hull)
            self.publish(header, [Pose(*found.point, 0.0, found.yaw or 0.0)
                                  for found in sighting.objects],
                         lambda number: uncertainty.of(sighting.objects[number]))
            self._publish_left_out(header, sighting)

    def publish(
        self, header: Header, poses: List[Pose],
        covariance_of: Callable[[int], PositionCovariance],
    ) -> None:
        """
        Publish poses, in cm, the largest object first; an empty list for an empty surface.

        :param covariance_of: Gives a pose's covariance by its index; called for subscribers only.
        """
        def uncertain(number: int) -> UncertainPose:
            return UncertainPose(poses[number], covariance_of(number).matrix)

        if poses:
            largest = poses[0]
            self._topics.publish_position(largest.x, largest.y)
            self._topics.publish_point(header, largest.x, largest.y)
            if self._topics.wants_pose:
                self._topics.publish_pose(header, uncertain(0))
        self._topics.publish_objects(header, poses)
        if self._topics.wants_ellipses:
            self._topics.publish_ellipses(header, map(uncertain, range(len(poses))))

    def wait_until_received(self) -> None:
        """Wait until all subscribers have received what was published, for at most 5 s."""
        self._topics.wait_until_received(_LONGEST_DISCOVERY_S)

    def _publish_left_out(self, header: Header, sighting: Sighting) -> None:
        if self._left_out.get_subscription_count() > 0:
            self._left_out.publish(left_out_markers(header, [
                (one.point, one.reason) for one in sighting.left_out if one.point is not None]))

    def _warn_outside_hull(
        self, objects: Sequence[LocatedObject], hull: Optional[Hull]
    ) -> None:
        # The accuracy of the calibration is only known inside the area that it was measured in.
        if objects and hull is not None and not hull.contains(objects[0].detection.centre):
            pixel, point = objects[0].detection.centre, objects[0].point
            self._logger.warning(
                f'the object at ({point.x:.2f}, {point.y:.2f}) cm, pixel ({pixel.u:g}, '
                f'{pixel.v:g}), lies outside the area that the calibration was measured in: its '
                'position may be less accurate', throttle_duration_sec=5.0)
