# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What both stream servers share: a camera on a socket that can be killed, frozen and damaged."""

import socket
import threading
import time

import cv2


class StreamServer:
    """
    A network camera of the tests; a subclass speaks its protocol in `_serve`.

    It takes no more frames than a client fetches, and none for nobody: like a camera's own server
    it has no queue beyond the socket's buffers.

    :param take_frame: Gives the next frame, shape (h, w, 3), uint8, BGR.
    :param rate: Frames per second; can be changed at any time.
    :param port: 0 for any free one; a server that is started again keeps it.
    :param quality: Of the JPEGs, 1..100.
    """

    def __init__(self, take_frame, rate=20.0, port=0, quality=90):
        self._take_frame = take_frame
        self.rate = rate
        self.port = port
        self._quality = quality
        self.damage = None
        self.damaged_share = 1.0
        self.frame_count = 0
        self.damaged_count = 0
        self._lock = threading.Lock()
        self._frozen = threading.Event()
        self._sockets = []
        self._threads = []
        self._owed = 0.0
        self.start()

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.kill()

    @property
    def client_count(self):
        """How many clients are connected."""
        return len(self._sockets) - 1

    def start(self):
        """Listen, on the same port as before."""
        self._alive = True
        self._listener = socket.create_server(('127.0.0.1', self.port), reuse_port=True)
        self.port = self._listener.getsockname()[1]
        self._sockets = [self._listener]
        self._start_thread(self._accept, self._listener)

    def kill(self):
        """End at once, as a camera does whose plug is pulled; `start` brings it back."""
        self._alive = False
        for open_socket in list(self._sockets):
            _close(open_socket)
        for thread in self._threads:
            thread.join(2.0)
        self._threads = []

    def freeze(self):
        """Keep all connections, accept new ones, and send nothing."""
        self._frozen.set()

    def thaw(self):
        """Go on."""
        self._frozen.clear()

    def set_damage(self, damage, share=1.0):
        """
        Damage pictures from now on.

        :param damage: Makes bytes of a JPEG's bytes, see `damage.py`; None for no damage.
        :param share: How many of the pictures, 0..1, evenly spread.
        """
        self.damage, self.damaged_share, self._owed = damage, share, 0.0

    def next_jpeg(self):
        """Wait until the camera has its next picture, and give its bytes, damaged if so set."""
        with self._lock:
            frame = self._take_frame()
            self.frame_count += 1
            damage = self._damage_now()
        _, jpeg = cv2.imencode('.jpg', frame, [cv2.IMWRITE_JPEG_QUALITY, self._quality])
        return damage(jpeg.tobytes()) if damage else jpeg.tobytes()

    def ticks(self):
        """Give a tick for each picture until the server is killed."""
        due = time.monotonic()
        while self._alive:
            self.wait_while_frozen()
            # Late by a client that does not fetch: those pictures are never taken.
            due = max(due + 1 / self.rate, time.monotonic())
            time.sleep(max(0.0, due - time.monotonic()))
            self.wait_while_frozen()
            if self._alive:
                yield

    def wait_while_frozen(self):
        """Return when the server is not frozen."""
        while self._alive and self._frozen.is_set():
            time.sleep(0.01)

    def _damage_now(self):
        if self.damage is None:
            return None
        self._owed += self.damaged_share
        if self._owed < 1 - 1e-9:
            return None
        self._owed -= 1
        self.damaged_count += 1
        return self.damage

    def _accept(self, listener):
        while self._alive:
            try:
                client, _ = listener.accept()
            except OSError:
                return
            self._sockets.append(client)
            self._start_thread(self._serve_one, client)

    def _serve_one(self, client):
        try:
            self._serve(client)
        except OSError:
            pass  # the client has left, or the server was killed
        finally:
            _close(client)
            if client in self._sockets:
                self._sockets.remove(client)

    def _start_thread(self, target, argument):
        thread = threading.Thread(target=target, args=(argument,), daemon=True)
        self._threads.append(thread)
        thread.start()


def _close(open_socket):
    try:
        open_socket.shutdown(socket.SHUT_RDWR)
    except OSError:
        pass
    open_socket.close()
