# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""What a camera's transform node tells about upright objects, without a camera."""

from camera_to_base.coordinate_transform import Pose
from camera_to_base.ros import camera_pose, SilhouetteTopics, SurfaceSilhouette, UncertainPose
import numpy as np
from ros_helpers import stamp_now
from std_msgs.msg import Header
from two_cameras import base_of, seen

OBJECTS = '/objects_in_robot_base_frame'
SURFACE_Z_CM = 1.0
BOX = base_of('box', 4.0, 3.0, (6.0, 2.0), 0.3), 2.0
DISC = base_of('disc', 3.0, 3.0, (-7.0, -1.0), 0.0), 5.0


class FakeCamera:
    """Publishes what a camera's transform node would."""

    def __init__(self, ros, name, place, frame_id='base_link'):
        self._place, self._frame_id = place, frame_id
        self._topics = SilhouetteTopics(
            ros.node, f'{name}{OBJECTS}', f'{name}/camera_in_robot_base_frame')
        self._random, self.moved = np.random.default_rng(1), (0.0, 0.0)
        self._topics.publish_camera(Header(frame_id=frame_id), camera_pose(
            *place.foot_cm, SURFACE_Z_CM + place.height_cm, np.zeros((3, 3))))

    @property
    def is_heard(self):
        """Whether a node listens to it."""
        return self._topics.is_wanted

    def show(self, stamp, *objects):
        """Publish what is seen of objects, each a base and a height."""
        outlines = [seen(*one, self._place, self._random, moved=self.moved) for one in objects]
        self._topics.publish(Header(frame_id=self._frame_id, stamp=stamp), [
            SurfaceSilhouette(
                np.column_stack([one.corners, np.full(len(one.corners), SURFACE_Z_CM)]),
                UncertainPose(Pose(*one.corners.mean(axis=0).tolist(), SURFACE_Z_CM, 0.0),
                              1e-4 * np.eye(6))) for one in outlines])


def show_until(ros, condition, *shows):
    """Show objects, each time a camera and its objects, until a condition holds."""
    def step():
        stamp = stamp_now()
        for camera, objects in shows:
            camera.show(stamp, *objects)
        ros.spin_for(0.05)
        return condition()
    assert ros.spin_until(step)
