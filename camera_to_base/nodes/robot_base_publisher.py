# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Node: applies the homogeneous matrix to each position that the camera node publishes."""

from collections import Counter
from contextlib import contextmanager
from dataclasses import replace
import sys
from typing import Callable, Iterator, List, Optional

from camera_to_base.coordinate_transform import Pose
from camera_to_base.errors import (
    all_well, CameraToBaseError, Level, OtherFrameError, OutOfReachError, Reason)
from camera_to_base.parameters import (
    CAMERA_FRAME_SPEC, ParameterSpec, TRANSFORM_SPECS, TransformSettings, value_in_files)
from camera_to_base.ros import (
    boxes_of_markers, Diagnostics, Health, Heartbeat, latched, NameCheck, NodeParameters,
    point_from_message, poses_from_message, poses_of_markers, position_from_message,
    PositionTopics, qos_mismatch, run, silhouettes_of_markers, SilhouetteTopics, SolidBox,
    SurfaceSilhouette, uncertain_pose_from_message, UncertainPose, whole_or_gone)
from camera_to_base.uncertainty import uncertain_transform_of
from geometry_msgs.msg import PointStamped, PoseArray, PoseWithCovarianceStamped
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription
from std_msgs.msg import Float64MultiArray, Header
from visualization_msgs.msg import MarkerArray

_PERIOD_S = 1.0

# Each event of a subscription slows every message; `qos_mismatch` replaces the event.
_NO_EVENTS = SubscriptionEventCallbacks(use_default_callbacks=False)
_POSITION, _OBJECTS = 'pos_in_cam_frame', 'objects_in_cam_frame'
_CAMERA = 'camera_in_cam_frame'
# Keys of the diagnostics for dropped positions; all other errors count as 'no position'.
_DROPPED_AS = {OutOfReachError: 'out of reach', OtherFrameError: 'in another frame'}


class WantedInput:
    """
    Subscribes while somebody wants the result, so that the publisher has no work otherwise.

    :param node: The node that subscribes.
    :param heartbeat: Its heartbeat.
    :param is_wanted: Whether the result has a subscriber.
    :param subscribe: Makes the subscription.
    """

    def __init__(
        self, node: Node, heartbeat: Heartbeat, is_wanted: Callable[[], bool],
        subscribe: Callable[[], Subscription],
    ) -> None:
        self._node, self._is_wanted, self._subscribe = node, is_wanted, subscribe
        self._subscription: Optional[Subscription] = None
        heartbeat.every(_PERIOD_S, self._check)

    def _check(self) -> None:
        if self._is_wanted() and self._subscription is None:
            self._subscription = self._subscribe()
        elif not self._is_wanted() and self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None


