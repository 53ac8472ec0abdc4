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

"""Node: wires a frame source, the camera pipeline and publishers."""

import os
import time
from typing import Callable, List, Optional, Union

from builtin_interfaces.msg import Time
from camera_to_base.coordinate_transform import Pose
from camera_to_base.detection import locate_pixel, LocatedObject, random_pixel
from camera_to_base.drawing import PictureKeeper
from camera_to_base.errors import CameraToBaseError
from camera_to_base.nodes.background_keeper import BackgroundKeeper
from camera_to_base.nodes.background_service import BackgroundService
from camera_to_base.nodes.camera_watch import CameraWatch
from camera_to_base.nodes.debug_images import DebugImages
from camera_to_base.nodes.frame_feeds import CameraFeed, TimedFeed
from camera_to_base.nodes.image_topic import ImageTopic
from camera_to_base.nodes.process import run, whole_or_gone
from camera_to_base.nodes.true_positions import TruePositions
from camera_to_base.ros import NodeParameters, PositionTopics, real_time_timer
from camera_to_base.settings import (
    camera_settings, CAMERA_SPECS, CameraSettings, open_named_source, TOPIC_SOURCES)
from camera_to_base.simulation import SimulatedBoard
from camera_to_base.sources import Camera, is_reader_hanging, is_stream, VideoFile
from camera_to_base.trust import CameraPipeline, DamageCheck, Limits, Sighting
import numpy as np
from rclpy.node import Node
from std_msgs.msg import Header

# What is sent while two nodes still discover each other arrives this late.
_LONGEST_DISCOVERY_S = 5.0
# A recording that nobody listens to is played all the same.
_LONGEST_WAIT_S = 10.0
_POSITION = 'pos_in_cam_frame'


Feed = Union[TimedFeed, CameraFeed, ImageTopic]


