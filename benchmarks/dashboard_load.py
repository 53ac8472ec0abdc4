# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Measures what pages that look at the dashboard cost the nodes: rate and latency of positions.

    scripts/benchmark dashboard_load [--quick] [--json FILE]

Times without a page, with one and with 50 pages take turns. Each page has the state and the
annotated picture open, and asks for each next picture at once; one of 50 reads a byte a second.
The latency is from a frame's stamp to the arrival of its position in this process. The CPU time is
that of all threads, in per cent of one core, and for each position; the latter says what a page
costs on a busy machine, too.
"""

import argparse
import asyncio
import os
import signal
import socket
import subprocess
import sys
import time
from typing import Any, Dict, List, Tuple

from geometry_msgs.msg import PointStamped
from nodes import cpu_seconds, executable
import numpy as np
import rclpy
from rclpy.signals import SignalHandlerOptions
from rows import print_rows
from tornado.httpclient import HTTPRequest
from tornado.websocket import websocket_connect

PAGES, RATE_HZ = (0, 1, 50), 20
TOPICS = 'pos_in_cam_frame/point', 'pos_in_robot_base_frame/point'
_SETTLING_S = 3.0


async def look(port: int, counts: List[int]) -> None:
    """Be a page: count the pictures that come."""
    def request(path: str) -> HTTPRequest:
        return HTTPRequest(f'ws://localhost:{port}{path}',
                           headers={'Origin': f'http://localhost:{port}'})

    async def read_state() -> None:
        state = await websocket_connect(request('/ws/state?cell=/'))
        while await state.read_message() is not None:
            pass

    async def read_pictures() -> None:
        pictures = await websocket_connect(request('/ws/picture?cell=/&kind=annotated'))
        await pictures.write_message('next')
        while await pictures.read_message() is not None:
            counts[0] += 1
            await pictures.write_message('next')

    await asyncio.gather(read_state(), read_pictures())


def look_slowly(port: int) -> socket.socket:
    """Be a page that asks for pictures, and reads nothing by itself."""
    one = socket.create_connection(('localhost', port))
    one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    one.sendall((
        f'GET /ws/picture?cell=/&kind=annotated HTTP/1.1\r\nHost: localhost:{port}\r\n'
        f'Origin: http://localhost:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n'
        'Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n\r\n'
    ).encode())
    # The text 'next', in a frame with the mask 0.
    one.sendall((b'\x81\x84\x00\x00\x00\x00next') * 1000)
    return one


async def be_pages(port: int, pages: int) -> None:
    """Be all pages until a signal ends the process; print the number of pictures."""
    os.nice(10)  # pages are on other machines
    counts, slow = [0], look_slowly(port) if pages > 1 else None
    tasks = [asyncio.ensure_future(look(port, counts))
             for _ in range(pages - (slow is not None))]
    told_to_end = asyncio.Event()
    asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, told_to_end.set)
    while not told_to_end.is_set():
        await asyncio.sleep(1.0)
        if slow is not None:
            slow.recv(1)
    print(counts[0], flush=True)
    for task in tasks:
        task.cancel()


class Phases:
    """
    Collects latencies, and the nodes' CPU time, with pages and without.

    :param processes: By name.
    """

    def __init__(self, node: Any, processes: Dict[str, subprocess.Popen]) -> None:
        self._node, self._processes = node, processes
        self._ages: Dict[str, List[float]] = {topic: [] for topic in TOPICS}
        self.latencies_s: Dict[Tuple[str, int], List[float]] = {}
        self.cpu_s: Dict[Tuple[str, int], float] = {}
        self.seconds: Dict[int, float] = {}
        for topic in TOPICS:
            node.create_subscription(PointStamped, topic, lambda message, topic=topic: (
                self._ages[topic].append(_age_s(node, message.header.stamp))), 10)

    def wait(self, seconds: float) -> None:
        """Spin for a time."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            rclpy.spin_once(self._node, timeout_sec=0.1)

    def measure(self, pages: int, seconds: float) -> None:
        """Add a time with so many pages."""
        self.wait(_SETTLING_S)
        for ages in self._ages.values():
            ages.clear()
        before = {name: cpu_seconds(one.pid) for name, one in self._processes.items()}
        begin = time.monotonic()
        self.wait(seconds)
        self.seconds[pages] = self.seconds.get(pages, 0.0) + time.monotonic() - begin
        for name, one in self._processes.items():
            used = cpu_seconds(one.pid) - before[name]
            self.cpu_s[name, pages] = self.cpu_s.get((name, pages), 0.0) + used
        for topic, ages in self._ages.items():
            self.latencies_s.setdefault((topic, pages), []).extend(ages)

    def rows(self) -> List[dict]:
        """Return the rows of the table."""
        return [_row(topic, pages, latencies_s, self.seconds[pages])
                for (topic, pages), latencies_s in self.latencies_s.items()] + [
            {'what': name, 'pages': pages,
             'cpu_percent': round(100 * used / self.seconds[pages], 1),
             'cpu_ms_per_position': round(
                 1e3 * used / max(1, len(self.latencies_s[TOPICS[0], pages])), 2)}
            for (name, pages), used in self.cpu_s.items()]


