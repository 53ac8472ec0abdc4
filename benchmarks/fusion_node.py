# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
What `camera_fusion` costs: silhouettes of five objects of two cameras, 30 times a second.

Its row is part of `scripts/benchmark nodes`. The objects rest, with the noise of an outline. A
bare node receives the same bytes and publishes as many poses: the share of rclpy and DDS.
"""

from pathlib import Path
from statistics import median
import subprocess
import sys
import time

from builtin_interfaces.msg import Time
from camera_to_base.coordinate_transform import Pose
from camera_to_base.ros import camera_pose, SilhouetteTopics, SurfaceSilhouette, UncertainPose
from geometry_msgs.msg import PoseArray
import numpy as np
import rclpy
from std_msgs.msg import Header

sys.path.insert(0, str(Path(__file__).parents[1] / 'test'))
from two_cameras import base_of, PAIRS, seen  # noqa: E402, I100

PERIOD_S, LATER_S = 1 / 30, 0.004
LONGEST_S = 20.0
CORNERS, NOISE_PX, VIEWS = 32, 0.2, 30
OBJECTS = [
    (base_of('box', 4.0, 3.0, (6.0, 2.0), 0.3), 2.0),
    (base_of('disc', 3.0, 3.0, (-7.0, -1.0), 0.0), 5.0),
    (base_of('box', 5.0, 2.0, (-14.0, 8.0), 1.0), 3.0),
    (base_of('hexagon', 4.0, 4.0, (14.0, -8.0), 0.0), 4.0),
    (base_of('box', 4.0, 2.5, (0.0, -8.0), 0.7), 1.5)]
TOPIC = 'objects_in_robot_base_frame'
BARE = [sys.executable, str(Path(__file__).with_name('relay.py')), 'silhouettes']


class Cameras:
    """Two cameras' transform nodes, as `camera_fusion` hears them."""

    def __init__(self, node):
        self._node, self._late = node, []
        self._topics = [
            SilhouetteTopics(node, f'{name}/{TOPIC}', f'{name}/camera_in_robot_base_frame')
            for name in ('left', 'right')]
        random, places = np.random.default_rng(1), PAIRS['tilted 30 degrees, opposite sides']
        self._views = [[self._seen(place, random) for place in places] for _ in range(VIEWS)]
        for topics, place in zip(self._topics, places):
            topics.publish_camera(Header(frame_id='base_link'), camera_pose(
                *place.foot_cm, place.height_cm, np.zeros((3, 3))))
        node.create_subscription(PoseArray, TOPIC, self._on_objects, 10)

    def show(self, frames):
        """Publish frames; return how long after the later stamp each answer came, in s."""
        until = time.time() + LONGEST_S
        while not all(topics.is_wanted for topics in self._topics):
            if time.time() > until:
                raise RuntimeError(f'no node subscribes to {TOPIC}/silhouettes')
            self._spin_until(time.time() + 0.1)
        self._late.clear()
        start = time.time()
        for number in range(frames):
            for topics, view in zip(self._topics, self._views[number % VIEWS]):
                nanoseconds = time.time_ns()
                topics.publish(Header(frame_id='base_link', stamp=Time(
                    sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)), view)
                self._spin_until(time.time() + LATER_S)
            self._spin_until(start + (number + 1) * PERIOD_S)
        return self._late

    def _on_objects(self, message):
        stamp = message.header.stamp
        self._late.append(time.time() - stamp.sec - stamp.nanosec * 1e-9)

    def _spin_until(self, until):
        while time.time() < until:
            rclpy.spin_once(self._node, timeout_sec=min(max(until - time.time(), 0.0), 0.002))

    @staticmethod
    def _seen(place, random):
        view = []
        for base, height in OBJECTS:
            corners = seen(base, height, place, random, noise_px=NOISE_PX).corners
            corners = corners[::max(len(corners) // CORNERS, 1)]
            view.append(SurfaceSilhouette(
                np.column_stack([corners, np.zeros(len(corners))]), UncertainPose(
                    Pose(*corners.mean(axis=0).tolist(), 0.0, 0.0), 1e-4 * np.eye(6))))
        return view


def end(process):
    """Ask a node to end, then kill it: a bare one may wait for a message after the signal."""
    process.terminate()
    try:
        process.wait(2.0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def fusion_costs(command, cpu_seconds, rounds, frames):
    """
    Compare the CPU time of `camera_fusion` for two cameras' frames with a bare node's.

    :param command: Starts `camera_fusion`.
    :param cpu_seconds: Reads the CPU time of a process.
    """
    costs = {'bare': [], 'fusion': []}
    for _ in range(rounds):
        for name, start in (('bare', BARE), ('fusion', command)):
            node = rclpy.create_node('benchmark')
            cameras = Cameras(node)
            process = subprocess.Popen(start, stderr=subprocess.DEVNULL)
            try:
                cameras.show(60)
                before = cpu_seconds(process.pid)
                late = median(cameras.show(frames))
                costs[name].append(((cpu_seconds(process.pid) - before) / frames, late))
            finally:
                end(process)
                node.destroy_node()
    for name, found in costs.items():
        seconds, late = (median(column) for column in zip(*found))
        yield {'node': {'bare': 'relay of silhouettes', 'fusion': 'camera_fusion'}[name],
               'ms_per_pair': round(1e3 * seconds, 3),
               'percent_of_a_core': round(100 * seconds / PERIOD_S, 1),
               'ms_from_stamp': round(1e3 * late, 1),
               'ratio': round(median(one[0] / bare[0] for one, bare in zip(
                   found, costs['bare'])), 2)}
