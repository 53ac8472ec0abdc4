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

"""The installed executables of the commands."""

from camera_to_base.blas_threads import use_one_blas_thread


def calibrate() -> int:
    """Run the command `calibrate`."""
    use_one_blas_thread()
    from camera_to_base.commands.calibrate.command import main
    return main()


def locate() -> int:
    """Run the command `locate`."""
    from camera_to_base.commands.locate.command import main
    return main()
