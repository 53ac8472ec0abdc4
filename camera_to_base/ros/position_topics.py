# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Publishes positions in one coordinate frame: on the tutorial's topic, and stamped in metres."""

import time
from typing import Iterable, List, Optional, Tuple

from camera_to_base.coordinate_transform import Pose
from camera_to_base.ros.boxes import box_markers, detection_type, detections_message, SolidBox
from camera_to_base.ros.messages import (
    ellipse_markers, point_message, poses_message, position_message, uncertain_pose_message,
    UncertainPose)
from geometry_msgs.msg import PointStamped, PoseArray, PoseWithCovarianceStamped
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import Float64MultiArray, Header
from visualization_msgs.msg import MarkerArray

_DEPTH = 10
# DDS sends the last positions again to a subscriber that it discovers late, for example after a
# restart. Of a live camera, none older than this is sent. Frames may be 0.3 s old in total; the
# remaining 0.2 s are for capture, detection and transport.
_LIFESPAN = Duration(seconds=0.1)
# No QoS events: the subscriber's side warns of a mismatch. The executor checks every event for
# every message; the events of four publishers took a tenth of the time of a message.
NO_EVENTS = PublisherEventCallbacks(use_default_callbacks=False)


class PositionTopics:
    """
    The topics on which a node publishes positions.

    :param node: The node that publishes.
    :param position: Name of the tutorial's topic; the same object's point and
        pose are beside it.
    :param objects: Name of the topic of all objects; their ellipses and boxes are beside it.
    :param live: Whether an old position is useless once newer ones exist.
    """

    def __init__(self, node: Node, position: str, objects: str, live: bool = False) -> None:
        self._position = _publisher(node, Float64MultiArray, position, live)
        self._point = _publisher(node, PointStamped, f'{position}/point', live)
        self._pose = _publisher(node, PoseWithCovarianceStamped, f'{position}/pose', live)
        self._objects = _publisher(node, PoseArray, objects, live)
        self._ellipses = _publisher(node, MarkerArray, f'{objects}/ellipses', live)
        self._boxes = _publisher(node, MarkerArray, f'{objects}/boxes', live)
        self._sent: Tuple[Tuple[Pose, ...], PoseArray] = (), PoseArray()
        self._detections: Optional[Publisher] = None
        if detection_type() is not None:
            self._detections = _publisher(node, detection_type(), f'{objects}/detections', live)

    @property
    def name(self) -> str:
        """Name of the tutorial's topic after remapping."""
        return self._position.topic_name

    @property
    def listener_count(self) -> int:
        """Largest number of subscribers that one of the topics of positions has."""
        return max(publisher.get_subscription_count()
                   for publisher in (self._position, self._point, self._pose, self._objects))

    @property
    def wants_position(self) -> bool:
        """Whether the tutorial's topic or the stamped point has a subscriber."""
        return (self._position.get_subscription_count() > 0
                or self._point.get_subscription_count() > 0)

    @property
    def wants_pose(self) -> bool:
        """Whether the pose with its covariance has a subscriber."""
        return self._pose.get_subscription_count() > 0

    @property
    def wants_ellipses(self) -> bool:
        """Whether the ellipses have a subscriber."""
        return self._ellipses.get_subscription_count() > 0

    @property
    def wants_boxes(self) -> bool:
        """Whether the boxes have a subscriber, as markers or as detections."""
        return self._boxes.get_subscription_count() > 0 or (
            self._detections is not None and self._detections.get_subscription_count() > 0)

    def publish_position(self, x: float, y: float) -> None:
        """Publish a position, in cm, on the tutorial's topic."""
        self._position.publish(position_message(x, y))

    def publish_point(self, header: Header, x: float, y: float, z: float = 0.0) -> None:
        """Publish a position, in cm, as a stamped point."""
        self._point.publish(point_message(header, x, y, z))

    def publish_pose(self, header: Header, uncertain: UncertainPose) -> None:
        """Publish a pose, in cm and rad, with its covariance."""
        self._pose.publish(uncertain_pose_message(header, uncertain))

    def publish_ellipses(self, header: Header, poses: Iterable[UncertainPose]) -> None:
        """Publish the ellipses of a frame's objects; earlier ones are deleted."""
        self._ellipses.publish(ellipse_markers(header, poses))

    def publish_boxes(self, header: Header, boxes: List[SolidBox]) -> None:
        """Publish the boxes around a frame's objects; earlier ones are deleted."""
        self._boxes.publish(box_markers(header, boxes))
        if self._detections is not None:
            self._detections.publish(detections_message(header, boxes))

    def publish_objects(self, header: Header, poses: Iterable[Pose]) -> None:
        """Publish all objects of a frame, the largest first; an empty array if there are none."""
        poses = tuple(poses)
        if poses != self._sent[0]:
            self._sent = poses, poses_message(header, poses)
        # Of what rests, only the time is new.
        self._sent[1].header = header
        self._objects.publish(self._sent[1])

    def wait_until_received(self, seconds: float) -> None:
        """
        Wait until all subscribers have received what was published.

        :param seconds: Longest time to wait; Ctrl-C interrupts it.
        """
        waiting = [self._position, self._point, self._pose, self._objects]
        until = time.monotonic() + seconds
        while waiting and time.monotonic() < until:
            waiting = [publisher for publisher in waiting
                       if not publisher.wait_for_all_acked(Duration(seconds=0.1))]


def _publisher(node: Node, message_type: type, topic: str, live: bool) -> Publisher:
    # rclpy writes QoS overrides into the profile object, so each publisher needs its own.
    qos = QoSProfile(depth=_DEPTH, lifespan=_LIFESPAN) if live else QoSProfile(depth=_DEPTH)
    return node.create_publisher(
        message_type, topic, qos, event_callbacks=NO_EVENTS,
        qos_overriding_options=QoSOverridingOptions.with_default_policies())
