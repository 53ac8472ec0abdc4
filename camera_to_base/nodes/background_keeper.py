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

"""Keeps a camera node's background in a file, so that a restarted node can use it."""

from datetime import datetime, timedelta

from camera_to_base.drawing import BackgroundFile
from camera_to_base.errors import CameraToBaseError
from camera_to_base.settings import CameraSettings
from camera_to_base.shell_commands import with_full_commands
from camera_to_base.sources import RANDOM, SourceKind
from camera_to_base.trust import CameraPipeline
from rclpy.node import Node


class BackgroundFileKeeper:
    """
    Reads the background from the parameter's file, and writes each new one there.

    If the file cannot be used, the node logs why and takes a new background.

    :param node: The node whose logger is used.
    :param pipeline: The pipeline that takes the background.
    :param settings: The camera node's settings.
    :param kind: The kind of source; only live sources have a file.
    """

    def __init__(
        self, node: Node, pipeline: CameraPipeline, settings: CameraSettings, kind: SourceKind
    ) -> None:
        self._logger = node.get_logger()
        self._camera_node = node.get_fully_qualified_name()
        self._pipeline = pipeline
        self._is_live = kind.is_live
        self._path = settings.background_file if kind.is_live else ''
        self._calibrated_at = settings.calibrated_for.date
        self._file = BackgroundFile(self._path)
        # No second warning for random pixels: their own warning covers it.
        if settings.background_file and not kind.is_live and kind != RANDOM:
            self._logger.warning(
                f"background_file has no effect with source '{settings.source}': only the "
                'background of a camera or a topic is kept')
        self._restore()

    @property
    def origin(self) -> str:
        """Where the background comes from, for the log."""
        if self._pipeline.background is None:
            good = 'good ' if self._is_live else ''
            return f'the first {good}one is the background'
        age_s = self._pipeline.backgrounds.current.age_s
        return with_full_commands(
            f"the background is that of '{self._path}', taken {age_s:.0f} s ago; to take it anew, "
            'call ~/capture_background', self._camera_node)

    def keep(self) -> None:
        """Write the background to the file if it is new."""
        try:
            seen = self._pipeline.standpoint.background_as_calibrated
            if seen is not None:
                self._file.keep(seen.picture, seen.unknown)
        except CameraToBaseError as error:
            self._logger.error(f'the background is not kept: {error}')

    def _restore(self) -> None:
        try:
            kept = self._file.read()
        except CameraToBaseError as error:
            self._logger.warning(f'{error}: the background is taken anew')
            return
        if kept is not None:
            self._pipeline.restore_background(
                kept.picture, kept.age_s,
                may_correct=self._is_newer_than_calibration(kept.age_s), unknown=kept.unknown)

    def _is_newer_than_calibration(self, age_s: float) -> bool:
        # A camera that was moved and then calibrated must not be corrected by that movement.
        date = self._calibrated_at
        return date is None or datetime.now().astimezone() - timedelta(seconds=age_s) > date
