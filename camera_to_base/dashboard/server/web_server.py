# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The web server in a thread of its own, and what a page can ask of it."""

import asyncio
import errno
import json
import logging
import math
import socket
import threading
from typing import Any, Callable, Dict, List, Optional

from camera_to_base.dashboard.server.guarded import Access, Guarded, Page, Refused, WEB, WebFile
from camera_to_base.dashboard.server.pictures import PictureHub
from camera_to_base.dashboard.server.sockets import (
    checked_cell, PictureSocket, StateHub, StateSocket)
from camera_to_base.dashboard.specs import DashboardSettings, is_loopback
from camera_to_base.errors import InvalidValueError
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application

_TYPES = {'png': 'image/png', 'txt': 'text/plain; charset=utf-8'}

_LARGEST_BODY = 1_000_000
_LARGEST_MESSAGE = 10_000
# Of a ROS parameter; above, a number is sent on as a float.
_LARGEST_INTEGER = 2 ** 62
_IDLE_S, _PING_S = 60.0, 20.0
_LONGEST_END_S = 0.4


class Action(Guarded):
    """A request of a page, answered with JSON."""

    @property
    def cell(self) -> str:
        """The cell that it is about."""
        return checked_cell(self.get_query_argument('cell', '/'))

    @property
    def backend(self) -> Any:
        """What carries it out."""
        return self.settings['backend']

    def body(self) -> Dict[str, Any]:
        """
        Return the request's JSON object.

        :raises Refused: If it is none.
        """
        try:
            body = json.loads(
                self.request.body or b'{}', parse_int=_number, parse_constant=_number)
            # Half a character, a surrogate, cannot be written to a file or a message.
            json.dumps(body, ensure_ascii=False).encode()
        except (ValueError, RecursionError):
            body = None
        if not isinstance(body, dict):
            raise Refused(400, 'expected a JSON object')
        return body

    def answer(self, data: Any) -> None:
        """Answer with JSON."""
        self.set_header('Content-Type', 'application/json')
        self.finish(json.dumps(data))


def _number(text: str) -> Any:
    # No parameter and no count is larger, and no float of Python overflows then.
    value = float(text)
    if not math.isfinite(value):
        raise InvalidValueError(f'expected a finite number, got {text[:40]}')
    return int(text) if abs(value) < _LARGEST_INTEGER else value


class Unknown(Action):
    """An address that does not exist."""

    def prepare(self) -> None:
        """Refuse it, after the checks."""
        super().prepare()
        raise Refused(404, f'there is no {self.request.path:.80}')


class SetParameters(Action):
    """Parameters of a node."""

    async def post(self) -> None:
        """Set them, all or none."""
        body = self.body()
        node, values = body.get('node'), body.get('values')
        if node not in ('camera', 'transform') or not isinstance(values, dict) or not values:
            raise Refused(400, 'expected {"node": "camera" or "transform", "values": {…}}')
        self.answer({'values': await self.backend.set_parameters(self.cell, node, values)})


class TakeBackground(Action):
    """The background."""

    async def post(self) -> None:
        """Take it anew."""
        self.answer({'sentence': await self.backend.capture_background(self.cell)})


ACTIONS = [('/api/parameters', SetParameters), ('/api/background', TakeBackground)]


class SessionStep(Action):
    """A step of a session."""

    async def post(self, part: str, name: str) -> None:
        """Carry it out, and answer with the session's new state."""
        self.answer(await self.backend.act(self.cell, part, name, self.body()))


class WholePart(SessionStep):
    """The one step of a part: to save the file, or to set the areas."""

    async def post(self, part: str) -> None:
        """Carry it out, and answer with the part's new state."""
        await super().post(part, {'save': 'save', 'areas': 'set'}[part])


class KeepCorrection(Action):
    """The camera node's correction of a nudge."""

    async def post(self) -> None:
        """Keep it, and answer with the new state of the part `save`."""
        self.answer(await self.backend.keep_correction(self.cell, self.body()))


class ReportPart(Action):
    """A picture or the text of the board's report."""

    async def get(self, name: str) -> None:
        """Answer with it."""
        content = await self.backend.ask_sessions(self.cell, lambda one: one.report(name))
        self.set_header('Content-Type', _TYPES[name.rpartition('.')[2]])
        self.finish(content)


class Sheet(Action):
    """The board to print, or the markers; drawing takes a second: one at a time."""

    async def post(self) -> None:
        """Answer with a PDF."""
        options = self.body()
        if self.settings['drawing'].locked():
            raise Refused(503, 'another sheet is being drawn: try again in a second')
        async with self.settings['drawing']:
            content = await self.backend.ask_sessions(self.cell, lambda one: one.sheet(options))
        self.set_header('Content-Type', 'application/pdf')
        self.set_header('Content-Disposition', 'inline; filename="sheet.pdf"')
        self.finish(content)


