# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""An RTSP camera: RTP/JPEG (RFC 2435) in the RTSP connection itself (interleaved TCP)."""

import random
import struct
import threading
import time

import child_camera
from stream_server import StreamServer

_PACKET_BYTES = 1400
_CLOCK_HZ = 90000
_SESSION = '12345678'


class RtspServer(StreamServer):
    """Serves rtsp://127.0.0.1:PORT/stream, see :class:`StreamServer`."""

    @property
    def url(self):
        """Where OpenCV opens it."""
        return f'rtsp://127.0.0.1:{self.port}/stream'

    def _serve(self, client):
        playing = False
        while not playing:
            request = _read_request(client)
            if not request:
                return
            self.wait_while_frozen()
            method = request.split(' ', 1)[0]
            client.sendall(self._answer(method, request).encode())
            playing = method == 'PLAY'
        self._play(client)

    def _answer(self, method, request):
        number = next(line.split(':')[1].strip() for line in request.splitlines()
                      if line.lower().startswith('cseq'))
        head = f'RTSP/1.0 200 OK\r\nCSeq: {number}\r\nSession: {_SESSION}\r\n'
        if method == 'OPTIONS':
            return head + 'Public: OPTIONS, DESCRIBE, SETUP, PLAY, TEARDOWN\r\n\r\n'
        if method == 'SETUP':
            return head + 'Transport: RTP/AVP/TCP;unicast;interleaved=0-1\r\n\r\n'
        if method == 'DESCRIBE':
            sdp = ('v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=camera\r\nc=IN IP4 0.0.0.0\r\nt=0 0\r\n'
                   f'm=video 0 RTP/AVP 26\r\na=control:{self.url}/video\r\n')
            return (f'{head}Content-Base: {self.url}/\r\nContent-Type: application/sdp\r\n'
                    f'Content-Length: {len(sdp)}\r\n\r\n{sdp}')
        return head + '\r\n'

    def _play(self, client):
        sequence, start = random.randrange(1000), random.randrange(1 << 20)
        for number, _ in enumerate(self.ticks()):
            timestamp = (start + int(number * _CLOCK_HZ / self.rate)) & 0xffffffff
            packets = list(_packets(self.next_jpeg(), sequence, timestamp))
            sequence += len(packets)
            client.sendall(b''.join(
                b'$\0' + struct.pack('>H', len(packet)) + packet for packet in packets))


class KeepingRtspServer(RtspServer):
    """
    An RTSP camera with a queue: what it takes while it is frozen it sends later, at some rate.

    `late_rate` is that of the frames it has kept, per second.
    """

    late_rate = 25.0

    def _play(self, client):
        queue, begin = [], time.monotonic()
        threading.Thread(target=self._take, args=(queue, begin), daemon=True).start()
        sequence = 0
        while self._alive:
            self.wait_while_frozen()
            if not queue:
                time.sleep(0.002)
                continue
            is_late = len(queue) > 1
            at, jpeg = queue.pop(0)
            packets = list(_packets(jpeg, sequence, int(at * _CLOCK_HZ)))
            sequence += len(packets)
            client.sendall(b''.join(
                b'$\0' + struct.pack('>H', len(packet)) + packet for packet in packets))
            time.sleep(1 / self.late_rate if is_late else 0)

    def _take(self, queue, begin):
        while self._alive:
            time.sleep(1 / self.rate)
            queue.append((time.monotonic() - begin, self.next_jpeg()))


def _read_request(client):
    text = b''
    while b'\r\n\r\n' not in text:
        received = client.recv(4096)
        if not received:
            return ''
        text += received
    return text.decode()


def _packets(jpeg, sequence, timestamp):
    """Cut a JPEG into RTP packets; one that has no header any more gives an empty picture."""
    size, tables, scan = _parse(jpeg)
    pieces = [scan[at:at + _PACKET_BYTES] for at in range(0, len(scan), _PACKET_BYTES)] or [b'']
    offset = 0
    for number, piece in enumerate(pieces):
        last = number == len(pieces) - 1
        # Q 255: the quantization tables come with the picture. Type 1: 4:2:0.
        header = struct.pack('>BBHII', 0x80, 26 | (0x80 if last else 0),
                             (sequence + number) & 0xffff, timestamp, 0x12345678)
        header += struct.pack('>I', offset) + bytes([1, 255, size[0] // 8, size[1] // 8])
        if number == 0:
            header += struct.pack('>BBH', 0, 0, len(tables)) + tables
        yield header + piece
        offset += len(piece)


def _parse(jpeg):
    size, tables, at = (0, 0), b'', 2
    while at + 4 <= len(jpeg) and jpeg[at] == 0xff:
        marker, length = jpeg[at + 1], struct.unpack('>H', jpeg[at + 2:at + 4])[0]
        segment = jpeg[at + 4:at + 2 + length]
        if marker == 0xdb:
            while segment:
                tables, segment = tables + segment[1:65], segment[65:]
        elif marker == 0xc0:
            size = struct.unpack('>HH', segment[1:5])[::-1]
        at += 2 + length
        if marker == 0xda:
            end = jpeg[-2:] == b'\xff\xd9'
            return size, tables, jpeg[at:-2] if end else jpeg[at:]
    return size, tables or bytes(128), b''


if __name__ == '__main__':
    child_camera.main(RtspServer)
