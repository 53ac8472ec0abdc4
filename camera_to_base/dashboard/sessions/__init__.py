# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Sessions: what a person does on the page, step by step, and how far it has come.

In: the newest frames, objects and parameters of a cell, and what a page asks for. Out: the state
of each part as JSON, pictures, and the parameters that are to be set on the cell's nodes. The
steps themselves are those of `calibration`, as `calibrate` uses them. Nothing here knows of ROS or
of the web server.

Callers: the modules of `dashboard`.
"""

__all__ = []
