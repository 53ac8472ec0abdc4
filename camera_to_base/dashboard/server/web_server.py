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

"""The web server in a thread of its own."""

import asyncio
import errno
import logging
import socket
import threading
from typing import Any, Callable, List, Optional

from camera_to_base.dashboard.server.access import Access
from camera_to_base.dashboard.server.actions import ACTIONS, Unknown
from camera_to_base.dashboard.server.pages import Page, WEB, WebFile
from camera_to_base.dashboard.server.picture_hub import PictureHub
from camera_to_base.dashboard.server.session_actions import SESSION_ACTIONS
from camera_to_base.dashboard.server.sockets import PictureSocket, StateSocket
from camera_to_base.dashboard.server.state_hub import StateHub
from camera_to_base.dashboard.specs import DashboardSettings, is_loopback
from camera_to_base.errors import InvalidValueError
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application

_LARGEST_BODY = 1_000_000
_LARGEST_MESSAGE = 10_000
_IDLE_S, _PING_S = 60.0, 20.0
_LONGEST_END_S = 0.4


class WebServer:
    """
    Serves the page until it is closed.

    :param settings: Where it listens.
    :param backend: Carries out what pages ask for, see `actions`; its `look_at` and so on are
        called when pages come and go.
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
            websocket_max_message_size=_LARGEST_MESSAGE, websocket_ping_interval=_PING_S,
            websocket_ping_timeout=_PING_S)


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
