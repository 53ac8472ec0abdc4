# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Programs that listen to the camera node's pictures, and are killed."""

from pathlib import Path
import signal
import subprocess
import sys
import time

import pytest

pytestmark = pytest.mark.slow

LISTENER = str(Path(__file__).parents[1] / 'picture_listener.py')
KILLS, LISTENS_S = 7, '4'


def pictures_of_a_listener_that_is_killed():
    listener = subprocess.Popen(
        [sys.executable, LISTENER, LISTENS_S], stdout=subprocess.PIPE, text=True)
    try:
        count = int(listener.stdout.readline())
        # It is killed while messages wait for it, as on a busy machine.
        listener.send_signal(signal.SIGSTOP)
        time.sleep(1.0)
        return count
    finally:
        listener.kill()
        listener.communicate()


def test_pictures_come_though_other_listeners_were_killed(start):
    # With this noise a picture has 61 kB, hardly less than the largest message of Fast DDS.
    start('camera_publisher', '-p', 'source:=simulated', '-p', 'simulated.noise:=2.3',
          '-p', 'simulated.frame_rate:=30.0')
    counts = [pictures_of_a_listener_that_is_killed() for _ in range(KILLS)]
    assert min(counts) > 0, counts
