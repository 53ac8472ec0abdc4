# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Node: fuses what two cameras or more see of the same objects, and measures their heights."""

import math
import time
from typing import List, Optional

from builtin_interfaces.msg import Time
from camera_to_base.coordinate_transform import CameraPlace, Pose
from camera_to_base.errors import all_well, InvalidValueError, Level, Reason
from camera_to_base.fusion import (
    CameraFrame, ClockCheck, FusedCell, FusedObject, FusedSighting, fusion_settings, FUSION_SPECS,
    FusionSettings, OUTLINE_PX, SeenOutline, Viewpoint)
from camera_to_base.ros import (
    Diagnostics, Health, Heartbeat, latched, left_out_markers, markers_of_bytes, NameCheck,
    NO_EVENTS, NodeParameters, PositionTopics, qos_mismatch, run, silhouettes_of_markers, SolidBox,
    uncertain_pose_from_message, UncertainPose, whole_or_gone)
from camera_to_base.uncertainty import UNKNOWN_ANGLE
from geometry_msgs.msg import PoseWithCovarianceStamped
import numpy as np
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription
from std_msgs.msg import Header
from visualization_msgs.msg import MarkerArray

_SILHOUETTES, _CAMERA = 'objects_in_robot_base_frame/silhouettes', 'camera_in_robot_base_frame'
_WATCH_S = 0.2
# Each event of a subscription slows every message; `qos_mismatch` replaces the event.
_NO_EVENTS = SubscriptionEventCallbacks(use_default_callbacks=False)
# A reason that lasts for less is not shown: the next frame may be good.
_LASTING_S = 0.4
# How far an end of an object's outline may be off, which turns its direction.
_END_CM = 0.05
_NANO = 1e-9


class FusedCamera:
    """
    What is known of a camera.

    :param name: Its namespace.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.frame: Optional[CameraFrame] = None
        self.told = Header()
        # The others wait for its first frame as for each later one.
        self.arrived_at = time.monotonic()
        self.surface_z_cm = 0.0
        self.place: Optional[UncertainPose] = None
        self.subscription: Optional[Subscription] = None

    def is_live(self, max_silence_s: float) -> bool:
        """Tell whether it gives frames."""
        return time.monotonic() - self.arrived_at <= max_silence_s

    @property
    def header(self) -> Header:
        """The header of its frame, as a message."""
        stamp = self.told.stamp
        return Header(stamp=Time(sec=stamp.sec, nanosec=stamp.nanosec),
                      frame_id=self.told.frame_id)

    @property
    def up(self) -> float:
        """1 where the base frame's z points from the surface to the camera, else -1."""
        return math.copysign(1.0, self.place.pose.z - self.surface_z_cm)

    def take(self, message: MarkerArray) -> None:
        """
        Take a message with silhouettes.

        :param message: See `silhouettes_of_markers`.
        :raises InvalidValueError: If it holds none.
        """
        if not message.markers:
            raise InvalidValueError('expected silhouettes, got a message without a marker')
        silhouettes = silhouettes_of_markers(message)
        if silhouettes:
            self.surface_z_cm = float(silhouettes[0].corners[0, 2])
        pose, covariance = self.place
        viewpoint = Viewpoint(
            CameraPlace(tuple(pose[:2]), abs(pose.z - self.surface_z_cm)), covariance[:3, :3])
        self.told = message.markers[0].header
        stamp = self.told.stamp
        self.frame = CameraFrame.of(stamp.sec + _NANO * stamp.nanosec, [
            SeenOutline(one.corners[:, :2], one.place.covariance[:2, :2], viewpoint,
                        OUTLINE_PX * one.pixel_cm)
            for one in silhouettes])
        self.arrived_at = time.monotonic()


