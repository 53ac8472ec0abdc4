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

from dataclasses import asdict, astuple
import os
import random
from typing import List, Optional

from camera_to_base.absolute_difference import AbsoluteDifferenceDetector, Pixel
from camera_to_base.camera_health import camera_problem, camera_values, Problem
from camera_to_base.camera_parameters import camera_settings, CAMERA_SPECS, CameraSettings
from camera_to_base.camera_pipeline import CameraPipeline, Limits
from camera_to_base.damage_check import DamageCheck
from camera_to_base.diagnostics import Diagnostics
from camera_to_base.errors import CameraToBaseError
from camera_to_base.frame_reader import FrameReader, is_reader_hanging
from camera_to_base.frame_sources import (
    Camera, first_camera, FrameSource, is_camera, is_stream, open_frame_source, VideoFile)
from camera_to_base.health import Health, Level
from camera_to_base.lifetime import run
from camera_to_base.messages import position_message
from camera_to_base.object_locator import locate_pixel, LocatedObject, Point
from camera_to_base.overlay import draw_objects, draw_pixel, write_picture
from camera_to_base.parameters import NodeParameters
from camera_to_base.simulated_board import SimulatedBoard
import numpy as np
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.task import Future
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import Trigger

# The tutorial draws random pixels from this range in both directions.
_LOWEST_RANDOM, _HIGHEST_RANDOM = 250, 450
_START_PERIOD_S = 0.1
# A recording that nobody listens to is played all the same.
_LONGEST_WAIT_S = 10.0
_WATCH_PERIOD_S = 0.2
# A background that is not complete after as long as this never will be.
_CAPTURE_TIMEOUT_S = 10.0


class CameraPublisher(Node):
    """Publishes where the largest object lies on the work surface, in the camera frame."""

    def __init__(self, **node_options) -> None:
        super().__init__('camera_publisher', **node_options)
        self._node_parameters = NodeParameters(
            self, CAMERA_SPECS, camera_settings, self._on_new_settings)
        self._publisher = self.create_publisher(
            Float64MultiArray, 'pos_in_cam_frame', 10,
            qos_overriding_options=QoSOverridingOptions.with_default_policies())
        self._pipeline = CameraPipeline(
            self._make_detector, self._settings.surface, self._limits(),
            self._settings.background_frames)
        self._captured: Optional[Future] = None
        self._problem: Optional[Problem] = None
        self._largest_area = -1.0
        self._reader: Optional[FrameReader] = None
        self._source = self._open_source()
        # A group of its own: frames come in while it waits for them.
        self.create_service(
            Trigger, '~/capture_background', self._on_capture_background,
            callback_group=MutuallyExclusiveCallbackGroup())
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

    def _open_source(self) -> Optional[FrameSource]:
        name, image_size = self._settings.source, self._settings.image_size
        if name == 'simulated':
            return SimulatedBoard(image_size=image_size, **asdict(self._settings.simulated))
        if is_camera(name):
            return Camera(name, image_size, open_now=False)
        if name not in ('auto', 'random'):
            return open_frame_source(name, image_size)
        camera = first_camera(image_size) if name == 'auto' else None
        if camera is not None:
            self.get_logger().info(f'using camera {camera.name}')
        else:
            reason = 'no camera is attached: ' if name == 'auto' else ''
            self.get_logger().warning(
                f'{reason}the positions on {self._publisher.topic_name} are RANDOM, as in the '
                'tutorial; name a camera or a file with the parameter source')
        return camera

    def _start(self) -> None:
        if self._source is None:
            self._timer = self.create_timer(self._settings.period, self._on_random_timer)
            return
        self._truth_publisher = self._create_truth_publisher()
        if self._source.frame_rate:
            self._started_at = self.get_clock().now()
            self._timer = self.create_timer(_START_PERIOD_S, self._on_start_timer)
        else:
            self._start_reader()
        self.create_timer(_WATCH_PERIOD_S, self._on_watch_timer)

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

    def _create_truth_publisher(self):
        if not isinstance(self._source, SimulatedBoard):
            return None
        return self.create_publisher(Float64MultiArray, 'true_pos_in_cam_frame', 10)

    def _on_start_timer(self) -> None:
        if isinstance(self._source, VideoFile) and self._is_waiting_for_subscribers():
            return
        self.destroy_timer(self._timer)
        self._timer = self.create_timer(1 / self._source.frame_rate, self._on_frame_timer)

    def _is_waiting_for_subscribers(self) -> bool:
        # Discovery takes up to 4 s, and who is not discovered misses the recording's beginning.
        waited = self.get_clock().now() - self._started_at
        return (self._publisher.get_subscription_count() < self._settings.wait_for_subscribers
                and waited < Duration(seconds=_LONGEST_WAIT_S))

    def _on_random_timer(self) -> None:
        pixel = Pixel(*(random.randint(_LOWEST_RANDOM, _HIGHEST_RANDOM) for _ in 'uv'))
        try:
            point = locate_pixel(self._settings.surface, pixel)
            self._publish(point)
            self._keep_random_picture(pixel, point)
        except CameraToBaseError as error:
            self._refuse(error)

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
            objects = self._pipeline.process(frame, taken_at)
            self._publish_truth()
            if objects:
                self._publish(objects[0].point)
                self._keep_picture(frame, objects)
        except CameraToBaseError as error:
            self._refuse(error)
        if self._captured is not None and self._pipeline.background is not None:
            self._captured.set_result(True)

    def _make_detector(self, background: np.ndarray) -> AbsoluteDifferenceDetector:
        return AbsoluteDifferenceDetector(background, **asdict(self._settings.detector))

    def _limits(self) -> Limits:
        settings = self._settings
        return Limits(settings.max_frame_age, settings.confirm_jump_px, *astuple(settings.view))

    def _on_new_settings(self) -> None:
        self._pipeline.configure(self._make_detector, self._settings.surface, self._limits())
        if self._source is None:
            self._set_timer_period(self._settings.period)

    async def _on_capture_background(
        self, request: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        if self._source is None:
            response.message = 'random pixels have no background: name a camera with source'
            return response
        count = self._settings.background_frames
        self._pipeline.capture_background(count)
        self._captured = captured = Future()
        deadline = self.create_timer(_CAPTURE_TIMEOUT_S, lambda: captured.set_result(False))
        response.success = await captured
        self.destroy_timer(deadline)
        if response.success:
            height, width = self._pipeline.background.shape[:2]
            response.message = f'took {width} x {height} px, the median of {count} frame(s)'
        else:
            response.message = (f'not {count} good frame(s) in {_CAPTURE_TIMEOUT_S:g} s; the next '
                                'ones become the background')
        return response

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

    def _keep_picture(self, frame: np.ndarray, objects: List[LocatedObject]) -> None:
        area = objects[0].detection.area
        if self._settings.annotated_picture and area > self._largest_area:
            self._largest_area = area
            write_picture(self._settings.annotated_picture, draw_objects(frame, objects))

    def _keep_random_picture(self, pixel: Pixel, point: Point) -> None:
        if self._settings.annotated_picture:
            write_picture(self._settings.annotated_picture,
                          draw_pixel(self._settings.image_size, pixel, point))

    def _set_timer_period(self, period_s: float) -> None:
        period_ns = round(period_s * 1e9)
        if self._timer.timer_period_ns != period_ns:
            self._timer.timer_period_ns = period_ns
            self._timer.reset()

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
