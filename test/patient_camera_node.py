# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The camera node with other time-outs for its stream, STREAM_TIMEOUT_MS: a camera that hangs.

Its interpreter takes 0.5 s longer to exit, if it does: a thread whose read returns meanwhile
aborts the process.
"""

import os
import sys
import time

from camera_to_base.nodes import camera_publisher
from camera_to_base.sources import cameras as video_capture


class SlowToGo:
    """Goes when the interpreter has begun to exit."""

    def __del__(self, sleep=time.sleep):
        sleep(0.5)


slow = SlowToGo()
timeouts = video_capture._STREAM_TIMEOUTS
for place in 1, 3:
    assert 1000 <= timeouts[place] <= 2000
    timeouts[place] = int(os.environ['STREAM_TIMEOUT_MS'])
sys.exit(camera_publisher.main())
