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

"""The service that takes a new background, and responds when it is complete."""

from typing import Callable, Optional

from camera_to_base.reason import Reason
from camera_to_base.ros import real_time_timer
from camera_to_base.trust import CameraPipeline
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Trigger

# If the background is not complete after this time, no good frames are coming.
_TIMEOUT_S = 10.0


class BackgroundService:
    """
    Offers `~/capture_background`.

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
        # A separate callback group, so that frames are processed while the service waits for them.
        node.create_service(Trigger, '~/capture_background', self._on_call,
                            callback_group=MutuallyExclusiveCallbackGroup())

    def notice_frame(self) -> None:
        """Respond to a waiting client if the pipeline has its background."""
        if self._captured is not None and self._pipeline.background is not None:
            self._captured.set_result(True)

    async def _on_call(
        self, request: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
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
