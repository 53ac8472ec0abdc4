# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Reports the state of a camera node in the log and the diagnostics, with its numbers."""

import time
from typing import Callable, Dict, Optional, Sequence

from camera_to_base.detection import LocatedObject
from camera_to_base.errors import all_well, Level, Reason
from camera_to_base.nodes.feeds import Feed
from camera_to_base.pipeline import CameraPipeline, Correction, View
from camera_to_base.ros import Diagnostics, Health, Heartbeat, NameCheck
from camera_to_base.shell_commands import with_full_commands
from camera_to_base.sources import ReaderStatus
from rclpy.node import Node

_PERIOD_S = 0.2
# Objects look solid in so many looks before that is told, and what moves through the picture does
# not for so long; by a look in which they do not, the count falls by so many.
_SOLID_LOOKS, _FLAT_LOOK = 10, 3
# Whoever listens to these measures the heights: camera_fusion.
_SILHOUETTES = 'objects_in_robot_base_frame/silhouettes'
_ALL_WELL = all_well('objects on the surface are published')
_NOT_CALIBRATED = Reason(
    'not_calibrated', Level.WARN,
    "the surface is not calibrated: positions are those that the tutorial's camera would have, "
    'whose picture is 36 cm wide; run calibrate, and start the node with the file that it writes')


class DetectionRate:
    """Rates of processed frames and of frames with an object, between two calls."""

    def __init__(self) -> None:
        self._looked_at, self._frames, self._with_object = time.monotonic(), 0, 0

    def values(self, pipeline: CameraPipeline) -> Dict[str, str]:
        """Return both rates since the last call, as text for the diagnostics."""
        now, counts = time.monotonic(), pipeline.counts
        seconds = max(now - self._looked_at, 1e-3)
        frames, with_object = counts['frames'], counts['frames with an object']
        values = {'detection rate (frames/s)': f'{(frames - self._frames) / seconds:.1f}',
                  'frames with an object (1/s)':
                      f'{(with_object - self._with_object) / seconds:.1f}'}
        self._looked_at, self._frames, self._with_object = now, frames, with_object
        return values


def solid_doubt(objects: Sequence[LocatedObject]) -> Optional[Reason]:
    """Tell that objects count as flat and look solid; None for few."""
    sides = [found.sides for found in objects if found.sides is not None]
    # A flat one that points to the camera looks so by chance.
    if not sides or 2 * len(sides) < len(objects):
        return None
    lowest, highest = (f'{end(one.height_cm for one in sides):.1f}' for end in (min, max))
    height = lowest if lowest == highest else f'{lowest} to {highest}'
    return Reason('looks_solid', Level.WARN, (
        f'{len(sides)} of {len(objects)} objects {"looks" if len(sides) == 1 else "look"} solid, '
        f'about {height} cm high, and object_height_cm is 0: positions are off by up to '
        f'{max(one.off_cm for one in sides):.1f} cm, and the ellipses are as wide; set '
        'object_height_cm, or object_heights_cm to several heights, with 0.1 for flat objects'),
        is_passing=True)


def blind_spot(view: Optional[View]) -> Optional[str]:
    """Tell which movements of the camera cannot be noticed, a sentence; None for none."""
    if _has_no_structure(view):
        return ('the view cannot be checked: the surface has no structure, so that nobody would '
                'notice a nudge; put marks into its corners')
    if view is not None and not view.tells_all:
        return ('some movements of the camera cannot be noticed: the surface shows little but '
                'straight lines, and none of them tells a movement along it; put marks into its '
                'corners')
    return None


def _has_no_structure(view: Optional[View]) -> bool:
    return view is not None and view.shift_px is None and not view.has_structure


def _shift_text(view: Optional[View]) -> str:
    if view is None:
        return 'not checked'
    if _has_no_structure(view):
        return 'cannot be checked, the surface has no structure'
    text = 'cannot be told' if view.shift_px is None else f'{view.shift_px:.1f}'
    return text if view.tells_all else f'{text}, without movements along the lines of the surface'


def _correction_text(correction: Optional[Correction]) -> str:
    if correction is None:
        return 'not corrected'
    return (f'{correction.shift_px:.1f} px, {correction.shift_mm:.1f} mm, to about '
            f'{correction.error_mm:.2f} mm')


def camera_values(reader: Optional[ReaderStatus], pipeline: CameraPipeline) -> Dict[str, str]:
    """Return all numbers about a camera, as text for the diagnostics."""
    values = {'background': _background_text(pipeline),
              'view shift (px)': _shift_text(pipeline.view),
              'view corrected by': _correction_text(pipeline.standpoint.correction)}
    values.update((name, str(number)) for name, number in sorted(pipeline.counts.items()))
    if reader is not None:
        status = reader.snapshot()
        counts = status.counts
        values.update({
            'state': status.state.value,
            'frames read': str(counts.read),
            'frames dropped: replaced by a newer one': str(counts.overwritten),
            'frames dropped: too old on arrival': str(counts.old),
            'frames dropped: damaged': str(counts.damaged),
            'reconnects': str(counts.reconnects),
            'attempts to open': str(counts.attempts),
            'age of the last frame (s)': f'{status.seconds_without_frame:.2f}'})
    return values


