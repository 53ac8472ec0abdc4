# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under

"""One moment of a cell: a frame, its mask and its positions, which belong together."""

import time
from typing import Any, Callable, Dict, List, Optional, Tuple

from camera_to_base.dashboard.live.cells import full_name
from camera_to_base.dashboard.live.feeds import picture_qos, TOPICS
from camera_to_base.errors import FrameSourceError
from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import CompressedImage

_KINDS = ('frame', 'mask')
# A mask or positions that have not come by then do not come: nothing is published.
_LONGEST_S = 4.0
_LONGEST_FOR_BASE_S = 1.0

Stamp = Tuple[int, int]
PositionsAt = Callable[[Stamp], Optional[Dict[str, Any]]]


class Snapshot:
    """
    Waits until the pictures and the positions of one frame have come.

    `answer` is the future of the pictures by file name and the positions as JSON.

    :param node: The node that listens.
    :param namespace: The cell's.
    :param positions_at: Returns the positions of the frame with a stamp; None while they are not
        there.
    """

    def __init__(self, node: Node, namespace: str, positions_at: PositionsAt) -> None:
        self._node, self._positions_at = node, positions_at
        self._began_at = time.monotonic()
        self._pictures: Dict[Stamp, Dict[str, CompressedImage]] = {}
        self.answer = Future()
        self._subscriptions = [
            node.create_subscription(
                CompressedImage, full_name(namespace, TOPICS[kind]),
                lambda message, kind=kind: self._see(kind, message), picture_qos(kind))
            for kind in _KINDS]

    def check(self) -> bool:
        """Answer if everything is there, or nothing more is waited for; return whether it has."""
        waited = time.monotonic() - self._began_at
        for stamp, pictures in sorted(self._pictures.items()):
            positions = self._positions_at(stamp) if len(pictures) == len(_KINDS) else None
            # Base positions follow; of what is beyond the reach, none come.
            if positions and (waited > _LONGEST_FOR_BASE_S or all(
                    one['base'] for one in positions['objects'])):
                return self._end(stamp, positions)
        if waited < _LONGEST_S:
            return False
        if not self._pictures:
            return self._fail()
        return self._end(max(self._pictures), {'objects': None})

    def close(self) -> None:
        """Stop listening."""
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)
        self._subscriptions: List[Any] = []

    def _see(self, kind: str, message: CompressedImage) -> None:
        stamp = message.header.stamp.sec, message.header.stamp.nanosec
        self._pictures.setdefault(stamp, {})[kind] = message
        for old in sorted(self._pictures)[:-20]:
            del self._pictures[old]

    def _end(self, stamp: Stamp, positions: Dict[str, Any]) -> bool:
        self.close()
        files = {f'{kind}.{"png" if "png" in one.format else "jpg"}': bytes(one.data)
                 for kind, one in self._pictures[stamp].items()}
        self.answer.set_result((files, {'stamp_s': stamp[0] + stamp[1] / 1e9, **positions}))
        return True

    def _fail(self) -> bool:
        self.close()
        self.answer.set_exception(FrameSourceError(
            'no pictures come from the camera node: is it running, and the camera plugged in?'))
        return True
