# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The exit code says whether a node could not start, or failed later and may be started again."""

import subprocess
import sys

FAILING_NODE = """
from camera_to_base.lifetime import run
from rclpy.node import Node


class Failing(Node):

    def __init__(self):
        super().__init__('failing')
        {}

    def fail(self):
        raise {}


raise SystemExit(run('failing', Failing, []))
"""


def run_failing(when, error):
    return subprocess.run(
        [sys.executable, '-c', FAILING_NODE.format(when, error)],
        text=True, capture_output=True, timeout=30.0)


def test_node_that_cannot_start_ends_with_1_and_a_sentence():
    child = run_failing('self.fail()', "ValueError('no such file')")
    assert child.returncode == 1 and 'cannot start: no such file' in child.stderr
    assert 'Traceback' not in child.stderr


def test_node_that_fails_while_it_runs_ends_with_70_and_a_traceback():
    child = run_failing('self.create_timer(0.01, self.fail)', "ValueError('a defect')")
    assert child.returncode == 70 and 'ValueError: a defect' in child.stderr
