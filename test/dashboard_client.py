# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""A client of a dashboard's server: HTTP and WebSockets, as a page uses them."""

import asyncio
import json
import threading

from tornado.httpclient import AsyncHTTPClient, HTTPRequest
from tornado.websocket import websocket_connect


class DashboardClient:
    """
    Talks to a dashboard from a thread of its own, while the test spins ROS.

    :param ros: The test's ROS context.
    :param url: The dashboard's address, perhaps with a token.
    """

    def __init__(self, ros, url):
        self._ros = ros
        self.origin, _, token = url.partition('/?token=')
        self.origin = self.origin.rstrip('/')
        self.headers = {'Origin': self.origin, **({'X-Token': token} if token else {})}
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self.parts = {}
        self.messages = []
        self.pictures = []

    def run(self, coroutine, timeout=20.0):
        """Run a coroutine in the client's thread; return its result."""
        future = asyncio.run_coroutine_threadsafe(coroutine, self._loop)
        self._ros.spin_until(future.done, timeout)
        return future.result()

    def fetch(self, path, body=None, **headers):
        """Return the status, the headers and the body of an answer; JSON is read."""
        given = {name.replace('_', '-'): value for name, value in headers.items()}
        merged = {name: value for name, value in {**self.headers, **given}.items()
                  if value is not None}
        request = HTTPRequest(
            self.origin + path, method='GET' if body is None else 'POST', headers=merged,
            body=body if body is None or isinstance(body, bytes) else json.dumps(body),
            follow_redirects=False)

        async def fetch():
            return await AsyncHTTPClient().fetch(request, raise_error=False)

        answer = self.run(fetch())
        is_json = answer.headers.get('Content-Type', '').startswith('application/json')
        return answer.code, answer.headers, json.loads(answer.body) if is_json else answer.body

    def post(self, path, body, **headers):
        """Return the status and the JSON of an action's answer."""
        status, _, data = self.fetch(path, body, **headers)
        return status, data

    def socket(self, path, **headers):
        """Open a WebSocket."""
        merged = {name: value for name, value in {**self.headers, **headers}.items()
                  if value is not None}

        async def connect():
            return await websocket_connect(
                HTTPRequest(self.origin.replace('http', 'ws') + path, headers=merged))

        return self.run(connect())

    def send(self, socket, text):
        """Send a text."""
        async def send():
            await socket.write_message(text)

        self.run(send())

    def read(self, socket):
        """Return the next message; None once the socket is closed."""
        async def read():
            return await socket.read_message()

        return self.run(read())

    def look(self, cell='/'):
        """Open the state of a cell; `parts` holds the newest of each part from now on."""
        socket = self.socket(f'/ws/state?cell={cell}')

        async def read():
            while (text := await socket.read_message()) is not None:
                message = json.loads(text)
                self.parts[message['part']] = message['data']
                self.messages.append(message)

        asyncio.run_coroutine_threadsafe(read(), self._loop)
        return socket

    def watch_pictures(self, kind, cell='/'):
        """Open pictures of a kind, and ask for each next one; `pictures` grows."""
        socket = self.socket(f'/ws/picture?cell={cell}&kind={kind}')

        async def read():
            await socket.write_message('next')
            while (picture := await socket.read_message()) is not None:
                self.pictures.append(picture)
                await socket.write_message('next')

        asyncio.run_coroutine_threadsafe(read(), self._loop)
        return socket

    def close_socket(self, socket):
        """Close a WebSocket."""
        self._loop.call_soon_threadsafe(socket.close)

    def close(self):
        """End the thread."""
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(5.0)
