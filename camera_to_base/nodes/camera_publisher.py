# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Node: connects a source, the camera pipeline and the publishers."""

import os
import sys
import time
from typing import List, Optional

from builtin_interfaces.msg import Time
from camera_to_base.coordinate_transform import Pose
from camera_to_base.detection import locate_pixel, Pixel
from camera_to_base.drawing import AreaOverlay, object_label
from camera_to_base.errors import CameraToBaseError
from camera_to_base.nodes.feeds import Feed, FeedCallbacks, start_feed
from camera_to_base.nodes.outputs import CameraPictures, DebugImages, PublishedPositions
from camera_to_base.nodes.services import (
    BackgroundFileKeeper, BackgroundService, CorrectionService)
from camera_to_base.nodes.watch import CameraWatch
from camera_to_base.parameters import (
    all_names, gives_other_values, TRANSFORM_SETUP_SPECS, TRANSFORM_SPECS)
from camera_to_base.pipeline import Sighting
from camera_to_base.ros import (
    keep_freed_memory, NodeParameters, run, use_picture_memory, whole_or_gone)
from camera_to_base.settings import (
    camera_settings, CAMERA_SPECS, CameraSettings, open_named_source)
from camera_to_base.shell_commands import with_full_commands
from camera_to_base.sources import FirstCamera, is_reader_hanging, RANDOM
import numpy as np
from rclpy.node import Node
from std_msgs.msg import Header

# A recording is played after this time even if no subscriber has been discovered.
_LONGEST_WAIT_S = 10.0


