# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the camera node publishes of a frame: positions, and pictures if there are subscribers."""

from array import array
import math
import time
from typing import Callable, List, Optional, Sequence

from camera_to_base.coordinate_transform import axis_angle, Pose
from camera_to_base.detection import LocatedObject, silhouette_on_surface, Size
from camera_to_base.drawing import (
    AreaOverlay, draw_ellipses, draw_left_out, draw_note, draw_objects, Label, object_mask)
from camera_to_base.errors import HorizonError
from camera_to_base.nodes.simulated import TruePositions
from camera_to_base.pipeline import FrameUncertainty, Sighting
from camera_to_base.ros import (
    camera_pose, left_out_markers, NO_EVENTS, PositionTopics, SilhouetteTopics, SolidBox,
    SurfaceSilhouette, UncertainPose)
from camera_to_base.settings import NamedSource
from camera_to_base.simulation import SimulatedBoard
from camera_to_base.surface import Hull, Surface, towards_camera
from camera_to_base.uncertainty import PositionCovariance
import cv2
import numpy as np
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header
from visualization_msgs.msg import MarkerArray

POSITION = 'pos_in_cam_frame'
# A message that is sent while two nodes still discover each other may take this long.
_LONGEST_DISCOVERY_S = 5.0

# Nobody looks faster; each frame costs milliseconds.
_SHORTEST_PERIOD_S = 0.09


class PublishedPositions:
    """
    Publishes positions in the camera frame.

    :param node: The node that publishes.
    :param source: The source of its frames.
    """

    def __init__(self, node: Node, source: NamedSource) -> None:
        self._logger = node.get_logger()
        self._topics = PositionTopics(
            node, POSITION, 'objects_in_cam_frame', live=source.kind.is_live)
        self._left_out = node.create_publisher(
            MarkerArray, 'objects_in_cam_frame/left_out', 10, event_callbacks=NO_EVENTS,
            qos_overriding_options=QoSOverridingOptions.with_default_policies())
        self._silhouettes = SilhouetteTopics(
            node, 'objects_in_cam_frame', 'camera_in_cam_frame')
        self._truth: Optional[TruePositions] = None
        if isinstance(source.frames, SimulatedBoard):
            self._truth = TruePositions(node, source.frames)

    @property
    def topic(self) -> str:
        """Name of the tutorial's topic after remapping."""
        return self._topics.name

    @property
    def listener_count(self) -> int:
        """Number of subscribers, see :class:`PositionTopics`."""
        return self._topics.listener_count

    def publish_sighting(
        self, header: Header, sighting: Sighting, hull: Optional[Hull],
        uncertainty: FrameUncertainty, surface: Surface,
    ) -> None:
        """
        Publish the objects of a frame, unless the sighting has a reason not to.

        :param hull: The area that the calibration was measured in; None where it is not known.
        :param surface: Maps the frame's pixels to the work surface.
        """
        if self._truth is not None:
            self._truth.publish(header)
        if sighting.reason is None:
            self._warn_outside_hull(sighting.objects, hull)
            self.publish(header, [Pose(*found.point, 0.0, found.yaw or 0.0)
                                  for found in sighting.objects],
                         lambda number: uncertainty.of(sighting.objects[number]))
            self._publish_left_out(header, sighting)
            if self._topics.wants_boxes:
                self._topics.publish_boxes(header, boxes_of(sighting.objects, surface))
            if self._silhouettes.is_wanted:
                self._publish_silhouettes(header, sighting.objects, uncertainty, surface)

    def publish(
        self, header: Header, poses: List[Pose],
        covariance_of: Callable[[int], PositionCovariance],
    ) -> None:
        """
        Publish poses, in cm, the largest object first; an empty list for an empty surface.

        :param covariance_of: Gives a pose's covariance by its index; called for subscribers only.
        """
        def uncertain(number: int) -> UncertainPose:
            return UncertainPose(poses[number], covariance_of(number).matrix)

        if poses:
            largest = poses[0]
            self._topics.publish_position(largest.x, largest.y)
            self._topics.publish_point(header, largest.x, largest.y)
            if self._topics.wants_pose:
                self._topics.publish_pose(header, uncertain(0))
        self._topics.publish_objects(header, poses)
        if self._topics.wants_ellipses:
            self._topics.publish_ellipses(header, map(uncertain, range(len(poses))))

    def wait_until_received(self) -> None:
        """Wait until all subscribers have received what was published, for at most 5 s."""
        self._topics.wait_until_received(_LONGEST_DISCOVERY_S)

    def _publish_left_out(self, header: Header, sighting: Sighting) -> None:
        if self._left_out.get_subscription_count() > 0:
            self._left_out.publish(left_out_markers(header, [
                (one.point, one.reason) for one in sighting.left_out if one.point is not None]))

    def _publish_silhouettes(
        self, header: Header, objects: Sequence[LocatedObject], uncertainty: FrameUncertainty,
        surface: Surface,
    ) -> None:
        place = surface.camera_place
        if place is None:
            self._logger.warning(
                'no silhouettes are published, as the place of the camera is not known: calibrate '
                'board with tilted placements measures it', once=True)
            return
        (x, y), up = place.foot_cm, towards_camera(surface)
        turned = np.diag([1.0, 1.0, up])
        self._silhouettes.publish_camera(header, camera_pose(
            x, y, up * place.height_cm, turned @ uncertainty.camera_covariance @ turned))
        self._silhouettes.publish(header, silhouettes_of(objects, uncertainty, surface))

    def _warn_outside_hull(
        self, objects: Sequence[LocatedObject], hull: Optional[Hull]
    ) -> None:
        # The accuracy of the calibration is only known inside the area that it was measured in.
        if objects and hull is not None and not hull.contains(objects[0].detection.centre):
            pixel, point = objects[0].detection.centre, objects[0].point
            self._logger.warning(
                f'the object at ({point.x:.2f}, {point.y:.2f}) cm, pixel ({pixel.u:g}, '
                f'{pixel.v:g}), lies outside the area that the calibration was measured in: its '
                'position may be less accurate', throttle_duration_sec=5.0)


