# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.errors import all_well, Level, Reason
from camera_to_base.ros.diagnostics import Diagnostics, Health, Heartbeat
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
import pytest


class RecordedHeartbeat:
    """Keeps the periods and the tasks instead of calling them."""

    def __init__(self):
        self.tasks = []

    def every(self, period_s, task):
        self.tasks.append((period_s, task))


def test_health_is_published_each_second(ros):
    heartbeat = RecordedHeartbeat()
    received = ros.listen_to(DiagnosticArray, '/diagnostics')
    Diagnostics(ros.node, heartbeat, lambda: Health(all_well('all is well'), {'frames': '3'}))
    (period_s, publish), = heartbeat.tasks
    assert period_s == 1.0
    assert ros.spin_until(lambda: ros.hears('/diagnostics'))
    publish()
    assert ros.spin_until(lambda: received)
    status, = received[0].status
    assert status.name == '/test_listener' and status.message == 'all is well'
    assert {pair.key: pair.value for pair in status.values} == {'reason': 'ok', 'frames': '3'}


@pytest.mark.parametrize('level, constant', [
    (Level.OK, DiagnosticStatus.OK), (Level.WARN, DiagnosticStatus.WARN),
    (Level.ERROR, DiagnosticStatus.ERROR)])
def test_level_of_a_reason_is_that_of_the_message(ros, level, constant):
    heartbeat = RecordedHeartbeat()
    received = ros.listen_to(DiagnosticArray, '/diagnostics')
    reason = Reason('view_moved', level, 'the view has moved')
    diagnostics = Diagnostics(ros.node, heartbeat, lambda: Health(reason, {}))
    assert ros.spin_until(lambda: ros.hears('/diagnostics'))
    diagnostics.publish()
    assert ros.spin_until(lambda: received)
    assert received[0].status[0].level == constant


@pytest.mark.slow
def test_heartbeat_keeps_the_ratio_of_the_periods(ros):
    heartbeat, calls = Heartbeat(ros.node), []
    heartbeat.every(0.6, lambda: calls.append('slow'))
    heartbeat.every(0.2, lambda: calls.append('fast'))
    heartbeat.every(0.01, lambda: calls.append('fastest'))
    assert ros.spin_until(lambda: calls.count('slow') == 2)
    assert 5 <= calls.count('fast') <= 6 and 5 <= calls.count('fastest') <= 6
