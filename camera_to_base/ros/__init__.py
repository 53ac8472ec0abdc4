# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
ROS: messages, topics, timers, diagnostics and parameters, as ROS has them.

In: positions, pictures and health as the other rooms have them. Out: messages and publishers, and
the other way round.

Callers: `nodes`, and commands that listen to a running node. It does not import OpenCV: the
transform node starts without it.
"""

from camera_to_base.ros.boxes import box_markers, boxes_of_markers, SolidBox
from camera_to_base.ros.diagnostics import (
    Diagnostics, Health, Heartbeat, NameCheck, qos_mismatch, real_time_timer)
from camera_to_base.ros.driver import (
    camera_info_topic, DriverInfo, is_rectified, PictureListener)
from camera_to_base.ros.listeners import CorrectionListener, ObjectListener, ToolListener
from camera_to_base.ros.marker_bytes import markers_of_bytes
from camera_to_base.ros.messages import (
    left_out_markers, point_from_message, poses_from_message, poses_message, poses_of_markers,
    position_from_message, position_message, tool_message, uncertain_pose_from_message,
    UncertainPose)
from camera_to_base.ros.parameters import NodeParameters
from camera_to_base.ros.position_topics import NO_EVENTS, PositionTopics
from camera_to_base.ros.process import keep_freed_memory, run, use_picture_memory, whole_or_gone
from camera_to_base.ros.silhouettes import (
    camera_pose, latched, silhouette_markers, silhouettes_of_markers, SilhouetteTopics,
    SurfaceSilhouette)

__all__ = [
    'box_markers', 'boxes_of_markers', 'camera_info_topic', 'camera_pose',
    'CorrectionListener', 'Diagnostics', 'DriverInfo', 'Health', 'Heartbeat', 'is_rectified',
    'keep_freed_memory', 'latched', 'left_out_markers', 'markers_of_bytes', 'NameCheck',
    'NO_EVENTS', 'NodeParameters', 'ObjectListener', 'PictureListener', 'point_from_message',
    'poses_from_message', 'poses_message', 'poses_of_markers', 'position_from_message',
    'position_message', 'PositionTopics', 'qos_mismatch', 'real_time_timer', 'run',
    'silhouette_markers', 'silhouettes_of_markers', 'SilhouetteTopics', 'SolidBox',
    'SurfaceSilhouette', 'tool_message', 'ToolListener', 'uncertain_pose_from_message',
    'UncertainPose', 'use_picture_memory', 'whole_or_gone',
]