def boxes_of(objects: Sequence[LocatedObject], surface: Surface) -> List[SolidBox]:
    """
    Return the boxes around objects, in the camera frame.

    :param surface: Maps the frame's pixels to the work surface.
    """
    boxes, up = [], towards_camera(surface)
    for found in objects:
        try:
            size = found.size(surface)
        except HorizonError:  # A part of it is not on the surface.
            size = Size(0.0, 0.0, 0.0, 0.0)
        middle = Pose(*found.point, up * size.height_cm / 2, axis_angle(
            math.cos(size.angle), math.sin(size.angle)))
        boxes.append(SolidBox(middle, size.length_cm, size.width_cm, size.height_cm))
    return boxes


def silhouettes_of(
    objects: Sequence[LocatedObject], uncertainty: FrameUncertainty, surface: Surface
) -> List[SurfaceSilhouette]:
    """
    Return the silhouettes of objects on the surface, in the camera frame.

    :param surface: Maps the frame's pixels to the work surface.
    """
    silhouettes = []
    for found in objects:
        try:
            corners = silhouette_on_surface(found.detection, surface)
        except HorizonError:  # A part of it is not on the surface.
            continue
        area_cm2 = cv2.contourArea(corners.astype(np.float32))
        pixel_cm = math.sqrt(area_cm2 / found.detection.area)
        silhouettes.append(SurfaceSilhouette(
            np.column_stack([corners, np.zeros(len(corners))]), UncertainPose(
                Pose(*corners.mean(axis=0).tolist(), 0.0, 0.0),
                uncertainty.of_silhouette(found).matrix), pixel_cm))
    return silhouettes


class CameraPictures:
    """
    Publishes the frame as it is, the mask, and the background.

    Nothing is encoded for a topic without subscribers. The background is sent once; a subscriber
    that comes later gets it, too, if it asks for the durability "transient local".

    :param node: The node that publishes.
    """

    def __init__(self, node: Node) -> None:
        def publisher(
            topic: str, durability: DurabilityPolicy = DurabilityPolicy.VOLATILE
        ) -> Publisher:
            return node.create_publisher(
                CompressedImage, f'{topic}/compressed', QoSProfile(
                    depth=1, durability=durability),
                qos_overriding_options=QoSOverridingOptions.with_default_policies())

        self._frame, self._mask = publisher('frame'), publisher('mask')
        self._background = publisher('background', DurabilityPolicy.TRANSIENT_LOCAL)
        self._sent_background: Optional[np.ndarray] = None
        self._last_at = 0.0

    def publish(
        self, header: Header, frame: np.ndarray, sighting: Sighting,
        background: Optional[np.ndarray],
    ) -> None:
        """
        Publish the pictures that have subscribers.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param sighting: The objects that were found on it.
        :param background: Of the same shape; None where there is none.
        """
        if time.monotonic() - self._last_at >= _SHORTEST_PERIOD_S:
            self._publish_frame(header, frame, sighting)
        if background is not None and background is not self._sent_background and (
                _has_listener(self._background)):
            self._background.publish(png_message(header, background))
            self._sent_background = background

    def _publish_frame(self, header: Header, frame: np.ndarray, sighting: Sighting) -> None:
        if _has_listener(self._frame):
            self._frame.publish(jpeg_message(header, frame))
            self._last_at = time.monotonic()
        if _has_listener(self._mask):
            self._mask.publish(png_message(header, object_mask(frame, sighting.objects)))
            self._last_at = time.monotonic()


