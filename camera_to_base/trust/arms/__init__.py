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

"""
Hands and arms: what reaches in from the edge of the picture, and what it touches or shades.

In: a frame's record with its objects. Out: the same, without those that are not free.

Caller: `trust.pipeline`.
"""

from camera_to_base.trust.arms.arm_check import ArmCheck, ArmStage
from camera_to_base.trust.arms.reaching_in import ReachingIn

__all__ = ['ArmCheck', 'ArmStage', 'ReachingIn']
