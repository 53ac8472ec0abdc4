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

"""Node: wires a frame source, a detector and a surface to a publisher."""

import random
import time
from typing import Callable, List, Optional

from camera_to_base.camera_parameters import camera_settings, CAMERA_SPECS, CameraSettings
from camera_to_base.detection import Pixel
from camera_to_base.errors import CameraToBaseError, FrameSourceError
from camera_to_base.frame_sources import first_camera, FrameSource, open_frame_source, VideoFile
from camera_to_base.lifetime import run
from camera_to_base.messages import position_message
from camera_to_base.object_locator import locate_pixel, LocatedObject, ObjectLocator, Point
from camera_to_base.overlay import draw_objects, draw_pixel, write_picture
from camera_to_base.parameters import NodeParameters
from camera_to_base.simulated_board import SimulatedBoard
import numpy as np
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.timer import Timer
from std_msgs.msg import Float64MultiArray

# The tutorial draws random pixels from this range in both directions.
_LOWEST_RANDOM, _HIGHEST_RANDOM = 250, 450
# A camera waits for its next frame itself: it is read again at once.
_AT_ONCE_S = 0.001
_START_PERIOD_S = 0.1
# A recording that nobody listens to is played all the same.
_LONGEST_WAIT_S = 10.0
# How long a camera that gives no frame is left alone.
_RETRY_S = 1.0


