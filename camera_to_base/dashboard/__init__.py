# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The dashboard: a page on which a cell is set up and watched in a browser.

In: what the two nodes offer to everybody, by topics, services and parameters. Out: a page, and the
parameters that a person sets on it. It has rooms of its own: `live` listens to the nodes,
`sessions` guides through a calibration, `server` answers requests, and `web` is the page.

Callers: only the installed executable, so there is no `__all__`.
"""

__all__ = []