def _row(topic: str, pages: int, latencies_s: List[float], seconds: float) -> dict:
    p50, p99 = np.percentile(latencies_s, [50, 99]) * 1e3
    return {'what': topic, 'pages': pages, 'rate_hz': round(len(latencies_s) / seconds, 2),
            'p50_ms': round(p50, 1), 'p99_ms': round(p99, 1),
            'largest_ms': round(1e3 * max(latencies_s), 1)}


def _age_s(node: Any, stamp: Any) -> float:
    return node.get_clock().now().nanoseconds / 1e9 - stamp.sec - stamp.nanosec / 1e9


def start(port: int) -> Dict[str, subprocess.Popen]:
    """Start the nodes and the dashboard."""
    arguments = {
        'camera_publisher': ['source:=simulated', f'simulated.frame_rate:={RATE_HZ}.0'],
        'robot_base_publisher': [], 'dashboard': [f'port:={port}']}
    return {name: subprocess.Popen(
        [executable(name), '--ros-args', *(part for one in given for part in ('-p', one))],
        stderr=subprocess.DEVNULL) for name, given in arguments.items()}


def measure(port: int, turns: int, seconds: float) -> List[dict]:
    """Measure with and without pages in turns; return the rows of the table."""
    processes = start(port)
    node = rclpy.create_node('benchmark')
    phases, pictures = Phases(node, processes), dict.fromkeys(PAGES, 0)
    try:
        phases.wait(8.0)
        for _ in range(turns):
            for count in PAGES:
                pages = subprocess.Popen(
                    [sys.executable, __file__, '--pages', str(port), str(count)],
                    stdout=subprocess.PIPE)
                try:
                    phases.measure(count, seconds)
                finally:
                    pages.terminate()
                pictures[count] += int(pages.communicate()[0])
    finally:
        for process in processes.values():
            process.terminate()
            process.wait()
        node.destroy_node()
    whole_s = turns * (seconds + _SETTLING_S)
    return phases.rows() + [{'what': 'pictures that the pages got', 'pages': count,
                             'rate_hz': round(got / whole_s, 1)}
                            for count, got in pictures.items()]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--quick', action='store_true', help='few seconds, for its exit code')
    parser.add_argument('--json', metavar='FILE', help='write the rows as a list of objects')
    parser.add_argument('--pages', type=int, nargs=2, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.pages:
        asyncio.run(be_pages(*arguments.pages))
        return
    os.environ.setdefault('ROS_DOMAIN_ID', str(1 + os.getpid() % 100))
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    with socket.socket() as one:
        one.bind(('127.0.0.1', 0))
        port = one.getsockname()[1]
    turns, seconds = (1, 3.0) if arguments.quick else (4, 15.0)
    print_rows(measure(port, turns, seconds), arguments.json)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
