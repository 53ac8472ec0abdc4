# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The WebSockets: the newest state as JSON text, and pictures as they are asked for."""

import asyncio
import json
import math
import re
from typing import Any, Awaitable, Callable, Dict, Hashable, Optional, Protocol, Set

from camera_to_base.dashboard.server.guarded import Guarded, NEEDS_TOKEN, Refused
from camera_to_base.dashboard.server.pictures import Line, Picture
import tornado.ioloop
import tornado.websocket

# A page that is loaded again finds the cell still watched, with its charts.
_LINGER_S = 5.0
# Each costs 1.6 MB and 15 subscriptions, also one that somebody has invented.
_MOST_CELLS = 16

PICTURE_KINDS = ('annotated', 'frame', 'mask', 'background', 'board')
_CELL = re.compile(r'/|(/[A-Za-z_]\w*){1,8}', re.ASCII)
_POLICY_VIOLATION = 1008
# Otherwise a slow network fills its buffers with what is old when it comes.
_MOST_ON_THEIR_WAY = 6


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


class Viewer(Protocol):
    """A page that looks at a cell."""

    def show(self, key: str, text: str) -> None:
        """Send a text; a newer one with the same key replaces it."""


class StateHub:
    """
    Keeps parts of the state, and passes them on.

    :param look_at: Called with a cell when the first page looks at it.
    :param look_away: Called with a cell when nobody has looked for some seconds.
    """

    def __init__(
        self, look_at: Callable[[str], None], look_away: Callable[[str], None]
    ) -> None:
        self._look_at, self._look_away = look_at, look_away
        self._parts: Dict[str, Dict[str, str]] = {}
        self._viewers: Dict[str, Set[Viewer]] = {}

    def add(self, cell: str, viewer: Viewer) -> None:
        """
        Show the state of a cell to a page from now on.

        :raises Refused: If too many cells are looked at.
        """
        if cell not in self._viewers:
            if len(self._viewers) >= _MOST_CELLS:
                raise Refused(503, f'{_MOST_CELLS} cells are looked at already: close a page')
            self._viewers[cell] = set()
            self._look_at(cell)
        self._viewers[cell].add(viewer)
        for part, text in self._parts.get(cell, {}).items():
            viewer.show(part, text)

    def remove(self, cell: str, viewer: Viewer) -> None:
        """End that."""
        self._viewers.get(cell, set()).discard(viewer)
        tornado.ioloop.IOLoop.current().call_later(_LINGER_S, self._end_if_unwatched, cell)

    def put(self, cell: str, part: str, text: str) -> None:
        """Keep a part's new text, and show it."""
        if cell in self._viewers:
            self._parts.setdefault(cell, {})[part] = text
            for viewer in self._viewers[cell]:
                viewer.show(part, text)

    def _end_if_unwatched(self, cell: str) -> None:
        if cell in self._viewers and not self._viewers[cell]:
            del self._viewers[cell]
            self._parts.pop(cell, None)
            self._look_away(cell)


def part_text(part: str, data: Any) -> str:
    """Make the text of a message with a part of the state."""
    message = {'part': part, 'data': data}
    try:
        return json.dumps(message, separators=(',', ':'), allow_nan=False)
    except ValueError:
        return json.dumps(_finite(message), separators=(',', ':'))


def _finite(data: Any) -> Any:
    # A number that is not finite has no JSON.
    if isinstance(data, dict):
        return {name: _finite(value) for name, value in data.items()}
    if isinstance(data, list):
        return list(map(_finite, data))
    return None if isinstance(data, float) and not math.isfinite(data) else data


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
    """The state of a cell; a page that confirms what it got has few messages on their way."""

    _cell: Optional[str] = None
    _on_its_way = 0

    def get_compression_options(self) -> Dict[str, Any]:
        """Compress: the newest state is much like the one before."""
        return {'compression_level': 3, 'mem_level': 5}

    def begin(self) -> None:
        """Show the state from now on."""
        self._outbox = Outbox(self._send_in_turn)
        self._confirms = self.get_query_argument('confirms', '') == 'yes'
        self._has_room = asyncio.Event()
        try:
            cell = checked_cell(self.get_query_argument('cell', '/'))
            self.settings['states'].add(cell, self)
        except Refused as error:
            self.close(_POLICY_VIOLATION, error.data['error'][:120])
            return
        self._cell = cell

    def show(self, key: str, text: str) -> None:
        """Send a part of the state."""
        self._outbox.put(key, text)

    async def _send_in_turn(self, message: Any) -> None:
        while self._confirms and self._on_its_way >= _MOST_ON_THEIR_WAY:
            self._has_room.clear()
            await self._has_room.wait()
        self._on_its_way += 1
        await self.send(message)

    def on_message(self, message: Any) -> None:
        """Take note that the page got a message."""
        self._on_its_way = max(0, self._on_its_way - 1)
        self._has_room.set()

    def on_close(self) -> None:
        """End."""
        if self._cell is not None:
            self._confirms = False
            self._has_room.set()
            self.settings['states'].remove(self._cell, self)


class PictureSocket(_Socket):
    """Pictures of one kind."""

    wants, last, key = False, 0, None
    _line: Optional[Line] = None

    def begin(self) -> None:
        """Look at a kind of picture."""
        kind = self.get_query_argument('kind', 'annotated')
        if kind not in PICTURE_KINDS:
            self.close(_POLICY_VIOLATION, f'kind must be one of {", ".join(PICTURE_KINDS)}')
            return
        self._outbox = Outbox(self.send)
        try:
            cell = checked_cell(self.get_query_argument('cell', '/'))
        except Refused as error:
            self.close(_POLICY_VIOLATION, error.data['error'][:120])
            return
        self.key = cell, kind
        if self.get_query_argument('adapts', '') == 'yes':
            self._line = Line()
        self.settings['pictures'].add(self.key, self)

    def on_message(self, message: Any) -> None:
        """Send the next picture if the page asks for it."""
        if message == 'next' and self.key is not None:
            if self._line is not None:
                self._line.arrived()
            self.settings['pictures'].want(self.key, self)

    def show(self, picture: Picture) -> None:
        """Send a picture; a page that asks for it is told its size and age first."""
        content = picture.content
        if self._line is not None:
            content, told = self._line.sent(picture)
            self._outbox.put('about', json.dumps(told))
        self._outbox.put('picture', content)

    def on_close(self) -> None:
        """End."""
        if self.key is not None:
            self.settings['pictures'].remove(self.key, self)
