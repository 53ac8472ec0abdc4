# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The view: whether the camera still sees the surface from where the background was taken.

In: the background, and frames of the same size. Out: how far the view has moved, or the reason why
that cannot be told. `quick_look` looks at every frame, `view_check` compares all of a frame, and
`view_watch` decides between them; `view_stage` also follows a camera that is nudged.

Caller: `pipeline.pipeline`.
"""

from camera_to_base.pipeline.view.quick_look import QuickLook
from camera_to_base.pipeline.view.view_check import View, ViewCheck
from camera_to_base.pipeline.view.view_watch import ViewWatch

__all__ = ['QuickLook', 'View', 'ViewCheck', 'ViewWatch']
