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

"""What waits for one slow or fast page: the newest of each part."""

from typing import Any, Awaitable, Callable, Dict, Hashable

import tornado.ioloop


class Outbox:
    """
    Sends messages one after the other; a newer one replaces a waiting one of the same key.

    :param send: Sends a message; its result is awaited before the next one is sent.
    """

    def __init__(self, send: Callable[[Any], Awaitable[None]]) -> None:
        self._send = send
        self._waiting: Dict[Hashable, Any] = {}
        self._is_sending = False

    def put(self, key: Hashable, message: Any) -> None:
        """Send a message as soon as those before it are sent."""
        self._waiting[key] = message
        if not self._is_sending:
            self._is_sending = True
            tornado.ioloop.IOLoop.current().add_callback(self._send_all)

    async def _send_all(self) -> None:
        try:
            while self._waiting:
                key = next(iter(self._waiting))
                await self._send(self._waiting.pop(key))
        finally:
            self._is_sending = False
