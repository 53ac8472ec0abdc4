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

"""Node: wires a frame source, the camera pipeline and a publisher."""

from dataclasses import astuple
import os
import random
import time
from typing import Callable, List, Optional

from camera_to_base.background_service import BackgroundService
from camera_to_base.camera_health import camera_problem, camera_values, Problem
from camera_to_base.camera_parameters import camera_settings, CAMERA_SPECS, CameraSettings
from camera_to_base.camera_pipeline import CameraPipeline, Limits
from camera_to_base.damage_check import DamageCheck
from camera_to_base.detection import Pixel
from camera_to_base.diagnostics import Diagnostics
from camera_to_base.errors import CameraToBaseError
from camera_to_base.frame_reader import FrameReader, is_reader_hanging
from camera_to_base.frame_sources import (
    Camera, first_camera, FrameSource, is_camera, is_stream, open_frame_source, VideoFile)
from camera_to_base.health import Health, Level
from camera_to_base.lifetime import run
from camera_to_base.messages import position_message
from camera_to_base.object_locator import locate_pixel, LocatedObject, Point
from camera_to_base.parameters import NodeParameters
from camera_to_base.picture_keeper import PictureKeeper
from camera_to_base.simulated_board import SimulatedBoard
import numpy as np
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.timer import Timer
from std_msgs.msg import Float64MultiArray

# The tutorial draws random pixels from this range in both directions.
_LOWEST_RANDOM, _HIGHEST_RANDOM = 250, 450
_START_PERIOD_S = 0.1
# A recording that nobody listens to is played all the same.
_LONGEST_WAIT_S = 10.0
_WATCH_PERIOD_S = 0.2