class CameraFusion(Node):
    """Publishes the objects that several cameras see, with their heights, in the base frame."""

    def __init__(self, **node_options) -> None:
        super().__init__('camera_fusion', **node_options)
        with whole_or_gone(self):
            self._node_parameters = NodeParameters(
                self, FUSION_SPECS, fusion_settings, self._on_new_settings,
                cli_args=node_options.get('cli_args'))
            self._cameras = [FusedCamera(name) for name in self._settings.cameras]
            self._cell = FusedCell(self._settings.cameras, self._settings.limits)
            self._clocks, self._pending = ClockCheck(), set()
            self._fused_count = self._dropped_count = 0
            self._objects_last = 0
            # Until the cameras have told what is there, no list tells that it is nothing.
            self._is_known = False
            self._passing: Optional[Reason] = None
            self._passing_since, self._told = 0.0, ''
            self._topics = PositionTopics(
                self, 'pos_in_robot_base_frame', 'objects_in_robot_base_frame', live=True)
            self._left_out = self.create_publisher(
                MarkerArray, 'objects_in_robot_base_frame/left_out', 10,
                event_callbacks=NO_EVENTS)
            heartbeat = Heartbeat(self)
            self._diagnostics = Diagnostics(self, heartbeat, self._health)
            NameCheck(self, heartbeat)
            heartbeat.every(_WATCH_S, self._watch)
            for number, camera in enumerate(self._cameras):
                self._listen(number, camera)
            self.get_logger().info(
                f'publishing on {self._topics.name} what {" and ".join(self._settings.cameras)} '
                'see together')

    @property
    def _settings(self) -> FusionSettings:
        return self._node_parameters.current

    def _listen(self, number: int, camera: FusedCamera) -> None:
        self.create_subscription(
            PoseWithCovarianceStamped, f'{camera.name}/{_CAMERA}',
            lambda message: self._on_place(camera, message), latched(),
            event_callbacks=_NO_EVENTS)
        camera.subscription = self.create_subscription(
            MarkerArray, f'{camera.name}/{_SILHOUETTES}',
            lambda raw, info: self._on_silhouettes(number, camera, raw, info), 10, raw=True,
            event_callbacks=_NO_EVENTS,
            qos_overriding_options=QoSOverridingOptions.with_default_policies())

    def _on_new_settings(self) -> None:
        self._cell.limits = self._settings.limits

    def _on_place(self, camera: FusedCamera, message: PoseWithCovarianceStamped) -> None:
        try:
            camera.place = uncertain_pose_from_message(message)
        except InvalidValueError as error:
            self._drop(camera, error)
            return
        # What was remembered was seen from elsewhere.
        self._cell.forget()

    def _on_silhouettes(
        self, number: int, camera: FusedCamera, raw: bytes, info: dict
    ) -> None:
        if camera.place is None:
            return
        try:
            camera.take(markers_of_bytes(raw))
        except InvalidValueError as error:
            self._drop(camera, error)
            return
        if info['source_timestamp'] and info['received_timestamp']:
            self._clocks.note(camera.name, _NANO * info['source_timestamp'],
                              _NANO * info['received_timestamp'])
        self._pending.add(number)
        live = {other for other, one in enumerate(self._cameras)
                if one.is_live(self._settings.max_silence_s)}
        if live <= self._pending and self._odd_frame() is None:
            self._pending.clear()
            self._fuse(live)

    def _fuse(self, live: set) -> None:
        is_untrusted = self._clocks.error(self._settings.stamp_tolerance_s) is not None
        sighting = self._cell.fuse(
            [one.frame if number in live else None for number, one in enumerate(self._cameras)],
            time.monotonic(), is_untrusted)
        latest = max((self._cameras[number] for number in live),
                     key=lambda one: one.frame.stamp_s)
        self._fused_count += 1
        self._objects_last = len(sighting.objects)
        self._is_known |= bool(sighting.objects) or (
            not sighting.left_out and all(one.frame is not None for one in self._cameras))
        self._note(sighting.reason)
        if self._is_known:
            self._publish(latest, sighting)
        self._publish_left_out(latest, sighting)

    def _publish(self, camera: FusedCamera, sighting: FusedSighting) -> None:
        header, objects = camera.header, sighting.objects
        tops = [self._top(camera, one) for one in objects]
        if tops and self._topics.wants_position:
            self._topics.publish_position(*tops[0][:2])
            self._topics.publish_point(header, *tops[0][:3])
        if tops and self._topics.wants_pose:
            self._topics.publish_pose(header, self._uncertain(tops[0], objects[0]))
        self._topics.publish_objects(header, tops)
        if self._topics.wants_ellipses:
            self._topics.publish_ellipses(header, map(self._uncertain, tops, objects))
        if self._topics.wants_boxes:
            self._topics.publish_boxes(header, [self._box(camera, one) for one in objects])

    def _publish_left_out(self, camera: FusedCamera, sighting: FusedSighting) -> None:
        if self._left_out.get_subscription_count():
            self._left_out.publish(left_out_markers(camera.header, [
                (tuple(one.point.tolist()), one.reason) for one in sighting.left_out]))

    @staticmethod
    def _top(camera: FusedCamera, one: FusedObject) -> Pose:
        """Return an object's pose at its top."""
        solution = one.solution
        return Pose(*solution.moments.centre.tolist(),
                    camera.surface_z_cm + camera.up * solution.height.height_cm,
                    solution.moments.yaw or 0.0)

    @staticmethod
    def _uncertain(top: Pose, one: FusedObject) -> UncertainPose:
        solution, covariance = one.solution, np.zeros((6, 6))
        covariance[:2, :2] = solution.covariance
        end = _END_CM / max(solution.extent.length, _END_CM)
        covariance[range(2, 6), range(2, 6)] = (
            solution.height.deviation_cm ** 2, UNKNOWN_ANGLE, UNKNOWN_ANGLE,
            UNKNOWN_ANGLE if solution.moments.yaw is None else end ** 2)
        return UncertainPose(top, covariance)

    @staticmethod
    def _box(camera: FusedCamera, one: FusedObject) -> SolidBox:
        (x, y), (length, width, angle) = one.solution.moments.centre.tolist(), one.solution.extent
        height = max(one.solution.height.height_cm, 0.0)
        middle = camera.surface_z_cm + camera.up * height / 2
        return SolidBox(Pose(x, y, middle, angle), length, width, height)

    def _drop(self, camera: FusedCamera, error: InvalidValueError) -> None:
        self._dropped_count += 1
        self.get_logger().warning(
            f'dropped a message of {camera.name}: {error} ({self._dropped_count} dropped so far)',
            throttle_duration_sec=5.0)

    def _note(self, reason: Optional[Reason]) -> None:
        if reason is None or self._passing is None or reason.kind != self._passing.kind:
            self._passing_since = time.monotonic()
        self._passing = reason

    def _watch(self) -> None:
        reason = self._reason()
        if reason.kind != self._told:
            self._told = reason.kind
            if reason.level:
                self.get_logger().warning(reason.sentence)
            else:
                self.get_logger().info(reason.sentence)
            self._diagnostics.publish()

    def _health(self) -> Health:
        return Health(self._reason(), {
            'source': ', '.join(self._settings.cameras), 'frames fused': str(self._fused_count),
            'objects': str(self._objects_last), 'messages dropped': str(self._dropped_count)})

    def _odd_frame(self) -> Optional[Reason]:
        names = {one.told.frame_id: one.name for one in self._cameras
                 if one.frame is not None and one.is_live(self._settings.max_silence_s)}
        if len(names) < 2:
            return None
        told = ', '.join(f'{camera} in {frame!r}' for frame, camera in names.items())
        return Reason('other_frame', Level.ERROR, (
            f'the cameras publish in different frames, {told}: calibrate them against one base, '
            'and give them one base_frame_id'))

    def _silent(self) -> Optional[Reason]:
        for camera in self._cameras:
            if camera.frame is not None and camera.is_live(self._settings.max_silence_s):
                continue
            mismatch = qos_mismatch(self, [camera.subscription])
            if mismatch is not None:
                return Reason('qos_mismatch', Level.WARN, mismatch)
            topic = self.resolve_topic_name(f'{camera.name}/{_SILHOUETTES}')
            if not self.count_publishers(topic):
                return Reason('no_publisher', Level.WARN, (
                    f'nobody publishes {topic}: start both nodes of {camera.name}'))
            if camera.place is None:
                return Reason('place_unknown', Level.WARN, (
                    f'{camera.name} does not tell where it is: calibrate board with tilted '
                    'placements measures it'))
            return Reason('camera_silent', Level.WARN, (
                f'{camera.name} publishes no positions: its own diagnostics tell why'))
        return None

    def _reason(self) -> Reason:
        odd = self._odd_frame() or self._silent()
        if odd is not None:
            return odd
        clock = self._clocks.error(self._settings.stamp_tolerance_s)
        if clock is not None:
            return Reason('clocks_differ', Level.WARN, (
                f'the clock of {clock.camera} is {abs(clock.ahead_s) * 1000:.0f} ms '
                f'{"ahead" if clock.ahead_s > 0 else "behind"}, or the network is slow: only what '
                'rests is fused; set the clocks by chrony or ptp'))
        if self._passing is not None and (
                not self._is_known or time.monotonic() - self._passing_since >= _LASTING_S):
            return self._passing
        return all_well('objects are fused')


def main(args: Optional[List[str]] = None) -> int:
    """Run the node until a signal arrives."""
    return run('camera_fusion', CameraFusion, args)
