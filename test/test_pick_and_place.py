# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The example that picks and places, before a table of which the truth is known."""

import math
from pathlib import Path
import re
import signal
import subprocess
import sys

from demo_pick import SimulatedGripper, TrueBox
import pytest
from ros_helpers import between_waits, stamp_now
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from visualization_msgs.msg import Marker, MarkerArray

EXAMPLE = Path(__file__).parents[1] / 'examples' / 'pick_and_place.py'
COMMAND = [sys.executable, str(EXAMPLE), '--ros-args', '-p']
QUICK = ('motion_s:=0.05', '-p', 'rest_s:=0.3')
TOPIC = 'objects_in_robot_base_frame'


class Table:
    """
    A table, the camera above it, and what the arm's gripper takes from it.

    `slips` grasps push the object away by `push` m; `offset` is the camera's error in x, in m.
    """

    def __init__(self, ros, *boxes, error=0.0005, offset=0.0, slips=0, push=0.02, speed=0.0):
        self.objects = dict(enumerate(boxes, start=1))
        self.error, self.offset, self.slips, self.push = error, offset, slips, push
        self.gripper, self.events, self.joints = SimulatedGripper(), [], []
        self.is_seen, self.age, self.speed = True, 0, speed
        self._publishers = [
            ros.node.create_publisher(MarkerArray, f'{TOPIC}/{kind}', 10)
            for kind in ('boxes', 'ellipses')]
        ros.node.create_subscription(JointState, 'joint_states', self._on_joints, 100)
        self._timer = ros.node.create_timer(0.04, self._publish)

    def happened(self, what):
        return [number for event, number in self.events if event == what]

    def _publish(self):
        if not self.is_seen:
            return
        for box in self.objects.values():
            box.x += self.speed * 0.04
        stamp = stamp_now()
        stamp.sec -= self.age
        header = Header(stamp=stamp, frame_id='base_link')
        for publisher, make in zip(self._publishers, (self._box, self._ellipse)):
            first = Marker(header=header, action=Marker.DELETEALL)
            publisher.publish(MarkerArray(markers=[first, *(
                make(header, box) for box in self.objects.values())]))

    def _box(self, header, box):
        marker = self._ellipse(header, box)
        marker.pose.position.z = box.height / 2
        marker.scale.x, marker.scale.y, marker.scale.z = box.length, box.width, box.height
        marker.pose.orientation.z = math.sin(box.yaw / 2)
        marker.pose.orientation.w = math.cos(box.yaw / 2)
        return marker

    def _ellipse(self, header, box):
        marker = Marker(header=header, action=Marker.ADD)
        marker.pose.position.x, marker.pose.position.y = box.x + self.offset, box.y
        marker.scale.x = marker.scale.y = 2 * self.error
        return marker

    def _on_joints(self, message):
        self.joints.append(dict(zip(message.name, message.position)))
        what, _ = self.gripper.follow(self.joints[-1], self.objects)
        number = self.gripper.held
        if what == 'caught' and self.slips:
            self.gripper.held, what, self.slips = None, 'slipped', self.slips - 1
            self.objects[number].x += self.push
        elif what == 'caught':
            del self.objects[number]
        if what is not None:
            self.events.append((what, number))


def wait_for_line(ros, text):
    """Wait until the example has logged a text."""
    lines = ros.listen_to_log('pick_and_place')
    assert ros.spin_until(lambda: any(text in line.text for line in lines)), lines


def box(x, y, yaw=0.0, length=0.03, width=0.02, height=0.03):
    return TrueBox(x, y, yaw, length, width, height)


@pytest.fixture
def arm():
    """Start the example; it must end well when it is told to."""
    running = []

    def start(*parameters):
        words = [word for parameter in parameters for word in ('-p', parameter)]
        running.append(subprocess.Popen(
            [*COMMAND, *QUICK, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            text=True))
        return lambda: end(running.pop())

    def end(process):
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=10.0)
        assert process.returncode == 0 and 'Traceback' not in output, output
        return output

    yield start
    for process in running:
        end(process)