class TakeSnapshot(Action):
    """One moment of a cell; one at a time."""

    async def post(self) -> None:
        """Answer with a ZIP."""
        cell = self.cell
        if self.settings['snapshot'].locked():
            raise Refused(503, 'another snapshot is being taken: try again in a second')
        async with self.settings['snapshot']:
            content = await self.backend.snapshot(cell)
        self.set_header('Content-Type', 'application/zip')
        self.set_header('Content-Disposition', 'attachment; filename="snapshot.zip"')
        self.finish(content)


class SavedFile(Action):
    """The parameter file as it would be saved."""

    async def get(self) -> None:
        """Answer with its text."""
        text = await self.backend.ask_sessions(self.cell, lambda one: one.file_text())
        self.set_header('Content-Type', 'application/yaml; charset=utf-8')
        self.set_header('Content-Disposition', 'attachment; filename="cell.yaml"')
        self.finish(text)


SESSION_ACTIONS = [
    ('/api/(board|markers|robot|prove|record|save|objects|simulated)/([a-z_0-9]+)', SessionStep),
    ('/api/(save|areas)', WholePart), ('/api/correction', KeepCorrection),
    ('/api/report/([a-z]+[.](?:png|txt))', ReportPart), ('/api/sheet', Sheet),
    ('/api/snapshot', TakeSnapshot),
    ('/api/file', SavedFile)]


class WebServer:
    """
    Serves the page until it is closed.

    :param settings: Where it listens.
    :param backend: Carries out what pages ask for, see the actions above; its `look_at` and so on
        are called when pages come and go.
    :raises InvalidValueError: If the address cannot be used.
    """

    def __init__(self, settings: DashboardSettings, backend: Any) -> None:
        self._settings = settings
        self._sockets = _listen(settings.host, settings.port)
        self.port = self._sockets[0].getsockname()[1]
        self.states = StateHub(backend.look_at, backend.look_away)
        self.pictures = PictureHub(backend.look_at_picture, backend.look_away_picture)
        self._backend = backend
        self._loop: Optional[asyncio.AbstractEventLoop] = None
        self._is_started = threading.Event()
        self._thread = threading.Thread(
            target=lambda: asyncio.run(self._serve()), name='web server', daemon=True)

    @property
    def address(self) -> str:
        """The address to open, with the token."""
        host = self._settings.host
        shown = 'localhost' if is_loopback(host) else _reachable(host)
        token = f'?token={self._settings.token}' if self._settings.token else ''
        return f'http://{shown}:{self.port}/{token}'

    def start(self) -> None:
        """Serve from now on."""
        for name in ('tornado.access', 'tornado.general'):
            # What clients do wrong is told to them.
            logging.getLogger(name).setLevel(logging.CRITICAL)
        self._thread.start()
        self._is_started.wait()

    def call(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Run a function in the server's thread."""
        try:
            self._loop.call_soon_threadsafe(function, *arguments)
        except RuntimeError:
            pass  # the server has ended

    def close(self) -> None:
        """End all connections, and the thread."""
        if self._thread.is_alive():
            self.call(self._ended.set)
            self._thread.join(2 * _LONGEST_END_S)
        for one in self._sockets:
            one.close()

    async def _serve(self) -> None:
        self._loop, self._ended = asyncio.get_running_loop(), asyncio.Event()
        server = HTTPServer(
            self._application(), max_body_size=_LARGEST_BODY, max_buffer_size=2 * _LARGEST_BODY,
            idle_connection_timeout=_IDLE_S, body_timeout=_IDLE_S)
        server.add_sockets(self._sockets)
        self._is_started.set()
        await self._ended.wait()
        server.stop()
        try:
            await asyncio.wait_for(server.close_all_connections(), _LONGEST_END_S)
        except asyncio.TimeoutError:
            pass

    def _application(self) -> Application:
        files: List[Any] = [('/web/(.*)', WebFile, {'path': str(WEB)})]
        return Application(
            [('/', Page), *files, ('/ws/state', StateSocket), ('/ws/picture', PictureSocket),
             *ACTIONS, *SESSION_ACTIONS],
            default_handler_class=Unknown,
            access=Access(self._settings.host, self._settings.token), port=self.port,
            states=self.states, pictures=self.pictures, backend=self._backend,
            drawing=asyncio.Lock(), snapshot=asyncio.Lock(),
            compress_response=True, websocket_max_message_size=_LARGEST_MESSAGE,
            websocket_ping_interval=_PING_S, websocket_ping_timeout=_PING_S)


def _listen(host: str, port: int) -> List[Any]:
    try:
        return bind_sockets(port, host)
    except OSError as error:
        raise InvalidValueError(
            f'cannot listen on {host}, port {port}: {error.strerror}; {_cure(error)}') from error


def _cure(error: OSError) -> str:
    if isinstance(error, socket.gaierror) or error.errno == errno.EADDRNOTAVAIL:
        return ('host must be 127.0.0.1 for this machine alone, 0.0.0.0 for all networks, or an '
                'address of this machine')
    return 'choose another address with -p port:=8081, or end the program that uses this one'


def _reachable(host: str) -> str:
    return socket.gethostname() if host in ('0.0.0.0', '::', '') else host