class CameraPublisher(Node):
    """Publishes where objects lie on the work surface, in the camera frame."""

    _feed: Optional[Feed] = None

    def __init__(self, **node_options) -> None:
        super().__init__('camera_publisher', **node_options)
        with whole_or_gone(self):
            self._node_parameters = NodeParameters(
                self, CAMERA_SPECS, camera_settings, self._on_new_settings)
            self._source = open_named_source(self._settings)
            self._tell_what_is_used()
            self._topics = PositionTopics(
                self, _POSITION, 'objects_in_cam_frame', live=self._is_live())
            self._debug_images = DebugImages(self)
            self._pipeline = CameraPipeline(
                self._settings.surface, self._settings.detector, self._limits(),
                self._settings.background_frames)
            self._background_keeper = BackgroundKeeper(
                self, self._pipeline, self._settings, self._is_live())
            self._picture = PictureKeeper(self._settings.annotated_picture)
            self._background_service = BackgroundService(
                self, self._pipeline, lambda: self._settings.background_frames,
                lambda: self._feed is not None)
            self._warn_of_settings_without_effect()
            self._watch = CameraWatch(self, self._pipeline)
            self._truth = (TruePositions(self, self._source)
                           if isinstance(self._source, SimulatedBoard) else None)
            self._feed = self._start_feed()
            if self._feed is None:
                self._timer = real_time_timer(self, self._settings.period, self._on_random_timer)

    def destroy_node(self) -> None:
        """Give the camera back with the node."""
        if self._feed is not None:
            self._feed.close()
        super().destroy_node()

    @property
    def _settings(self) -> CameraSettings:
        return self._node_parameters.current

    def _limits(self) -> Limits:
        limits = self._settings.limits
        return limits.for_recording if isinstance(self._source, VideoFile) else limits

    def _is_live(self) -> bool:
        return isinstance(self._source, Camera) or self._settings.source in TOPIC_SOURCES

    def _is_random(self) -> bool:
        return self._source is None and not self._is_live()

    def _tell_what_is_used(self) -> None:
        if isinstance(self._source, Camera) and self._settings.source == 'auto':
            self.get_logger().info(f'found camera {self._source.name}')
        elif self._is_random():
            reason = '' if self._settings.source == 'random' else 'no camera is attached: '
            topic = self.resolve_topic_name(_POSITION)
            self.get_logger().warning(
                f'{reason}the positions on {topic} are RANDOM, as in the tutorial; name a camera '
                'or a file with the parameter source')

    def _start_feed(self) -> Optional[Feed]:
        name = self._settings.source
        if name in TOPIC_SOURCES:
            feed = self._subscribe(compressed=name == 'compressed_topic')
            name = feed.topic_name
        elif self._source is None:
            return None
        elif self._source.frame_rate:
            self._started_at = time.monotonic()
            feed = TimedFeed(self, self._source, self._use, self._may_start, self._end)
        else:
            feed = CameraFeed(self, self._source, self._use, may_lag=is_stream(name),
                              wait=self._settings.wait_for_camera)
        self.get_logger().info(
            f"publishing on {self._topics.name} what is found on the frames of '{name}'; "
            f'{self._background_keeper.origin}')
        self._watch.start(name, feed.reader)
        return feed

    def _subscribe(self, compressed: bool) -> ImageTopic:
        # In a simulation without noise good frames repeat themselves to the byte.
        is_simulation = self.get_parameter('use_sim_time').value
        damage = DamageCheck().reason if not is_simulation else lambda frame: None
        return ImageTopic(self, self._use, damage, compressed)

    def _may_start(self) -> bool:
        # Discovery takes up to 4 s, and who is not discovered misses the recording's beginning.
        return (not isinstance(self._source, VideoFile)
                or self._topics.listener_count >= self._settings.wait_for_subscribers
                or time.monotonic() - self._started_at >= _LONGEST_WAIT_S)

    def _on_random_timer(self) -> None:
        pixel = random_pixel()
        try:
            point = locate_pixel(self._settings.surface, pixel)
        except CameraToBaseError as error:
            self.get_logger().error(f'no position taken: {error}', throttle_duration_sec=5.0)
            return
        self._publish(self._header(self.get_clock().now().to_msg()), [Pose(*point, 0.0, 0.0)])
        self._keep_picture(self._picture.keep_pixel, self._settings.image_size, pixel, point)

    def _use(self, frame: np.ndarray, taken_at: Optional[float], stamp: Time) -> None:
        header = self._header(stamp)
        sighting = self._pipeline.process(frame, taken_at)
        if self._truth is not None:
            self._truth.publish(header)
        if sighting.reason is None:
            self._warn_outside_hull(sighting.objects)
            self._publish(header, [Pose(*found.point, 0.0, found.yaw or 0.0)
                                   for found in sighting.objects])
            if sighting.objects:
                self._keep_picture(self._picture.keep, frame, sighting.objects)
        self._debug_images.publish(
            header, frame, sighting, self._note(sighting), self._settings.debug_label)
        self._background_keeper.keep()
        self._background_service.notice_frame()

    def _note(self, sighting: Sighting) -> str:
        if sighting.reason is not None:
            return sighting.reason.sentence
        return f'background taken {self._pipeline.background_age_s:.0f} s ago'

    def _header(self, stamp: Time) -> Header:
        return Header(stamp=stamp, frame_id=self._settings.camera_frame_id)

    def _publish(self, header: Header, poses: List[Pose]) -> None:
        if poses:
            largest = poses[0]
            self._topics.publish_position(largest.x, largest.y)
            self._topics.publish_point(header, largest.x, largest.y)
        self._topics.publish_objects(header, poses)

    def _warn_outside_hull(self, objects: List[LocatedObject]) -> None:
        # Outside the area that the calibration was measured in, its figures do not hold.
        hull = self._settings.hull
        if objects and hull is not None and not hull.contains(objects[0].detection.centre):
            pixel, point = objects[0].detection.centre, objects[0].point
            self.get_logger().warning(
                f'the object at ({point.x:.2f}, {point.y:.2f}) cm, pixel ({pixel.u:g}, '
                f'{pixel.v:g}), lies outside the area that the calibration was measured in: its '
                'position may be less accurate', throttle_duration_sec=5.0)

    def _on_new_settings(self) -> None:
        if isinstance(self._source, Camera):
            self._source.image_size = self._settings.image_size
        self._pipeline.configure(self._settings.surface, self._settings.detector, self._limits())
        self._warn_of_settings_without_effect()
        if self._feed is None:
            self._timer.timer_period_ns = round(self._settings.period * 1e9)
            self._timer.reset()

    def _warn_of_settings_without_effect(self) -> None:
        detector = self._settings.detector
        for name in detector.without_effect:
            self.get_logger().warning(
                f'detector.{name} has no effect with detector.method {detector.method}')
        for old, new in detector.renamed:
            self.get_logger().warning(
                f'detector.{old} is now called detector.{new}: use the new name, the old one ends '
                'with the next release')

    def _keep_picture(self, keep: Callable[..., None], *what) -> None:
        try:
            keep(*what)
        except CameraToBaseError as error:
            self.get_logger().error(str(error), throttle_duration_sec=60.0)

    def _end(self) -> None:
        self.get_logger().info(
            f"'{self._settings.source}' has ended after {self._pipeline.counts['frames']} frames")
        self._topics.wait_until_received(_LONGEST_DISCOVERY_S)
        self.context.try_shutdown()


def main(args: Optional[List[str]] = None) -> int:
    """Run the node until it is told to end, or its recording ends."""
    code = run('camera_publisher', CameraPublisher, args)
    if is_reader_hanging():
        os._exit(code)
    return code
