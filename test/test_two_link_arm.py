# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import math
from pathlib import Path
import signal
import subprocess
import sys

from geometry_msgs.msg import PointStamped
import pytest
from sensor_msgs.msg import JointState

EXAMPLES = Path(__file__).parents[1] / 'examples'
COMMAND = [sys.executable, EXAMPLES / 'two_link_arm.py', '--ros-args', '-p']
# Stamp of the points that only ask whether the arm is there.
FIRST_SEC = 99
sys.path.insert(0, str(EXAMPLES))
from two_link_arm import joint_angles  # noqa: E402 I100


def tip(shoulder, elbow, upper_arm, forearm):
    """Forward kinematics."""
    return (upper_arm * math.cos(shoulder) + forearm * math.cos(shoulder + elbow),
            upper_arm * math.sin(shoulder) + forearm * math.sin(shoulder + elbow))


def stamped_point(x, y, sec):
    message = PointStamped()
    message.header.stamp.sec, message.header.stamp.nanosec = sec, 123456789
    message.header.frame_id = 'base_link'
    message.point.x, message.point.y = x, y
    return message


def connected(ros):
    """Give a publisher of points and the list of answers, once the arm answers."""
    answers = []
    publisher = ros.node.create_publisher(PointStamped, 'pos_in_robot_base_frame/point', 10)
    ros.node.create_subscription(JointState, 'joint_states', answers.append, 100)

    def is_answered():
        publisher.publish(stamped_point(0.2, 0.1, FIRST_SEC))
        return answers

    assert ros.spin_until(is_answered)
    return publisher, answers


@pytest.mark.parametrize('upper_arm, forearm', [(0.16, 0.14), (0.1, 0.3), (0.15, 0.15)])
def test_forward_kinematics_bring_the_angles_back_to_the_point(upper_arm, forearm):
    nearest, farthest = abs(upper_arm - forearm), upper_arm + forearm
    for step in range(1, 20):
        radius = nearest + (farthest - nearest) * step / 20
        for direction in range(0, 360, 7):
            x = radius * math.cos(math.radians(direction))
            y = radius * math.sin(math.radians(direction))
            shoulder, elbow = joint_angles(x, y, upper_arm, forearm)
            assert tip(shoulder, elbow, upper_arm, forearm) == pytest.approx((x, y), abs=1e-9)
            assert -math.pi <= shoulder <= math.pi and 0.0 <= elbow <= math.pi


def test_arm_points_to_the_side_with_a_bent_elbow():
    assert joint_angles(1.0, 1.0, 1.0, 1.0) == pytest.approx((0.0, math.pi / 2))


@pytest.mark.parametrize('x, y', [
    (0.31, 0.0), (0.0, -0.31), (0.0, 0.0), (0.019, 0.0),
    (math.nan, 0.1), (0.1, math.nan), (math.inf, 0.0), (-math.inf, math.inf), (1e200, 0.0)])
def test_point_that_the_arm_cannot_reach_has_no_angles(x, y):
    assert joint_angles(x, y, 0.16, 0.14) is None


@pytest.mark.slow
@pytest.mark.parametrize('given, got', [
    ('upper_arm_m:=0', '0'), ('upper_arm_m:=-0.1', '-0.1'), ('forearm_m:=.nan', 'nan'),
    ('forearm_m:=.inf', 'inf'), ('forearm_m:=0,14', "'0,14'"), ('forearm_m:=true', 'True')])
def test_what_is_no_length_is_one_sentence(given, got):
    arm = subprocess.run([*COMMAND, given], capture_output=True, text=True, timeout=30.0)
    name, default = ('upper_arm_m', 0.16) if 'upper' in given else ('forearm_m', 0.14)
    assert arm.returncode == 1 and arm.stdout == ''
    assert arm.stderr == (f'two_link_arm: cannot start: {name} must be a length above 0 m, '
                          f'such as {default}, got {got}\n')


def test_arguments_that_ros_refuses_end_it_without_a_traceback():
    arm = subprocess.run([*COMMAND, 'forearm_m'], capture_output=True, text=True, timeout=30.0)
    assert arm.returncode == 1 and "'-p forearm_m'" in arm.stderr.splitlines()[-1]
    assert 'Traceback' not in arm.stderr


def test_process_answers_each_point_within_reach_and_keeps_its_stamp(ros):
    arm = subprocess.Popen(
        [*COMMAND, 'upper_arm_m:=1', '-p', 'forearm_m:=0.9'],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        publisher, answers = connected(ros)
        for sec, x in enumerate((0.25, 2.0, math.nan, -0.25)):
            publisher.publish(stamped_point(x, 0.1, sec))
        assert ros.spin_until(lambda: answers[-1].header.stamp.sec == 3)
        ros.spin_for(0.2)
    finally:
        arm.send_signal(signal.SIGINT)
        output, _ = arm.communicate(timeout=10.0)
    answers = [state for state in answers if state.header.stamp.sec != FIRST_SEC]
    assert [(state.header.stamp.sec, state.header.stamp.nanosec) for state in answers] == [
        (0, 123456789), (3, 123456789)]
    for state, x in zip(answers, (0.25, -0.25)):
        assert list(state.name) == ['shoulder', 'elbow']
        assert tip(*state.position, 1.0, 0.9) == pytest.approx((x, 0.1))
    assert output.count('is out of reach') == 1, output  # throttled: NaN came right after it
    assert arm.returncode == 0 and 'Traceback' not in output


@pytest.mark.parametrize('upper_arm, forearm', [(0.0, 0.1), (0.1, -0.1), (math.nan, 0.1)])
def test_arm_of_no_length_reaches_nothing(upper_arm, forearm):
    assert joint_angles(0.1, 0.0, upper_arm, forearm) is None


@pytest.mark.parametrize('argument, code', [('--help', 0), ('-h', 0), ('--lenght', 2)])
def test_help_is_printed_and_other_arguments_are_refused(argument, code):
    arm = subprocess.run([*COMMAND[:2], argument], capture_output=True, text=True, timeout=30)
    assert arm.returncode == code
    assert ('upper_arm_m' in arm.stdout) == (code == 0) and 'Traceback' not in arm.stderr
