# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The `--help` texts of the nodes' executables."""

from typing import List

NODE_HELP = {
    'camera_publisher': """
Finds objects on a camera's frames, and publishes their positions on the work surface.

publishes:
  pos_in_cam_frame           std_msgs/Float64MultiArray: [x, y] of the largest object, in cm
  pos_in_cam_frame/point     geometry_msgs/PointStamped: the same object, in m
  pos_in_cam_frame/pose      geometry_msgs/PoseWithCovarianceStamped: the same, with its covariance
  objects_in_cam_frame       geometry_msgs/PoseArray: every object, largest first, in m
  objects_in_cam_frame/ellipses  visualization_msgs/MarkerArray: where 95 % of errors lie, for RViz
  objects_in_cam_frame/boxes     visualization_msgs/MarkerArray: yaw, length, width and height
  objects_in_cam_frame/silhouettes  visualization_msgs/MarkerArray: outlines, for camera_fusion
  camera_in_cam_frame        geometry_msgs/PoseWithCovarianceStamped: where the camera is
  objects_in_cam_frame/left_out  visualization_msgs/MarkerArray: what is not published, and why
  frame/compressed           sensor_msgs/CompressedImage: the frame as JPEG, at most 10 a second
  mask/compressed, background/compressed  likewise as PNG; the background when it is taken
  debug_image, mask          sensor_msgs/Image: the objects found, drawn if there is a subscriber
  debug_image/compressed     sensor_msgs/CompressedImage: the same as JPEG
  true_pos_in_cam_frame      with source:=simulated only: true position of the coin, in cm
  true_objects_in_cam_frame  likewise: true positions of all objects, in m
  true_objects_in_cam_frame/boxes  likewise: their true boxes, visualization_msgs/MarkerArray
  simulated_tool             likewise: geometry_msgs/PoseStamped of the simulated robot's tool
  /diagnostics               state of the node, once a second

subscribes to:
  image                      with source:=topic: sensor_msgs/Image of any camera driver
  image/compressed           with source:=compressed_topic: sensor_msgs/CompressedImage

services:
  ~/capture_background       std_srvs/Trigger: takes a new background; clear the surface first
  ~/bump_camera              with source:=simulated only: std_srvs/Trigger, bumps the camera

parameters that are used most:
  source                     auto (default), a device (0, /dev/video0), a video file, a stream's
                             URL, topic, compressed_topic, simulated, random
  detector.method            precise or tutorial
  surface.model              parallel, polynomial or homography; calibrate writes the right one
  surface.parallel.width_cm  width of the surface that the picture shows

examples:
  ros2 run camera_to_base {name} --ros-args -p source:=simulated
  ros2 run camera_to_base {name} --ros-args -p source:=0 --params-file cell.yaml
  ros2 run camera_to_base {name} --ros-args -p source:=topic -r image:=/camera/image_raw
""",
    'robot_base_publisher': """
Converts positions from the camera frame to the robot's base frame with a homogeneous matrix.

subscribes to:
  pos_in_cam_frame                std_msgs/Float64MultiArray: [x, y], in cm
  pos_in_cam_frame/point          geometry_msgs/PointStamped, in m
  pos_in_cam_frame/pose           geometry_msgs/PoseWithCovarianceStamped, in m and rad
  objects_in_cam_frame            geometry_msgs/PoseArray, in m
  objects_in_cam_frame/ellipses   visualization_msgs/MarkerArray, while its result has subscribers
  objects_in_cam_frame/boxes, objects_in_cam_frame/silhouettes  likewise
  camera_in_cam_frame             geometry_msgs/PoseWithCovarianceStamped, in m

publishes, one message for each that it receives:
  pos_in_robot_base_frame         std_msgs/Float64MultiArray: [x, y], in cm
  pos_in_robot_base_frame/point   geometry_msgs/PointStamped, in m
  pos_in_robot_base_frame/pose    geometry_msgs/PoseWithCovarianceStamped, in m and rad
  objects_in_robot_base_frame     geometry_msgs/PoseArray, in m
  objects_in_robot_base_frame/ellipses  visualization_msgs/MarkerArray, for RViz
  objects_in_robot_base_frame/boxes     visualization_msgs/MarkerArray: what a gripper needs
  objects_in_robot_base_frame/silhouettes  visualization_msgs/MarkerArray, for camera_fusion
  camera_in_robot_base_frame      geometry_msgs/PoseWithCovarianceStamped: where the camera is
  /diagnostics                    state of the node, once a second

parameters that are used most:
  rotation_deg                    roll, pitch, yaw of the camera frame in the base frame
  displacement_cm                 x, y, z of its origin; calibrate base writes both
  reach_cm                        a position farther from the base is dropped

examples:
  ros2 run camera_to_base {name} --ros-args --params-file cell.yaml
  ros2 run camera_to_base {name} --ros-args -p reach_cm:=35.0
""",
    'camera_fusion': """
Fuses what two cameras or more see of the same objects: their places, heights and sizes.

It needs both nodes of each camera, each camera in a namespace of its own.

subscribes to, in the namespace of each camera:
  objects_in_robot_base_frame/silhouettes  visualization_msgs/MarkerArray
  camera_in_robot_base_frame      geometry_msgs/PoseWithCovarianceStamped

publishes:
  pos_in_robot_base_frame         std_msgs/Float64MultiArray: [x, y] of the largest object, in cm
  pos_in_robot_base_frame/point   geometry_msgs/PointStamped: the middle of its top, in m
  pos_in_robot_base_frame/pose    geometry_msgs/PoseWithCovarianceStamped, in m and rad
  objects_in_robot_base_frame     geometry_msgs/PoseArray: every object, largest first, in m
  objects_in_robot_base_frame/ellipses  visualization_msgs/MarkerArray, for RViz
  objects_in_robot_base_frame/boxes     visualization_msgs/MarkerArray: what a gripper needs
  objects_in_robot_base_frame/left_out  visualization_msgs/MarkerArray: what is not, and why
  /diagnostics                    state of the node, once a second

parameters that are used most:
  cameras                         namespaces of the cameras: [left, right]
  highest_object_cm               no object is higher
  one_camera_height_cm            the height of what one camera alone sees

examples:
  ros2 run camera_to_base {name} --ros-args -p cameras:=[left,right]
""",
    'dashboard': """
Serves a page on which a cell is set up and watched in a browser; it prints the page's address.

It needs the other two nodes, on this machine or on another one of the same ROS domain.

parameters that are used most:
  host                       127.0.0.1 (default) for this machine alone, 0.0.0.0 for all networks
  port                       8080
  params_file                the parameter file that is written when a calibration is saved

examples:
  ros2 run camera_to_base {name} --ros-args -p params_file:=$PWD/cell.yaml
  ros2 run camera_to_base {name} --ros-args -p host:=0.0.0.0 -p port:=8081
""",
}
_USAGE = 'usage: ros2 run camera_to_base {name} [--ros-args ROS_ARGUMENTS]\n'
_MORE = """
Descriptions of all parameters, while the node runs:
  ros2 param list /{node}
  ros2 param describe /{node} NAME
"""


def help_text(node: str, name: str) -> str:
    """
    Return a node's help: its purpose, topics, most used parameters, and examples.

    :param node: One of `NODE_HELP`.
    :param name: The executable's name.
    """
    text = _USAGE + NODE_HELP[node] + _MORE
    return text.replace('{name}', name).replace('{node}', node)


def asks_for_help(arguments: List[str]) -> bool:
    """Return whether -h or --help is among a process's arguments."""
    return bool({'-h', '--help'}.intersection(arguments))


def plain_arguments(arguments: List[str]) -> List[str]:
    """Return the arguments that are not between `--ros-args` and `--`, which are for ROS."""
    plain, is_for_ros = [], False
    for argument in arguments:
        if argument == '--ros-args':
            is_for_ros = True
        elif is_for_ros:
            is_for_ros = argument != '--'
        else:
            plain.append(argument)
    return plain
