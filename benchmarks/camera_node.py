# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Measures the camera node on a topic of pictures: latency, CPU time, memory.

    scripts/benchmark camera_node [--quick] [--profile FILE] [--json FILE]

Another process publishes pictures of a grained table with one coin. --profile gives that process a
Fast DDS profile, such as config/fastdds/large_pictures.xml. The latency is from a picture's stamp
to the arrival of its position in this process. The CPU time of the node is that of all its
threads, in per cent of one core. `lost` counts the published pictures without a position. `missed`
names the goals that a row does not meet; it takes two minutes, on a machine without other work.
"""

import argparse
from array import array
import itertools
import os
import subprocess
import sys
import time
from typing import Dict, Iterator, List, Optional, Set, Tuple

from builtin_interfaces.msg import Time
import cv2
from geometry_msgs.msg import PointStamped
from nodes import cpu_seconds, executable, resident_megabytes
import numpy as np
import rclpy
from rclpy.signals import SignalHandlerOptions
from rows import print_rows
from sensor_msgs.msg import CompressedImage, Image
from whole_way import make_frames, table

SIZES = (640, 480), (1280, 720), (1920, 1080)
RATE_HZ = 30
_EMPTY_S, _SETTLING_S = 2.0, 2.0
# How many pictures are rendered, how often each is sent with another lower end, and its rows.
_PICTURES, _TURNS, _END_ROWS = 20, 5, 8
_SECONDS = 10.0
# By height and kind of picture: what a row must not exceed.
_GOALS = {'lost': 0, 'resident_mb': 250}
_MORE_GOALS = {(720, 'raw'): {'p99_ms': 33}, (720, 'jpeg'): {'p99_ms': 33},
               (1080, 'raw'): {'cpu_percent': 35}, (1080, 'jpeg'): {'cpu_percent': 60}}


def feed(size: Tuple[int, int], is_compressed: bool, seconds: float) -> None:
    """Publish pictures: of the empty table first, then with a coin."""
    surface = table(size, is_textured=True)
    empty, coin = (_messages(make_frames(surface, count, _PICTURES), is_compressed)
                   for count in (0, 1))
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node('feeder')
    publisher = node.create_publisher(
        CompressedImage if is_compressed else Image,
        'image/compressed' if is_compressed else 'image', 10)
    while not publisher.get_subscription_count():
        time.sleep(0.05)
    begin = time.monotonic()
    for number in range(round((_EMPTY_S + _SETTLING_S + seconds) * RATE_HZ)):
        time.sleep(max(0.0, begin + number / RATE_HZ - time.monotonic()))
        message = next(empty if number < _EMPTY_S * RATE_HZ else coin)
        message.header.stamp = node.get_clock().now().to_msg()
        publisher.publish(message)
        print(_nanoseconds(message.header.stamp), flush=True)


def _messages(frames: List[np.ndarray], is_compressed: bool) -> Iterator:
    # The node refuses a picture whose lower end equals that of one of the last 16. If 20 pictures
    # were repeated, a few lost ones would make it refuse more.
    if is_compressed:
        return itertools.cycle([_message(_with_other_end(frame, turn), is_compressed)
                                for turn in range(_TURNS) for frame in frames])
    return _raw_messages(frames)


def _raw_messages(frames: List[np.ndarray]) -> Iterator:
    messages = [_message(frame, False) for frame in frames]
    for turn in itertools.count():
        for frame, message in zip(frames, messages):
            end = _with_other_end(frame[-_END_ROWS:], turn).tobytes()
            message.data[-len(end):] = array('B', end)
            yield message


def _with_other_end(frame: np.ndarray, turn: int) -> np.ndarray:
    frame = frame.copy()
    end = frame[-_END_ROWS:]
    end += np.random.default_rng(turn).integers(0, 2, end.shape, dtype=np.uint8)
    return frame


def _message(frame: np.ndarray, is_compressed: bool) -> object:
    if is_compressed:
        jpeg = cv2.imencode('.jpg', frame, [cv2.IMWRITE_JPEG_QUALITY, 85])[1]
        return CompressedImage(format='jpeg', data=array('B', jpeg.tobytes()))
    height, width = frame.shape[:2]
    return Image(height=height, width=width, encoding='bgr8', step=3 * width,
                 data=array('B', frame.tobytes()))


def measure(
    size: Tuple[int, int], is_compressed: bool, seconds: float, profile: Optional[str] = None
) -> dict:
    """Start the node and a feeder, which has a Fast DDS profile; return the row of the table."""
    camera = subprocess.Popen(
        [executable('camera_publisher'), '--ros-args', '-p',
         f'source:={"compressed_topic" if is_compressed else "topic"}'],
        stderr=subprocess.DEVNULL)
    feeder = _start_feeder(size, is_compressed, seconds, profile)
    node = rclpy.create_node('benchmark')
    # By stamp in ns: after how many ns the position arrived.
    latencies: Dict[int, int] = {}

    def on_position(message: PointStamped) -> None:
        stamp = _nanoseconds(message.header.stamp)
        latencies[stamp] = node.get_clock().now().nanoseconds - stamp

    node.create_subscription(PointStamped, 'pos_in_cam_frame/point', on_position, 10)
    try:
        while not latencies:
            rclpy.spin_once(node, timeout_sec=0.1)
        _spin(node, _SETTLING_S)
        latencies.clear()
        begin, before = time.monotonic(), cpu_seconds(camera.pid)
        _spin(node, seconds - 0.5)
        elapsed = time.monotonic() - begin
        cpu_s, megabytes = cpu_seconds(camera.pid) - before, resident_megabytes(camera.pid)
    finally:
        for process in (feeder, camera):
            process.kill()
            process.wait()
        node.destroy_node()
    p50, p99 = (np.percentile(list(latencies.values()), [50, 99]) / 1e6).tolist()
    row = {'width': size[0], 'height': size[1], 'picture': 'jpeg' if is_compressed else 'raw',
           'p50_ms': round(p50, 1), 'p99_ms': round(p99, 1),
           'cpu_percent': round(100 * cpu_s / elapsed),
           'lost': len(_published(feeder, min(latencies), max(latencies)) - set(latencies)),
           'resident_mb': round(megabytes)}
    return {**row, 'missed': ', '.join(missed_goals(row)) or 'nothing'}


def _start_feeder(
    size: Tuple[int, int], is_compressed: bool, seconds: float, profile: Optional[str]
) -> subprocess.Popen:
    profiles = {'FASTRTPS_DEFAULT_PROFILES_FILE': profile} if profile else {}
    return subprocess.Popen(
        [sys.executable, __file__, '--feed', *map(str, size), str(int(is_compressed)),
         str(seconds)], stdout=subprocess.PIPE, text=True, env={**os.environ, **profiles})


def _published(feeder: subprocess.Popen, first: int, last: int) -> Set[int]:
    # The stamps between two; a line that was cut off when the process was killed is later.
    with feeder.stdout as lines:
        stamps = {int(line) for line in lines if line.endswith('\n')}
    return {stamp for stamp in stamps if first <= stamp <= last}


def missed_goals(row: dict) -> List[str]:
    """Name the goals that a row of the table does not meet."""
    goals = {**_GOALS, **_MORE_GOALS.get((row['height'], row['picture']), {})}
    return [f'{name} <= {most}' for name, most in goals.items() if row[name] > most]


def _nanoseconds(stamp: Time) -> int:
    return stamp.sec * 10**9 + stamp.nanosec


def _spin(node, seconds: float) -> None:
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        rclpy.spin_once(node, timeout_sec=0.1)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--quick', action='store_true', help='few seconds, for its exit code')
    parser.add_argument('--profile', metavar='FILE', help='Fast DDS profile of the other process')
    parser.add_argument('--json', metavar='FILE', help='write the rows as a list of objects')
    parser.add_argument('--feed', nargs=4, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.feed:
        width, height, is_compressed, seconds = arguments.feed
        feed((int(width), int(height)), bool(int(is_compressed)), float(seconds))
        return
    os.environ.setdefault('ROS_DOMAIN_ID', str(1 + os.getpid() % 100))
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    sizes, seconds = (SIZES[:1], 3.0) if arguments.quick else (SIZES, _SECONDS)
    print_rows((measure(size, is_compressed, seconds, arguments.profile) for size in sizes
                for is_compressed in (False, True)), arguments.json)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