def _background_text(pipeline: CameraPipeline) -> str:
    if pipeline.background is None:
        return 'none'
    origin = 'from the file, ' if pipeline.backgrounds.current.is_restored else ''
    return '{1} x {0} px, '.format(*pipeline.background.shape) + (
        f'{origin}taken {pipeline.backgrounds.current.age_s:.0f} s ago')


class CameraWatch:
    """
    Logs changes of state, and publishes the state on /diagnostics.

    :param node: The camera node.
    :param pipeline: Its pipeline.
    :param is_calibrated: Returns whether the surface is calibrated for the camera in use.
    :param file_doubt: Returns why the background is not kept in its file, or None.
    """

    def __init__(
        self, node: Node, pipeline: CameraPipeline, is_calibrated: Callable[[], bool],
        file_doubt: Callable[[], Optional[Reason]] = lambda: None,
    ) -> None:
        self._logger = node.get_logger()
        self._camera_node = node.get_fully_qualified_name()
        self._pipeline = pipeline
        self._is_calibrated, self._file_doubt = is_calibrated, file_doubt
        self._told_doubt: Optional[str] = None
        self._reason: Optional[Reason] = None
        self._blind_spot: Optional[str] = None
        self._told_faintness = False
        self._solid_looks, self._told_solid = 0, False
        self._solid: Optional[Reason] = None
        self._is_fused = lambda: node.count_subscribers(
            node.resolve_topic_name(_SILHOUETTES)) > 0
        self._detection_rate = DetectionRate()
        self._feed: Optional[Feed] = None
        self._seen: Sequence[LocatedObject] = ()
        self._heartbeat = Heartbeat(node)
        self._diagnostics = Diagnostics(node, self._heartbeat, self._health)
        NameCheck(node, self._heartbeat)

    def start(self, feed: Feed) -> None:
        """Start to watch a feed."""
        self._feed = feed
        # A feed without a reader has logged its reason already.
        self._reason = feed.reason if feed.reader is None else None
        self._heartbeat.every(_PERIOD_S, self._watch)
        if not self._is_calibrated():
            self._logger.warning(_NOT_CALIBRATED.sentence)

    def note(self, objects: Sequence[LocatedObject]) -> None:
        """Take the objects of a frame."""
        self._seen = objects

    def _watch(self) -> None:
        reason = self._feed.reason or self._pipeline.reason
        before, self._reason = self._reason, reason and reason.told(self._with_commands)
        if _kind(self._reason) != _kind(before) or _level(self._reason) != _level(before):
            self._tell(self._reason)
            self._diagnostics.publish()
        self._tell_doubt(self._doubt())
        faintness = self._pipeline.faintness
        if faintness is not None and not self._told_faintness:
            self._told_faintness = True
            self._logger.info(faintness)
        self._note_solid()
        knew, self._blind_spot = self._blind_spot, blind_spot(self._pipeline.view)
        if self._blind_spot not in (None, knew):
            self._logger.info(self._blind_spot)

    def _tell_doubt(self, doubt: Optional[Reason]) -> None:
        if doubt is not None and doubt.kind != self._told_doubt:
            self._logger.warning(doubt.sentence)
            self._diagnostics.publish()
        self._told_doubt = _kind(doubt)

    def _note_solid(self) -> None:
        doubt = None if self._is_fused() else solid_doubt(self._seen)
        change = -_FLAT_LOOK if doubt is None else 1
        self._solid_looks = min(max(self._solid_looks + change, 0), _SOLID_LOOKS)
        if self._solid_looks == 0:
            self._solid = None
        elif self._solid_looks == _SOLID_LOOKS:
            self._solid = doubt
        if self._solid is not None and not self._told_solid:
            self._told_solid = True
            self._logger.warning(self._solid.sentence)

    def _with_commands(self, sentence: str) -> str:
        return with_full_commands(sentence, self._camera_node)

    def _tell(self, reason: Optional[Reason]) -> None:
        # Separate lines: rclpy refuses to log with another severity from the same line.
        if reason is None:
            self._logger.info('ready: objects on the surface are published')
        elif reason.level is Level.ERROR:
            self._logger.error(reason.sentence)
        elif reason.kind == 'view_moved':
            self._logger.warning(reason.sentence)
        else:
            self._logger.info(reason.sentence)

    def _health(self) -> Health:
        values = {'source': self._feed.name,
                  **camera_values(self._feed.reader, self._pipeline),
                  **self._detection_rate.values(self._pipeline)}
        well = _ALL_WELL if self._is_calibrated() else _NOT_CALIBRATED
        return Health(
            self._reason or self._doubt() or self._file_doubt() or self._solid or well,
            values)

    def _doubt(self) -> Optional[Reason]:
        doubt = self._pipeline.doubt
        return doubt and doubt.told(self._with_commands)


def _kind(reason: Optional[Reason]) -> Optional[str]:
    return None if reason is None else reason.kind


def _level(reason: Optional[Reason]) -> Level:
    return Level.OK if reason is None else reason.level