class CameraPublisher(Node):
    """Publishes where the largest object lies on the work surface, in the camera frame."""

    def __init__(self, **node_options) -> None:
        super().__init__('camera_publisher', **node_options)
        self._node_parameters = NodeParameters(
            self, CAMERA_SPECS, camera_settings, self._on_new_settings)
        self._publisher = self.create_publisher(
            Float64MultiArray, 'pos_in_cam_frame', 10,
            qos_overriding_options=QoSOverridingOptions.with_default_policies())
        self._source = self._open_source()
        self._pipeline = CameraPipeline(
            self._settings.surface, self._settings.detector, self._limits(),
            self._settings.background_frames)
        self._picture = PictureKeeper(self._settings.annotated_picture)
        self._problem: Optional[Problem] = None
        self._reader: Optional[FrameReader] = None
        self._background_service = BackgroundService(
            self, self._pipeline, lambda: self._settings.background_frames,
            lambda: self._source is not None)
        Diagnostics(self, self._health)
        self._start()

    def destroy_node(self) -> None:
        """Give the camera back with the node."""
        if self._reader is not None:
            self._reader.close()
        elif self._source is not None:
            self._source.release()
        super().destroy_node()

    @property
    def _settings(self) -> CameraSettings:
        return self._node_parameters.current

    def _limits(self) -> Limits:
        settings = self._settings
        limits = Limits(settings.max_frame_age, settings.confirm_jump_px, *astuple(settings.view))
        # A recording is not what an arm follows: it is shown as it is.
        recorded = isinstance(self._source, VideoFile)
        return limits._replace(max_shift_px=0.0) if recorded else limits

    def _open_source(self) -> Optional[FrameSource]:
        name, image_size = self._settings.source, self._settings.image_size
        if name == 'simulated':
            return self._settings.simulated.board(image_size)
        if is_camera(name):
            return Camera(name, image_size, open_now=False)
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

    def _start(self) -> None:
        if self._source is None:
            self._timer = self._create_timer(self._settings.period, self._on_random_timer)
            return
        self._truth_publisher = self._create_truth_publisher()
        self.get_logger().info(
            f'publishing on {self._publisher.topic_name} what is found on the frames of '
            f"'{self._settings.source}'; the first one is the background")
        if self._source.frame_rate:
            self._started_at = time.monotonic()
            self._timer = self._create_timer(_START_PERIOD_S, self._on_start_timer)
        else:
            self._start_reader()
        self._create_timer(_WATCH_PERIOD_S, self._on_watch_timer)

    def _start_reader(self) -> None:
        new_frame = self.create_guard_condition(self._on_camera_frame)
        self._reader = FrameReader(
            self._source, new_frame.trigger, DamageCheck().reason,
            may_lag=is_stream(self._settings.source))
        try:
            if not self._settings.wait_for_camera:
                self._reader.wait_for_first_attempt()
        except BaseException:
            self._reader.close()
            raise

    def _create_truth_publisher(self) -> Optional[Publisher]:
        if not isinstance(self._source, SimulatedBoard):
            return None
        return self.create_publisher(Float64MultiArray, 'true_pos_in_cam_frame', 10)

    def _create_timer(self, period_s: float, callback: Callable[[], None]) -> Timer:
        # Frames come in real time, whatever time the simulation of a robot has.
        return self.create_timer(period_s, callback, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _on_start_timer(self) -> None:
        if isinstance(self._source, VideoFile) and self._is_waiting_for_subscribers():
            return
        self.destroy_timer(self._timer)
        self._timer = self._create_timer(1 / self._source.frame_rate, self._on_frame_timer)

    def _is_waiting_for_subscribers(self) -> bool:
        # Discovery takes up to 4 s, and who is not discovered misses the recording's beginning.
        return (self._publisher.get_subscription_count() < self._settings.wait_for_subscribers
                and time.monotonic() - self._started_at < _LONGEST_WAIT_S)

    def _on_random_timer(self) -> None:
        pixel = Pixel(*(random.randint(_LOWEST_RANDOM, _HIGHEST_RANDOM) for _ in 'uv'))
        try:
            point = locate_pixel(self._settings.surface, pixel)
        except CameraToBaseError as error:
            self._refuse(error)
            return
        self._publish(point)
        self._keep_picture(self._picture.keep_pixel, self._settings.image_size, pixel, point)

    def _on_frame_timer(self) -> None:
        frame = self._source.read()
        if frame is None:
            self._end()
        else:
            self._use(frame)

    def _on_camera_frame(self) -> None:
        taken = self._reader.take()
        if taken is not None:
            self._use(*taken)

    def _use(self, frame: np.ndarray, taken_at: Optional[float] = None) -> None:
        try:
            objects = self._trusted(self._pipeline.process(frame, taken_at))
        except CameraToBaseError as error:
            self._refuse(error)
            objects = []
        self._publish_truth()
        if objects:
            self._publish(objects[0].point)
            self._keep_picture(self._picture.keep, frame, objects)
        self._background_service.notice_frame()

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

    def _on_new_settings(self) -> None:
        self._pipeline.configure(self._settings.surface, self._settings.detector, self._limits())
        if self._source is None:
            self._timer.timer_period_ns = round(self._settings.period * 1e9)
            self._timer.reset()

    def _on_watch_timer(self) -> None:
        before, self._problem = self._problem, camera_problem(
            self._reader, self._pipeline, self._settings.source)
        problem = self._problem
        if problem is None and before is not None:
            self.get_logger().info('ready: objects on the surface are published')
        elif problem is not None and (before is None or before.kind != problem.kind):
            self._tell(problem)

    def _tell(self, problem: Problem) -> None:
        # rclpy refuses another severity from the same line.
        if problem.level is Level.ERROR:
            self.get_logger().error(problem.sentence)
        else:
            self.get_logger().info(problem.sentence)

    def _health(self) -> Health:
        values = {'source': self._settings.source,
                  **camera_values(self._reader, self._pipeline)}
        if self._source is None:
            return Health(Level.WARN, 'positions are random: name a camera with source', values)
        if self._problem is not None:
            return Health(self._problem.level, self._problem.sentence, values)
        return Health(Level.OK, 'objects on the surface are published', values)

    def _publish(self, point: Point) -> None:
        self._publisher.publish(position_message(point.x, point.y))

    def _publish_truth(self) -> None:
        if self._truth_publisher is not None and self._source.true_point is not None:
            self._truth_publisher.publish(position_message(*self._source.true_point))

    def _keep_picture(self, keep: Callable[..., None], *what) -> None:
        try:
            keep(*what)
        except CameraToBaseError as error:
            self.get_logger().error(str(error), throttle_duration_sec=60.0)

    def _refuse(self, error: CameraToBaseError) -> None:
        self.get_logger().error(f'no position taken: {error}', throttle_duration_sec=5.0)

    def _end(self) -> None:
        self.get_logger().info(
            f"'{self._settings.source}' has ended after {self._pipeline.counts['frames']} frames")
        self._timer.cancel()
        self._publisher.wait_for_all_acked(Duration(seconds=1))
        self.context.try_shutdown()


def main(args: Optional[List[str]] = None) -> int:
    """Run the node until it is told to end, or its recording ends."""
    code = run('camera_publisher', CameraPublisher, args)
    if is_reader_hanging():
        os._exit(code)
    return code
