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

"""The WebSockets: the state as JSON text, and pictures as they are asked for."""

import re
from typing import Any, Optional

from camera_to_base.dashboard.server.guarded import Guarded, NEEDS_TOKEN, Refused
from camera_to_base.dashboard.server.outbox import Outbox
from camera_to_base.dashboard.server.picture_hub import Picture
import tornado.websocket

PICTURE_KINDS = ('annotated', 'frame', 'mask', 'background', 'board')
_CELL = re.compile(r'/|(/[A-Za-z_]\w*){1,8}', re.ASCII)
_POLICY_VIOLATION = 1008


def checked_cell(name: str) -> str:
    """
    Check the name of a cell.

    :raises Refused: If it is no namespace.
    """
    if not _CELL.fullmatch(name) or len(name) > 200:
        raise Refused(400, f"expected a namespace such as / or /cell_2, got '{name:.80}'")
    return name


class _Socket(Guarded, tornado.websocket.WebSocketHandler):

    _is_refused = False

    def check_origin(self, origin: str) -> bool:
        """Return True: `prepare` has checked it."""
        return True

    def refuse_token(self) -> None:
        """Close the socket once it is open, so that the page can tell why."""
        self._is_refused = True

    def open(self, *args: str, **kwargs: str) -> None:  # noqa: A003
        """Begin, or close at once."""
        if self._is_refused:
            self.close(_POLICY_VIOLATION, NEEDS_TOKEN[:120])
            return
        self.set_nodelay(True)
        self.begin()

    def begin(self) -> None:
        """Serve the page."""

    async def send(self, message: Any) -> None:
        """Send a message; wait until it is on its way."""
        try:
            await self.write_message(message, binary=isinstance(message, bytes))
        except tornado.websocket.WebSocketClosedError:
            pass  # the page was closed meanwhile


class StateSocket(_Socket):
    """The state of a cell."""

    _cell: Optional[str] = None

    def begin(self) -> None:
        """Show the state from now on."""
        self._outbox = Outbox(self.send)
        self._cell = checked_cell(self.get_query_argument('cell', '/'))
        self.settings['states'].add(self._cell, self)

    def show(self, key: str, text: str) -> None:
        """Send a part of the state."""
        self._outbox.put(key, text)

    def on_message(self, message: Any) -> None:
        """Ignore what a page says: it has nothing to say here."""

    def on_close(self) -> None:
        """End."""
        if self._cell is not None:
            self.settings['states'].remove(self._cell, self)


class PictureSocket(_Socket):
    """Pictures of one kind."""

    wants, last, key = False, 0, None

    def begin(self) -> None:
        """Look at a kind of picture."""
        kind = self.get_query_argument('kind', 'annotated')
        if kind not in PICTURE_KINDS:
            self.close(_POLICY_VIOLATION, f'kind must be one of {", ".join(PICTURE_KINDS)}')
            return
        self._outbox = Outbox(self.send)
        self.key = checked_cell(self.get_query_argument('cell', '/')), kind
        self.settings['pictures'].add(self.key, self)

    def on_message(self, message: Any) -> None:
        """Send the next picture if the page asks for it."""
        if message == 'next' and self.key is not None:
            self.settings['pictures'].want(self.key, self)

    def show(self, picture: Picture) -> None:
        """Send a picture."""
        self._outbox.put('picture', picture.content)

    def on_close(self) -> None:
        """End."""
        if self.key is not None:
            self.settings['pictures'].remove(self.key, self)