def test_each_object_is_picked_the_largest_first_across_its_width(ros, arm):
    # None of them fits between the fingers along its length.
    table = Table(ros, box(0.15, 0.10, 0.7, 0.08), box(0.05, 0.12, -1.2, 0.07),
                  box(-0.10, 0.15, 1.5, 0.06))
    output = arm()
    assert ros.spin_until(lambda: len(table.happened('put down')) == 3)
    assert table.happened('caught') == [1, 2, 3] and not table.happened('missed')
    ros.spin_for(0.5)
    assert output().count('picked at') == 3


@pytest.mark.slow
def test_object_that_slips_is_tried_again_where_it_lies_now(ros, arm):
    table = Table(ros, box(0.15, 0.10), slips=2)
    output = arm()
    assert ros.spin_until(lambda: table.happened('put down'))
    assert [event for event, _ in table.events] == ['slipped', 'slipped', 'caught', 'put down']
    assert output().count('not picked at') == 2


@pytest.mark.slow
def test_after_two_retries_an_object_is_left_where_it_is(ros, arm):
    table = Table(ros, box(0.15, 0.10), slips=100, push=0.0)
    output = arm()
    assert ros.spin_until(lambda: len(table.events) == 3)
    ros.spin_for(3.0)
    assert [event for event, _ in table.events] == ['slipped'] * 3
    # It is still the same one after a frame on which it was left out.
    thing = table.objects.pop(1)
    ros.spin_for(0.05)
    table.objects[1] = thing
    ros.spin_for(2.0)
    assert [event for event, _ in table.events] == ['slipped'] * 3
    # Another object at the same place is another matter.
    thing, table.slips = table.objects.pop(1), 0
    ros.spin_for(0.5)
    table.objects[2] = thing
    assert ros.spin_until(lambda: table.happened('caught') == [2])
    assert 'stays there: it could not be picked' in output()


@pytest.mark.slow
def test_camera_that_is_wrong_by_more_than_the_tolerance_picks_nothing(ros, arm):
    table = Table(ros, box(0.15, 0.10), offset=0.005)
    output = arm()
    assert ros.spin_until(lambda: len(table.happened('missed')) == 3)
    ros.spin_for(2.0)
    assert not table.happened('caught') and 'could not be picked' in output()


@pytest.mark.slow
@pytest.mark.parametrize('thing, why', [
    (box(0.15, 0.10, 0.0, 0.08, 0.06), '0.060 m wide, and the gripper opens 0.050 m'),
    (box(0.15, 0.10, 0.0, 0.08, 0.045), '0.045 m wide'),  # there is no room for the tolerance
    (box(0.30, 0.20), 'out of reach')])
def test_what_cannot_be_gripped_is_refused_and_the_next_one_is_picked(ros, arm, thing, why):
    table = Table(ros, thing, box(-0.10, 0.15))
    output = arm()
    assert ros.spin_until(lambda: table.happened('put down'))
    ros.spin_for(1.0)
    assert table.happened('caught') == [2]
    assert output().count(why) == 1


@pytest.mark.slow
def test_object_that_is_not_known_well_enough_waits(ros, arm):
    table = Table(ros, box(0.15, 0.10), error=0.004)
    arm()
    wait_for_line(ros, 'is known to 4.0 mm, and the gripper needs 3.0 mm')
    ros.spin_for(2.0)
    assert table.joints == []
    table.error = 0.002
    assert ros.spin_until(lambda: table.happened('caught'))


@pytest.mark.slow
def test_moving_object_is_picked_when_it_rests(ros, arm):
    table = Table(ros, box(0.10, 0.10), speed=0.01)
    arm()
    wait_for_line(ros, 'is not picked: it moves, or its position jumps, by 2.0 mm or more')
    assert table.joints == []
    table.speed = 0.0
    assert ros.spin_until(lambda: table.happened('caught'))