class CameraPublisher(Node):
    """Publishes where the largest object lies on the work surface, in the camera frame."""

    def __init__(self, **node_options) -> None:
        super().__init__('camera_publisher', **node_options)
        self._node_parameters = NodeParameters(
            self, CAMERA_SPECS, camera_settings, self._on_new_settings)
        self._publisher = self.create_publisher(
            Float64MultiArray, 'pos_in_cam_frame', 10,
            qos_overriding_options=QoSOverridingOptions.with_default_policies())
        self._background: Optional[np.ndarray] = None
        self._locator: Optional[ObjectLocator] = None
        self._frame_count = 0
        self._largest_area = -1.0
        self._source = self._open_source()
        if self._source is None:
            self._timer = self._create_timer(self._settings.period, self._on_random_timer)
        else:
            self._truth_publisher = self._create_truth_publisher()
            self.get_logger().info(
                f'publishing on {self._publisher.topic_name} what is found on the frames of '
                f"'{self._settings.source}'; the first one is the background")
            self._started_at = time.monotonic()
            self._timer = self._create_timer(_START_PERIOD_S, self._on_start_timer)

    def destroy_node(self) -> None:
        """Give the camera back with the node."""
        if self._source is not None:
            self._source.release()
        super().destroy_node()

    @property
    def _settings(self) -> CameraSettings:
        return self._node_parameters.current

    def _open_source(self) -> Optional[FrameSource]:
        name, image_size = self._settings.source, self._settings.image_size
        if name == 'simulated':
            return self._settings.simulated.board(image_size)
        if name not in ('auto', 'random'):
            return open_frame_source(name, image_size)
        camera = first_camera(image_size) if name == 'auto' else None
        if camera is not None:
            self.get_logger().info(f'found camera {camera.name}')
        else:
            reason = 'no camera is attached: ' if name == 'auto' else ''
            self.get_logger().warning(
                f'{reason}the positions on {self._publisher.topic_name} are RANDOM, as in the '
                'tutorial; name a camera or a file with the parameter source')
        return camera

    def _create_truth_publisher(self):
        if not isinstance(self._source, SimulatedBoard):
            return None
        return self.create_publisher(Float64MultiArray, 'true_pos_in_cam_frame', 10)

    def _create_timer(self, period_s: float, callback: Callable[[], None]) -> Timer:
        # Frames come in real time, whatever time the simulation of a robot has.
        return self.create_timer(period_s, callback, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _frame_period(self) -> float:
        return 1 / self._source.frame_rate if self._source.frame_rate else _AT_ONCE_S

    def _on_start_timer(self) -> None:
        if isinstance(self._source, VideoFile) and self._is_waiting_for_subscribers():
            return
        self.destroy_timer(self._timer)
        self._timer = self._create_timer(self._frame_period(), self._on_frame_timer)

    def _is_waiting_for_subscribers(self) -> bool:
        # Discovery takes up to 4 s, and who is not discovered misses the recording's beginning.
        return (self._publisher.get_subscription_count() < self._settings.wait_for_subscribers
                and time.monotonic() - self._started_at < _LONGEST_WAIT_S)

    def _on_random_timer(self) -> None:
        pixel = Pixel(*(random.randint(_LOWEST_RANDOM, _HIGHEST_RANDOM) for _ in 'uv'))
        try:
            point = locate_pixel(self._settings.surface, pixel)
            self._publish(point)
            self._keep_random_picture(pixel, point)
        except CameraToBaseError as error:
            self._refuse(error)

    def _on_frame_timer(self) -> None:
        try:
            frame = self._source.read()
        except FrameSourceError as error:
            self._retry(error)
            return
        self._set_timer_period(self._frame_period())
        if frame is None:
            self._end()
            return
        self._frame_count += 1
        try:
            self._on_frame(frame)
        except CameraToBaseError as error:
            self._refuse(error)

    def _on_frame(self, frame: np.ndarray) -> None:
        if self._background is None:
            self._background = frame
        objects = self._trusted(self._current_locator().locate(frame))
        self._publish_truth()
        if objects:
            self._publish(objects[0].point)
            self._keep_picture(frame, objects)

    def _trusted(self, objects: List[LocatedObject]) -> List[LocatedObject]:
        # Outside the area that the calibration was measured in, its figures do not hold.
        hull = self._settings.hull
        inside = [found for found in objects
                  if hull is None or hull.contains(found.detection.centre)]
        if self._settings.reject_outside_hull:
            return inside
        if objects and (not inside or inside[0] is not objects[0]):
            pixel, point = objects[0].detection.centre, objects[0].point
            self.get_logger().warning(
                f'the object at ({point.x:.2f}, {point.y:.2f}) cm, pixel ({pixel.u:g}, '
                f'{pixel.v:g}), lies outside the area that the calibration was measured in: its '
                'position may be less accurate', throttle_duration_sec=5.0)
        return objects

    def _current_locator(self) -> ObjectLocator:
        if self._locator is None:
            self._locator = ObjectLocator(
                self._background, self._settings.surface, self._settings.detector)
        return self._locator

    def _on_new_settings(self) -> None:
        self._locator = None
        if self._source is None:
            self._set_timer_period(self._settings.period)

    def _publish(self, point: Point) -> None:
        self._publisher.publish(position_message(point.x, point.y))

    def _publish_truth(self) -> None:
        if self._truth_publisher is not None and self._source.true_point is not None:
            self._truth_publisher.publish(position_message(*self._source.true_point))

    def _keep_picture(self, frame: np.ndarray, objects: List[LocatedObject]) -> None:
        area = objects[0].detection.area
        if self._settings.annotated_picture and area > self._largest_area:
            self._largest_area = area
            self._write_picture(draw_objects(frame, objects))

    def _keep_random_picture(self, pixel: Pixel, point: Point) -> None:
        if self._settings.annotated_picture:
            self._write_picture(draw_pixel(self._settings.image_size, pixel, point))

    def _write_picture(self, picture: np.ndarray) -> None:
        try:
            write_picture(self._settings.annotated_picture, picture)
        except CameraToBaseError as error:
            self.get_logger().error(str(error), throttle_duration_sec=60.0)

    def _set_timer_period(self, period_s: float) -> None:
        period_ns = round(period_s * 1e9)
        if self._timer.timer_period_ns != period_ns:
            self._timer.timer_period_ns = period_ns
            self._timer.reset()

    def _retry(self, error: FrameSourceError) -> None:
        self.get_logger().error(
            f'{error} Nothing is published until it is back.', throttle_duration_sec=5.0)
        self._set_timer_period(_RETRY_S)

    def _refuse(self, error: CameraToBaseError) -> None:
        self.get_logger().error(f'no position taken: {error}', throttle_duration_sec=5.0)

    def _end(self) -> None:
        self.get_logger().info(
            f"'{self._settings.source}' has ended after {self._frame_count} frames")
        self._timer.cancel()
        self._publisher.wait_for_all_acked(Duration(seconds=1))
        self.context.try_shutdown()


def main(args: Optional[List[str]] = None) -> int:
    """Run the node until it is told to end, or its recording ends."""
    return run('camera_publisher', CameraPublisher, args)
