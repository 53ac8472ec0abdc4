# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The WebSockets: the newest state as JSON text, and pictures as they are asked for."""

import json
import math
import re
from typing import (
    Any, Awaitable, Callable, Dict, Hashable, NamedTuple, Optional, Protocol, Set, Tuple)

from camera_to_base.dashboard.server.guarded import Guarded, NEEDS_TOKEN, Refused
import tornado.ioloop
import tornado.websocket

# A page that is loaded again finds the cell still watched, with its charts.
_LINGER_S = 5.0
# Each costs 1.6 MB and 15 subscriptions, also one that somebody has invented.
_MOST_CELLS = 16

Key = Tuple[str, str]

PICTURE_KINDS = ('annotated', 'frame', 'mask', 'background', 'board')
_CELL = re.compile(r'/|(/[A-Za-z_]\w*){1,8}', re.ASCII)
_POLICY_VIOLATION = 1008


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


class Picture(NamedTuple):
    """
    A picture file in memory.

    :param number: Counts the pictures of a kind.
    """

    number: int
    content: bytes


class Watcher(Protocol):
    """
    A page that looks at a kind of picture.

    `wants` is whether it waits for a picture, `last` the number of the last one that it got.
    """

    wants: bool
    last: int

    def show(self, picture: Picture) -> None:
        """Send a picture."""


class PictureHub:
    """
    Passes each picture on to the pages that wait for one; no page has more than one on its way.

    :param look_at: Called with a cell and a kind when the first page looks.
    :param look_away: Called likewise when the last one has gone.
    """

    def __init__(
        self, look_at: Callable[[str, str], None], look_away: Callable[[str, str], None]
    ) -> None:
        self._look_at, self._look_away = look_at, look_away
        self._newest: Dict[Key, Picture] = {}
        self._watchers: Dict[Key, Set[Watcher]] = {}

    def add(self, key: Key, watcher: Watcher) -> None:
        """Let a page look at a kind of picture."""
        if key not in self._watchers:
            self._watchers[key] = set()
            self._look_at(*key)
        self._watchers[key].add(watcher)

    def remove(self, key: Key, watcher: Watcher) -> None:
        """End that."""
        watchers = self._watchers.get(key, set())
        watchers.discard(watcher)
        if not watchers and self._watchers.pop(key, None) is not None:
            self._newest.pop(key, None)
            self._look_away(*key)

    def want(self, key: Key, watcher: Watcher) -> None:
        """Send the page the newest picture that it does not have, now or when it comes."""
        watcher.wants = True
        self._serve(key, watcher)

    def put(self, key: Key, content: bytes) -> None:
        """Keep a new picture, and send it to those who wait."""
        if key in self._watchers:
            before = self._newest.get(key)
            self._newest[key] = Picture(before.number + 1 if before else 1, content)
            for watcher in self._watchers[key]:
                self._serve(key, watcher)

    def _serve(self, key: Key, watcher: Watcher) -> None:
        newest = self._newest.get(key)
        if watcher.wants and newest is not None and newest.number != watcher.last:
            watcher.wants, watcher.last = False, newest.number
            watcher.show(newest)


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
        try:
            cell = checked_cell(self.get_query_argument('cell', '/'))
        except Refused as error:
            self.close(_POLICY_VIOLATION, error.data['error'][:120])
            return
        self.key = cell, kind
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