def _has_listener(publisher: Publisher) -> bool:
    return publisher.get_subscription_count() > 0


class DebugImages:
    """
    Publishes the annotated frame, and the mask of the objects.

    Nothing is drawn or encoded for a topic without subscribers. The topics are reliable, so that
    reliable and best-effort subscribers match. Depth 1 drops old pictures.

    :param node: The node that publishes.
    """

    def __init__(self, node: Node) -> None:
        def publisher(message_type: type, topic: str) -> Publisher:
            return node.create_publisher(
                message_type, topic, QoSProfile(depth=1),
                qos_overriding_options=QoSOverridingOptions.with_default_policies())

        self._image = publisher(Image, 'debug_image')
        self._jpeg = publisher(CompressedImage, 'debug_image/compressed')
        self._mask = publisher(Image, 'mask')

    def publish(
        self, header: Header, frame: np.ndarray, sighting: Sighting, note: str, label: Label,
        areas: Optional[AreaOverlay] = None, uncertainty: Optional[FrameUncertainty] = None,
    ) -> None:
        """
        Publish the pictures that have subscribers.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param sighting: The objects that were found on it.
        :param note: Text for the corner: the background's age, or why nothing is published.
        :param label: Formats a position as text.
        :param areas: The areas in which objects count; None to draw none.
        :param uncertainty: Of the positions; None to draw no ellipses.
        """
        if _has_listener(self._image) or _has_listener(self._jpeg):
            picture = draw_left_out(frame, sighting.left_out)
            picture = draw_objects(picture, sighting.objects, label)
            if uncertainty is not None:
                draw_ellipses(picture, [(found.detection.centre, uncertainty.in_picture(found))
                                        for found in sighting.objects])
            if areas is not None:
                areas.draw(picture)
            draw_note(picture, note)
            _publish(self._image, lambda: image_message(header, picture))
            _publish(self._jpeg, lambda: jpeg_message(header, picture))
        _publish(self._mask, lambda: image_message(
            header, object_mask(frame, sighting.objects)))


def _publish(publisher: Publisher, make_message: Callable[[], object]) -> None:
    if _has_listener(publisher):
        publisher.publish(make_message())


def image_message(header: Header, picture: np.ndarray) -> Image:
    """
    Make an image message.

    :param picture: Shape (h, w, 3), BGR, or (h, w); uint8.
    """
    height, width = picture.shape[:2]
    colour = picture.ndim == 3
    # rclpy copies any other type than array.array byte by byte, which is slow.
    return Image(header=header, height=height, width=width,
                 encoding='bgr8' if colour else 'mono8',
                 step=width * (3 if colour else 1), data=array('B', picture.tobytes()))


def jpeg_message(header: Header, picture: np.ndarray) -> CompressedImage:
    """
    Make a message with a JPEG picture, of OpenCV's usual quality of 95.

    :param picture: Shape (h, w, 3), uint8, BGR.
    """
    jpeg = cv2.imencode('.jpg', picture)[1].tobytes()
    return CompressedImage(header=header, format='jpeg', data=array('B', jpeg))


def png_message(header: Header, picture: np.ndarray) -> CompressedImage:
    """
    Make a message with a PNG picture, which loses nothing.

    :param picture: Shape (h, w, 3), BGR, or (h, w); uint8.
    """
    png = cv2.imencode('.png', picture, [cv2.IMWRITE_PNG_COMPRESSION, 1])[1].tobytes()
    return CompressedImage(header=header, format='png', data=array('B', png))
