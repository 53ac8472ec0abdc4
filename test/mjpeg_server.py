# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""An MJPEG-over-HTTP camera: multipart/x-mixed-replace, as network cameras send it."""

import child_camera
from stream_server import StreamServer

_HEAD = (b'HTTP/1.0 200 OK\r\nServer: camera\r\nCache-Control: no-cache\r\n'
         b'Content-Type: multipart/x-mixed-replace; boundary=frame\r\n\r\n')


class MjpegServer(StreamServer):
    """
    Serves http://127.0.0.1:PORT/video.mjpg, see :class:`StreamServer`.

    `garbage` is sent between pictures, after one part and before the next boundary.
    """

    garbage = b''

    @property
    def url(self):
        """Where OpenCV opens it."""
        return f'http://127.0.0.1:{self.port}/video.mjpg'

    def _serve(self, client):
        request = b''
        while b'\r\n\r\n' not in request:
            received = client.recv(4096)
            if not received:
                return
            request += received
        self.wait_while_frozen()
        client.sendall(_HEAD)
        for _ in self.ticks():
            jpeg = self.next_jpeg()
            client.sendall(
                b'--frame\r\nContent-Type: image/jpeg\r\nContent-Length: %d\r\n\r\n' % len(jpeg)
                + jpeg + b'\r\n' + self.garbage)


if __name__ == '__main__':
    child_camera.main(MjpegServer)