@pytest.mark.slow
@pytest.mark.parametrize('is_silent', [True, False])
def test_arm_waits_without_fresh_positions(ros, arm, is_silent):
    table = Table(ros, box(0.15, 0.10))
    table.is_seen, table.age = not is_silent, 0 if is_silent else 2
    output = arm()
    ros.spin_for(3.0)
    assert table.joints == []
    table.is_seen, table.age = True, 0
    assert ros.spin_until(lambda: table.happened('caught'))
    assert 'the arm waits' in output()


@pytest.mark.slow
def test_silence_after_a_grasp_is_no_empty_place(ros, arm):
    table = Table(ros, box(0.15, 0.10))
    output = arm()
    assert ros.spin_until(lambda: table.happened('caught'))
    table.is_seen = False
    ros.spin_for(2.0)
    assert not table.happened('put down')
    table.is_seen = True
    assert ros.spin_until(lambda: table.happened('put down'))
    ros.spin_for(0.3)
    assert 'picked at' in output()


def test_signal_between_two_waits_is_an_end(ros):
    table = Table(ros, box(0.15, 0.10), error=0.004)
    process = subprocess.Popen(between_waits(EXAMPLE), stderr=subprocess.PIPE, text=True)
    wait_for_line(ros, 'is known to 4.0 mm')
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=20.0)
    assert process.returncode == 0 and 'Traceback' not in errors and table.joints == []


@pytest.mark.parametrize('away, closing, lift, opening, what', [
    (0.0, 0.0, 0.015, 0.0, 'caught'), (0.0029, 0.0, 0.015, 0.0, 'caught'),
    (0.0031, 0.0, 0.015, 0.0, 'missed'),     # farther than its tolerance
    (0.0, math.pi / 2, 0.015, 0.0, 'missed'),  # along the length, which is longer than it opens
    (0.0, 0.0, 0.031, 0.0, 'missed'),        # above the object
    (0.0, 0.0, 0.015, 0.03, 'missed')])      # it does not close far enough
def test_simulated_gripper_holds_what_it_truly_closes_on(away, closing, lift, opening, what):
    gripper = SimulatedGripper(tolerance=0.003)
    # Upper arm and forearm in one line along x.
    objects = {7: box(0.30 + away, 0.0, math.pi / 2, length=0.06, width=0.02)}
    joints = {'shoulder': 0.0, 'elbow': 0.0, 'lift': lift, 'wrist': closing, 'gripper': 0.05}
    assert gripper.follow(joints, objects) == (None, None)
    happened, distance = gripper.follow({**joints, 'gripper': opening}, objects)
    assert happened == what and distance == pytest.approx(away)
    assert gripper.held == (7 if what == 'caught' else None)
    if what == 'caught':
        assert gripper.follow({**joints, 'gripper': 0.05}, {}) == ('put down', None)
        assert gripper.held is None


@pytest.mark.parametrize('given, said', [
    ('opening_m:=0', 'opening_m must be a number above 0, such as 0.05, got 0'),
    ('tolerance_m:=.nan', 'tolerance_m must be a number above 0, such as 0.003, got nan'),
    ('retries:=-1', 'retries must be a number of at least 0, such as 2.0, got -1'),
    ('place_x_m:=left', "place_x_m must be a number, such as -0.22, got 'left'"),
    ('place_x_m:=3.0', 'place_x_m and place_y_m are out of reach: (3.0, 0.1) m')])
def test_what_is_no_limit_is_one_sentence(given, said):
    arm = subprocess.run([*COMMAND, given], capture_output=True, text=True, timeout=30.0)
    assert arm.returncode == 1 and arm.stdout == ''
    assert arm.stderr == f'pick_and_place: cannot start: {said}\n'


@pytest.mark.parametrize('argument, code', [('--help', 0), ('--retries', 2)])
def test_help_is_printed_and_other_arguments_are_refused(argument, code):
    arm = subprocess.run([*COMMAND[:2], argument], capture_output=True, text=True, timeout=30)
    assert arm.returncode == code
    names = re.findall(r"number\('(\w+)'", EXAMPLE.read_text())
    assert len(names) > 10 and 'Traceback' not in arm.stderr
    assert all((name in arm.stdout) == (code == 0) for name in names)