class CameraPublisher(Node):
    """Publishes the positions of objects on the work surface, in the camera frame."""

    _feed: Optional[Feed] = None

    def __init__(self, **node_options) -> None:
        super().__init__('camera_publisher', **node_options)
        with whole_or_gone(self):
            self._node_parameters = NodeParameters(
                self, CAMERA_SPECS, camera_settings, self._on_new_settings,
                others=all_names(TRANSFORM_SPECS), cli_args=node_options.get('cli_args'))
            settings = self._settings
            self._source = open_named_source(
                settings, may_be_random=not self._is_configured(node_options.get('cli_args')))
            if self._node_parameters.left_out and isinstance(self._source.frames, FirstCamera):
                self.get_logger().warning(
                    'a parameter was given in vain, see above: without a camera no random '
                    'positions are published')
            self._pipeline = settings.pipeline(self._source.name, self._source.kind)
            self._positions = PublishedPositions(self, self._source)
            self._debug_images = DebugImages(self)
            self._areas = AreaOverlay(settings.surface, settings.detector.areas)
            self._pictures = CameraPictures(self)
            self._background_keeper = BackgroundFileKeeper(
                self, self._pipeline, settings, self._source.kind)
            self._background_service = BackgroundService(
                self, self._pipeline, lambda: self._settings.background_frames,
                lambda: self._feed.reason)
            CorrectionService(self, self._pipeline, lambda: self._settings)
            self._warn_of_settings_without_effect()
            self._calibrated_for = settings.calibrated_for
            self.get_logger().info(self._calibrated_for.summary)
            self._watch = CameraWatch(self, self._pipeline, self._is_calibrated,
                                      lambda: self._background_keeper.doubt)
            self._started_at = time.monotonic()
            self._feed = self._start_feed()
            self._watch.start(self._feed)

    def destroy_node(self) -> None:
        """Release the camera, and destroy the node."""
        if self._feed is not None:
            self._feed.close()
        super().destroy_node()

    @property
    def _settings(self) -> CameraSettings:
        return self._node_parameters.current

    def _is_configured(self, cli_args: Optional[List[str]]) -> bool:
        # Random positions are dangerous where a camera or a robot is set up, or was meant to be.
        transform = f'{self.get_namespace().rstrip("/")}/robot_base_publisher'
        return (self._settings.is_configured or bool(self._node_parameters.left_out)
                or gives_other_values(
                    [*sys.argv, *(cli_args or ())], transform, TRANSFORM_SETUP_SPECS))

    def _is_calibrated(self) -> bool:
        # Random pixels have their own warning.
        return self._settings.is_calibrated or self._source.kind == RANDOM

    def _start_feed(self) -> Feed:
        feed = start_feed(self, self._source, self._settings, self._positions.topic, FeedCallbacks(
            self._on_frame, self._on_pixel, self._may_start, self._on_end))
        if self._source.name != self._settings.source:
            self.get_logger().info(f'found camera {self._source.name}')
        if self._source.kind != RANDOM:
            self.get_logger().info(
                f'publishing on {self._positions.topic} what is found on the frames of '
                f"'{feed.name}'; {self._background_keeper.origin}")
        return feed

    def _on_frame(self, frame: np.ndarray, taken_at: Optional[float], stamp: Time) -> None:
        header, settings = self._header(stamp), self._settings
        sighting = self._pipeline.process(frame, taken_at).told(self._with_commands)
        uncertainty = self._pipeline.frame_uncertainty(frame, settings.uncertainty)
        in_force = self._pipeline.standpoint.surface
        self._positions.publish_sighting(
            header, sighting, settings.hull and in_force.moved(settings.hull), uncertainty,
            in_force.surface)
        self._watch.note(sighting.objects)
        self._areas.use_surface(in_force.surface)
        self._debug_images.publish(
            header, frame, sighting, self._note(sighting),
            object_label(settings.label_conversion), self._areas, uncertainty)
        self._pictures.publish(header, frame, sighting, self._pipeline.background)
        self._background_keeper.keep()
        self._background_service.notice_frame()

    def _on_pixel(self, pixel: Pixel, stamp: Time) -> None:
        try:
            point = locate_pixel(self._settings.surface, pixel)
        except CameraToBaseError as error:
            self.get_logger().error(f'no position taken: {error}', throttle_duration_sec=5.0)
            return
        settings = self._settings
        self._positions.publish(
            self._header(stamp), [Pose(*point, 0.0, 0.0)],
            lambda _: settings.uncertainty.of_pixel(pixel, settings.image_size))

    def _note(self, sighting: Sighting) -> str:
        if sighting.reason is not None:
            return sighting.reason.sentence
        doubt = self._pipeline.doubt
        if doubt is not None:
            return self._with_commands(doubt.sentence)
        return f'background taken {self._pipeline.backgrounds.current.age_s:.0f} s ago'

    def _with_commands(self, sentence: str) -> str:
        return with_full_commands(sentence, self.get_fully_qualified_name())

    def _header(self, stamp: Time) -> Header:
        return Header(stamp=stamp, frame_id=self._settings.camera_frame_id)

    def _may_start(self) -> bool:
        # Discovery takes up to 4 s; until then a subscriber misses the start of the recording.
        return (self._positions.listener_count >= self._settings.wait_for_subscribers
                or time.monotonic() - self._started_at >= _LONGEST_WAIT_S)

    def _on_new_settings(self) -> None:
        settings, calibrated = self._settings, self._settings.calibrated_for
        is_same = calibrated == self._calibrated_for
        self._pipeline.configure(
            settings.surface, settings.detector, settings.limits, settings.markers,
            None if is_same else calibrated.own_camera(self._source.name))
        self._areas = AreaOverlay(settings.surface, settings.detector.areas)
        self._warn_of_settings_without_effect()
        if not is_same:
            self._calibrated_for = calibrated
            self.get_logger().info(calibrated.summary)
        self._feed.configure(settings)

    def _warn_of_settings_without_effect(self) -> None:
        for warning in self._settings.warnings:
            self.get_logger().warning(warning)

    def _on_end(self) -> None:
        count = self._pipeline.counts['frames']
        hint = '' if count != 1 else (
            ', which has become the background: with the parameter repeat:=true a picture is '
            'shown again and again')
        self.get_logger().info(
            f"'{self._source.name}' has ended after {count} frame{'s' * (count != 1)}{hint}")
        self._positions.wait_until_received()
        self.context.try_shutdown()


def main(args: Optional[List[str]] = None) -> int:
    """Run the node until a signal arrives or its recording ends."""
    keep_freed_memory()
    use_picture_memory()
    code = run('camera_publisher', CameraPublisher, args)
    if is_reader_hanging():
        os._exit(code)
    return code
