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
The feeds: one for each kind of source, which passes its frames or pixels to a camera node.

In: a source and the node's settings. Out: callbacks with frames, in the node's executor, and why
there are none.

Callers: `nodes.camera_publisher` and `nodes.camera_watch`.
"""

from camera_to_base.nodes.feeds.feed import Feed, FeedCallbacks, start_feed

__all__ = ['Feed', 'FeedCallbacks', 'start_feed']
