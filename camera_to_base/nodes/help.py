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

"""What the nodes' executables say after --help."""

from typing import List

NODE_HELP = {
    'camera_publisher': """
Finds objects on a camera's frames, and publishes where they lie on the work surface.

publishes:
  pos_in_cam_frame           std_msgs/Float64MultiArray: [x, y] of the largest object, in cm
  pos_in_cam_frame/point     geometry_msgs/PointStamped: the same object, in m
  objects_in_cam_frame       geometry_msgs/PoseArray: every object, largest first, in m
  debug_image, mask          sensor_msgs/Image: what was found, drawn while somebody listens
  debug_image/compressed     sensor_msgs/CompressedImage: the same as JPEG
  true_pos_in_cam_frame      with source:=simulated only: where the coin really is, in cm
  true_objects_in_cam_frame  likewise: where every object really is, in m
  /diagnostics               how the node is, once a second

subscribes to:
  image                      with source:=topic: sensor_msgs/Image of any camera driver
  image/compressed           with source:=compressed_topic: sensor_msgs/CompressedImage

service:
  ~/capture_background       std_srvs/Trigger: takes the background anew; clear the surface first

parameters that are used most:
  source                     auto (default), a device (0, /dev/video0), a video file, a stream's
                             URL, topic, compressed_topic, simulated, random
  detector.method            precise or tutorial
  surface.model              parallel, polynomial or homography; calibrate writes the right one
  surface.parallel.width_cm  what the picture's width sees

examples:
  ros2 run camera_to_base {name} --ros-args -p source:=simulated
  ros2 run camera_to_base {name} --ros-args -p source:=0 --params-file cell.yaml
  ros2 run camera_to_base {name} --ros-args -p source:=topic -r image:=/camera/image_raw
""",
    'robot_base_publisher': """
Turns positions in the camera frame into the robot's base frame, by a homogeneous matrix.

subscribes to:
  pos_in_cam_frame                std_msgs/Float64MultiArray: [x, y], in cm
  pos_in_cam_frame/point          geometry_msgs/PointStamped, in m
  objects_in_cam_frame            geometry_msgs/PoseArray, in m

publishes, one for each message that it gets:
  pos_in_robot_base_frame         std_msgs/Float64MultiArray: [x, y], in cm
  pos_in_robot_base_frame/point   geometry_msgs/PointStamped, in m
  objects_in_robot_base_frame     geometry_msgs/PoseArray, in m
  /diagnostics                    how the node is, once a second

parameters that are used most:
  rotation_deg                    roll, pitch, yaw of the camera frame in the base frame
  displacement_cm                 x, y, z of its origin; calibrate base writes both
  reach_cm                        a position farther from the base is dropped

examples:
  ros2 run camera_to_base {name} --ros-args --params-file cell.yaml
  ros2 run camera_to_base {name} --ros-args -p reach_cm:=35.0
""",
}
_USAGE = 'usage: ros2 run camera_to_base {name} [--ros-args ROS_ARGUMENTS]\n'
_MORE = """
While it runs, every parameter explains itself:
  ros2 param list /{node}
  ros2 param describe /{node} NAME
"""


def help_text(node: str, name: str) -> str:
    """
    Tell what a node does, its topics, its most used parameters, and examples.

    :param node: One of `NODE_HELP`.
    :param name: What the executable is called.
    """
    text = _USAGE + NODE_HELP[node] + _MORE
    return text.replace('{name}', name).replace('{node}', node)


def asks_for_help(arguments: List[str]) -> bool:
    """Tell whether -h or --help is among a process's arguments."""
    return bool({'-h', '--help'}.intersection(arguments))


def plain_arguments(arguments: List[str]) -> List[str]:
    """Leave out what stands between `--ros-args` and `--`, which is meant for ROS."""
    plain, is_for_ros = [], False
    for argument in arguments:
        if argument == '--ros-args':
            is_for_ros = True
        elif is_for_ros:
            is_for_ros = argument != '--'
        else:
            plain.append(argument)
    return plain
