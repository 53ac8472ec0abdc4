# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The services of the camera node: a new background, kept in a file, and a correction to keep."""

from datetime import datetime, timedelta
import json
import math
import time
from typing import Any, Callable, Dict, Optional

from camera_to_base.drawing import BackgroundFile
from camera_to_base.errors import CameraToBaseError, InvalidValueError, Level, Reason
from camera_to_base.parameters import changed_record
from camera_to_base.pipeline import CameraPipeline, kept_values
from camera_to_base.ros import real_time_timer
from camera_to_base.settings import CameraSettings
from camera_to_base.shell_commands import with_full_commands
from camera_to_base.sources import RANDOM, SourceKind
from camera_to_base.surface import SURFACE_SPECS, view_thumbnail
from camera_to_base.uncertainty import SURFACE_COVARIANCE
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.qos import qos_profile_services_default, QoSProfile
from rclpy.task import Future
from std_srvs.srv import Trigger

# If the background is not complete after this time, no good frames are coming.
_TIMEOUT_S = 10.0
# A full disk is noticed and emptied by a person: sooner brings nothing.
_RETRY_S = 10.0
# By default a service forgets all but the last 10 calls that come at once.
_MANY_CALLS = QoSProfile(
    depth=100, reliability=qos_profile_services_default.reliability,
    durability=qos_profile_services_default.durability)

_RECORD, _THUMBNAIL = 'calibration.surface', 'calibration.thumbnail'
_HOW = {'view_corrected': 'corrected for a nudge of the camera'}


class BackgroundFileKeeper:
    """
    Reads the background from the parameter's file, and writes each new one there.

    If the file cannot be read, the node logs why and takes a new background. If it cannot be
    written, `doubt` says why until it can.

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
        self._tried_at = -math.inf
        self.doubt: Optional[Reason] = None
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
        """Write the background to the file if it is new; after a failure, try again later."""
        now = time.monotonic()
        if self.doubt is not None and now - self._tried_at < _RETRY_S:
            return
        self._tried_at, before = now, self.doubt
        try:
            seen = self._pipeline.standpoint.background_as_calibrated
            if seen is not None:
                self._file.keep(seen.picture, seen.unknown)
            self.doubt = None
        except CameraToBaseError as error:
            self.doubt = Reason(
                'background_not_kept', Level.WARN,
                f'the background is not kept for the next start: {error}; it is tried again '
                f'every {_RETRY_S:.0f} s')
            if before is None:
                self._logger.error(self.doubt.sentence)

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


class BackgroundService:
    """
    Offers `~/capture_background`.

    Calls that come while a background is taken share the next one: its frames are newer than each
    of these calls.

    :param node: The node that offers it.
    :param pipeline: The pipeline that takes the background.
    :param frame_count: Returns the number of frames that make a background.
    :param source_reason: Returns why the source gives no good frame, or None.
    """

    def __init__(
        self,
        node: Node,
        pipeline: CameraPipeline,
        frame_count: Callable[[], int],
        source_reason: Callable[[], Optional[Reason]],
    ) -> None:
        self._node = node
        self._pipeline = pipeline
        self._frame_count = frame_count
        self._source_reason = source_reason
        self._captured: Optional[Future] = None
        self._running: Optional[Future] = None
        self._next: Optional[Future] = None
        # A separate callback group, so that frames are processed while the service waits for them.
        node.create_service(
            Trigger, '~/capture_background', self._on_call, qos_profile=_MANY_CALLS,
            callback_group=ReentrantCallbackGroup())

    def notice_frame(self) -> None:
        """Respond to a waiting client if the pipeline has its background."""
        if self._captured is not None and self._pipeline.background is not None:
            self._captured.set_result(True)

    async def _on_call(
        self, request: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        if self._next is not None:
            answer = await self._next
        elif self._running is not None:
            self._next = Future()
            await self._running
            answer = await self._taken()
        else:
            answer = await self._taken()
        response.success, response.message = answer.success, answer.message
        return response

    async def _taken(self) -> Trigger.Response:
        """Take a background; all calls that wait for it have the answer."""
        self._running, waiting, self._next = Future(), self._next, None
        answer = await self._answer()
        running, self._running = self._running, None
        running.set_result(True)
        if waiting is not None:
            waiting.set_result(answer)
        return answer

    async def _answer(self) -> Trigger.Response:
        response = Trigger.Response()
        reason = self._source_reason()
        if reason is not None and reason.kind != 'camera_opening':
            response.message = f'no background is taken: {reason.sentence}'
            return response
        wanted_count = self._frame_count()
        self._pipeline.capture_background(wanted_count)
        response.success = await self._capture()
        if response.success:
            height, width = self._pipeline.background.shape[:2]
            response.message = (f'took {width} x {height} px, the median of '
                                f'{self._pipeline.backgrounds.frame_count} frame(s)')
        else:
            before = self._pipeline.backgrounds.keep_before()
            after = ('the next ones become the background' if before is None
                     else 'the background before is used')
            response.message = f'not {wanted_count} good frame(s) in {_TIMEOUT_S:g} s; {after}'
        return response

    async def _capture(self) -> bool:
        self._captured = captured = Future()
        deadline = real_time_timer(
            self._node, _TIMEOUT_S, lambda: captured.set_result(False))
        success = await captured
        self._captured = None
        self._node.destroy_timer(deadline)
        return success


class CorrectionService:
    """
    Offers `~/corrected_surface`: the surface in force as parameters, in the message as JSON.

    The node itself goes on without a correction once these parameters are set. `sentence` says
    what is corrected, `values` holds the parameters by full name, and `before` those of the
    surface as they are now.

    :param node: The node that offers it.
    :param pipeline: The pipeline that corrects.
    :param settings: Returns the node's settings.
    """

    def __init__(
        self, node: Node, pipeline: CameraPipeline, settings: Callable[[], CameraSettings]
    ) -> None:
        self._node, self._pipeline, self._settings = node, pipeline, settings
        node.create_service(Trigger, '~/corrected_surface', self._on_call)

    def _on_call(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        try:
            response.message = json.dumps(self._offer())
            response.success = True
        except CameraToBaseError as error:
            response.message = str(error)
        return response

    def _offer(self) -> Dict[str, Any]:
        in_force = self._pipeline.standpoint.surface
        if in_force.reason is None:
            raise InvalidValueError(
                'the camera stands where it was calibrated: there is no correction to keep')
        if self._pipeline.reason is not None:
            raise InvalidValueError(
                f'nothing is published now, so nothing is kept: {self._pipeline.reason.sentence}')
        names = [SURFACE_COVARIANCE, *(spec.name for spec in SURFACE_SPECS)]
        return {'sentence': in_force.reason.sentence, 'values': self._values(),
                'before': {name: self._parameter(name) for name in names}}

    def _values(self) -> Dict[str, Any]:
        settings, standpoint = self._settings(), self._pipeline.standpoint
        picture = standpoint.background.picture
        how = _HOW.get(standpoint.surface.reason.kind, 'computed anew from markers')
        values = kept_values(
            standpoint.surface, settings.surface, settings.uncertainty, settings.hull,
            picture.shape[1::-1])
        values[_RECORD] = changed_record(
            self._parameter(_RECORD), how, datetime.now().astimezone())
        if self._parameter(_THUMBNAIL):
            values[_THUMBNAIL] = view_thumbnail(picture)
        return values

    def _parameter(self, name: str) -> Any:
        value = self._node.get_parameter(name).value
        return list(value) if hasattr(value, 'tolist') else value