class RobotBasePublisher(Node):
    """Converts positions from the camera frame to the base frame."""

    def __init__(self, **node_options) -> None:
        super().__init__('robot_base_publisher', **node_options)
        with whole_or_gone(self):
            cli_args = node_options.get('cli_args') or []
            self._node_parameters = NodeParameters(
                self, self._specs([*sys.argv, *cli_args]), uncertain_transform_of,
                self._convert_camera, cli_args=cli_args)
            self._received_count = self._published_count = 0
            self._dropped: Counter = Counter()
            self._dropped_before = 0
            self._topics = PositionTopics(
                self, 'pos_in_robot_base_frame', 'objects_in_robot_base_frame')
            self._silhouettes = SilhouetteTopics(
                self, 'objects_in_robot_base_frame', 'camera_in_robot_base_frame')
            self._camera: Optional[PoseWithCovarianceStamped] = None
            heartbeat = Heartbeat(self)
            Diagnostics(self, heartbeat, self._health)
            NameCheck(self, heartbeat)
            # Last: messages that arrive before the node spins are published late.
            self._inputs = [
                self._subscribe(PoseArray, _OBJECTS, self._on_objects),
                self._subscribe(
                    PoseWithCovarianceStamped, f'{_POSITION}/pose', self._on_pose),
                self._subscribe(PointStamped, f'{_POSITION}/point', self._on_point),
                self._subscribe(Float64MultiArray, _POSITION, self._on_position)]
            WantedInput(
                self, heartbeat, lambda: self._topics.wants_ellipses, lambda: self._subscribe(
                    MarkerArray, f'{_OBJECTS}/ellipses', self._on_ellipses))
            WantedInput(
                self, heartbeat, lambda: self._topics.wants_boxes, lambda: self._subscribe(
                    MarkerArray, f'{_OBJECTS}/boxes', self._on_boxes))
            WantedInput(
                self, heartbeat, lambda: self._silhouettes.is_wanted, lambda: self._subscribe(
                    MarkerArray, f'{_OBJECTS}/silhouettes', self._on_silhouettes))
            self.create_subscription(
                PoseWithCovarianceStamped, _CAMERA, self._on_camera, latched(),
                event_callbacks=_NO_EVENTS)
            self.get_logger().info(self._settings.calibration)
            self.get_logger().info(f'publishing on {self._topics.name} what comes on '
                                   f'{self.resolve_topic_name(_POSITION)}')

    @property
    def dropped_count(self) -> int:
        """Number of positions dropped: invalid, out of reach, or in another frame."""
        return sum(self._dropped.values())

    @property
    def _settings(self) -> TransformSettings:
        return self._node_parameters.current.settings

    def _specs(self, arguments: List[str]) -> List[ParameterSpec]:
        # A parameter file may set the camera frame for the camera node only.
        camera = f'{self.get_namespace().rstrip("/")}/camera_publisher'
        named = value_in_files(arguments, camera, CAMERA_FRAME_SPEC.name)
        own = replace(CAMERA_FRAME_SPEC, default=named) if named else CAMERA_FRAME_SPEC
        return [own if spec is CAMERA_FRAME_SPEC else spec for spec in TRANSFORM_SPECS]

    def _subscribe(self, message_type: type, topic: str, callback: Callable) -> Subscription:
        return self.create_subscription(
            message_type, topic, callback, 10, event_callbacks=_NO_EVENTS,
            qos_overriding_options=QoSOverridingOptions.with_default_policies())

    def _on_position(self, message: Float64MultiArray) -> None:
        with self._dropping_what_is_wrong(_POSITION):
            x, y, _ = self._settings.base_point(*position_from_message(message))
            self._topics.publish_position(x, y)
            self._published_count += 1

    def _on_point(self, message: PointStamped) -> None:
        with self._dropping_what_is_wrong(f'{_POSITION}/point'):
            self._settings.check_frame(message.header.frame_id)
            point = self._settings.base_point(*point_from_message(message))
            self._topics.publish_point(self._header(message.header), *point)
            self._published_count += 1

    def _on_pose(self, message: PoseWithCovarianceStamped) -> None:
        with self._dropping_what_is_wrong(f'{_POSITION}/pose'):
            self._settings.check_frame(message.header.frame_id)
            uncertain = self._in_base_frame(uncertain_pose_from_message(message))
            self._topics.publish_pose(self._header(message.header), uncertain)
            self._published_count += 1

    def _on_ellipses(self, message: MarkerArray) -> None:
        with self._dropping_what_is_wrong(f'{_OBJECTS}/ellipses'):
            poses, header = poses_of_markers(message), message.markers[0].header
            self._settings.check_frame(header.frame_id)
            self._topics.publish_ellipses(
                self._header(header), map(self._in_base_frame, poses))
            self._published_count += 1

    def _on_boxes(self, message: MarkerArray) -> None:
        with self._dropping_what_is_wrong(f'{_OBJECTS}/boxes'):
            boxes, header = boxes_of_markers(message), message.markers[0].header
            self._settings.check_frame(header.frame_id)
            self._topics.publish_boxes(
                self._header(header), list(filter(None, map(self._base_box, boxes))))
            self._published_count += 1

    def _base_box(self, box: SolidBox) -> Optional[SolidBox]:
        x, y, z, yaw = box.pose
        try:
            # As of the PoseArray: whether it is within reach is asked of where it stands.
            self._settings.base_point(x, y, 0.0)
        except OutOfReachError as error:
            self._drop(f'{_OBJECTS}/boxes', error)
            return None
        conversion = self._settings.conversion
        middle = conversion.convert([[x], [y], [z], [1.0]])[:3, 0].tolist()
        return box._replace(pose=Pose(*middle, conversion.convert_yaw(yaw)))

    def _on_silhouettes(self, message: MarkerArray) -> None:
        with self._dropping_what_is_wrong(f'{_OBJECTS}/silhouettes'):
            silhouettes, header = silhouettes_of_markers(message), message.markers[0].header
            self._settings.check_frame(header.frame_id)
            self._silhouettes.publish(
                self._header(header), list(filter(None, map(self._base_silhouette, silhouettes))))
            self._published_count += 1

    def _base_silhouette(self, silhouette: SurfaceSilhouette) -> Optional[SurfaceSilhouette]:
        try:
            place = self._in_base_frame(silhouette.place)
        except OutOfReachError as error:
            self._drop(f'{_OBJECTS}/silhouettes', error)
            return None
        base_from_camera = self._settings.conversion.base_from_camera
        corners = silhouette.corners @ base_from_camera[:3, :3].T + base_from_camera[:3, 3]
        return silhouette._replace(corners=corners, place=place)

    def _on_camera(self, message: PoseWithCovarianceStamped) -> None:
        self._camera = message
        self._convert_camera()

    def _convert_camera(self) -> None:
        """Publish where the camera is in the base frame, anew after new parameters."""
        if self._camera is None:
            return
        with self._dropping_what_is_wrong(_CAMERA):
            self._settings.check_frame(self._camera.header.frame_id)
            pose, covariance = uncertain_pose_from_message(self._camera)
            point = self._settings.conversion.convert_point(*pose[:3])
            self._silhouettes.publish_camera(
                self._header(self._camera.header), UncertainPose(
                    Pose(*point, 0.0), self._node_parameters.current.base_covariance(
                        pose[:3], covariance)))

    def _in_base_frame(self, uncertain: UncertainPose) -> UncertainPose:
        covariance = self._node_parameters.current.base_covariance(
            uncertain.pose[:3], uncertain.covariance)
        return UncertainPose(self._settings.base_pose(uncertain.pose), covariance)

    def _on_objects(self, message: PoseArray) -> None:
        with self._dropping_what_is_wrong(_OBJECTS):
            self._settings.check_frame(message.header.frame_id)
            camera_poses = poses_from_message(message)
            base_poses = self._within_reach(camera_poses)
            # An empty array means that the surface is empty.
            if base_poses or not camera_poses:
                self._topics.publish_objects(self._header(message.header), base_poses)
                self._published_count += 1

    def _within_reach(self, camera_poses: List[Pose]) -> List[Pose]:
        base_poses = []
        for pose in camera_poses:
            try:
                base_poses.append(self._settings.base_pose(pose))
            except OutOfReachError as error:
                self._drop(_OBJECTS, error)
        return base_poses

    def _header(self, camera_header: Header) -> Header:
        # The stamp is the frame's capture time, from which subscribers can compute the delay.
        return Header(stamp=camera_header.stamp, frame_id=self._settings.base_frame_id)

    @contextmanager
    def _dropping_what_is_wrong(self, topic: str) -> Iterator[None]:
        self._received_count += 1
        try:
            yield
        except CameraToBaseError as error:
            self._drop(topic, error)

    def _drop(self, topic: str, error: CameraToBaseError) -> None:
        self._dropped[_DROPPED_AS.get(type(error), 'no position')] += 1
        self.get_logger().warning(
            f'dropped a position on the topic {topic}: {error} '
            f'({self.dropped_count} dropped so far)', throttle_duration_sec=5.0)

    def _health(self) -> Health:
        values = {'source': self.resolve_topic_name(_POSITION),
                  'messages in': str(self._received_count),
                  'messages out': str(self._published_count)}
        values.update((f'dropped: {reason}', str(count))
                      for reason, count in sorted(self._dropped.items()))
        return Health(self._reason(), values)

    def _reason(self) -> Reason:
        newly, self._dropped_before = (
            self.dropped_count - self._dropped_before, self.dropped_count)
        if newly:
            return Reason('positions_dropped', Level.WARN, (
                f'{newly} position(s) dropped in the last second: see who else publishes on '
                f'{_POSITION}, and check reach_cm and camera_frame_id'))
        mismatch = qos_mismatch(self, self._inputs)
        if mismatch is not None:
            self.get_logger().warning(mismatch, once=True)
            return Reason('qos_mismatch', Level.WARN, mismatch)
        # count_publishers does not apply remappings.
        if not self.count_publishers(self.resolve_topic_name(_POSITION)):
            return Reason('no_publisher', Level.WARN,
                          'nobody publishes positions: start camera_publisher')
        return all_well('positions are transformed')


def main(args: Optional[List[str]] = None) -> int:
    """Run the node until a signal arrives."""
    return run('robot_base_publisher', RobotBasePublisher, args)
