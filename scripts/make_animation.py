# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Makes README's animated picture, see make_animation: a simulated cell that runs; it needs no ROS.

On the left is the camera's picture as `debug_image` shows it, on the right the base frame with the
positions that would be published. A hand reaches in, and the camera is bumped.
"""

import argparse
import math
from pathlib import Path
import re
import sys
import time
from typing import Iterator, List, NamedTuple, Optional, Sequence

from camera_to_base.coordinate_transform import (
    CameraToRobotBaseConversion, TUTORIAL_DISPLACEMENT_CM, TUTORIAL_ROTATION_DEG,
    TUTORIAL_WIDTH_CM)
from camera_to_base.detection import LocatedObject, Point
from camera_to_base.drawing import draw_left_out, draw_objects, object_label
from camera_to_base.pipeline import CameraPipeline
from camera_to_base.simulation import CameraMove, SimulatedBoard, SimulatedScene
from camera_to_base.simulation.specs import WOOD
from camera_to_base.sources import DEVICE
from camera_to_base.surface import HomographySurface
import cv2
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
import numpy as np
from PIL import Image

PICTURE = Path(__file__).resolve().parents[1] / 'docs' / 'simulated_cell.gif'
SIZE = 640, 480
BASE = CameraToRobotBaseConversion(TUTORIAL_ROTATION_DEG[0], *TUTORIAL_DISPLACEMENT_CM)
CM_PER_PX = TUTORIAL_WIDTH_CM / SIZE[0]
# The table lives faster than the animation is played, so that there is something to see.
FRAMES, FRAMES_PER_S, TABLE_S_PER_FRAME = 110, 10.0, 0.2
BUMP_AT, BUMP = 80, CameraMove((9.0, -6.0), 0.7)
LENGTH_CM, ELONGATION = 4.4, 2.0
TRAIL_FRAMES, COLOURS = 20, 96
# What changes by less, in grey levels, is noise: leaving it out makes the file small.
NOISE_LEVELS = 16
SILENT, OBJECT, TRAIL = 'firebrick', 'tab:orange', 'tab:blue'


class Shot(NamedTuple):
    """
    One frame of the cell.

    :param picture: Shape (h, w, 3), uint8, BGR, with what was found drawn.
    :param objects: What would be published.
    :param largest_error_cm: Of their positions in the base frame; None without objects.
    :param state: What the node says.
    """

    picture: np.ndarray
    objects: Sequence[LocatedObject]
    largest_error_cm: Optional[float]
    state: str


def main(args: Optional[List[str]] = None) -> int:
    """Run the script; return its exit code."""
    parser = argparse.ArgumentParser(prog='make_animation', description=__doc__)
    parser.add_argument('-o', '--output', type=Path, default=PICTURE)
    parser.add_argument('--frames', type=int, default=FRAMES)
    arguments = parser.parse_args(args)
    panels = Panels(BASE)
    pictures = [panels.draw(shot) for shot in shots(arguments.frames, BASE)]
    write_animation(pictures, arguments.output)
    print(f'{arguments.output}: {len(pictures)} frames, '
          f'{arguments.output.stat().st_size / 1e6:.2f} MB')
    return 0


def shots(count: int, base: CameraToRobotBaseConversion) -> Iterator[Shot]:
    """Run the simulated camera through the package's own pipeline."""
    board = SimulatedBoard(
        image_size=SIZE, frame_rate=1 / TABLE_S_PER_FRAME, scene=SimulatedScene(table=WOOD),
        diameters_cm=[LENGTH_CM, 0.9 * LENGTH_CM, 0.8 * LENGTH_CM], elongation=ELONGATION,
        hands=3)
    surface = HomographySurface(board.surface_from_pixel, SIZE)
    pipeline, now = CameraPipeline(surface, kind=DEVICE), time.monotonic() + 3600
    # The first frames show the empty table: they are the background.
    empty = SimulatedScene(shows='empty', table=WOOD)
    board.arrange(empty)
    for _ in range(5):
        now += 1 / FRAMES_PER_S
        pipeline.process(board.read(), now)
    for number in range(count):
        board.arrange(SimulatedScene(table=WOOD, move=BUMP if number >= BUMP_AT else CameraMove()))
        now += 1 / FRAMES_PER_S
        frame = board.read()
        sighting = pipeline.process(frame, now)
        objects = [] if sighting.reason else sighting.objects
        picture = draw_left_out(draw_objects(frame, objects, object_label(base)),
                                sighting.left_out)
        truth = [np.array(true.point) for true in board.true_objects]
        errors = [min(math.dist(one.point, point) for point in truth) for one in objects]
        doubt = sighting.reason or pipeline.doubt
        yield Shot(picture, objects, max(errors, default=None),
                   'objects are published' if doubt is None else doubt.sentence)


class Panels:
    """
    Draws the camera's picture beside a map of the base frame.

    :param base: Converts positions from the camera frame to the base frame.
    """

    def __init__(self, base: CameraToRobotBaseConversion) -> None:
        self._base = base
        self._trails: List[List[Point]] = []
        self._shown: Optional[np.ndarray] = None
        self._figure = Figure(figsize=(8.2, 3.4), dpi=100)
        self._canvas = FigureCanvasAgg(self._figure)

    def draw(self, shot: Shot) -> Image.Image:
        """Draw one frame."""
        self._figure.clear()
        camera, table = self._figure.subplots(
            1, 2, gridspec_kw={'left': 0.01, 'right': 0.99, 'bottom': 0.13, 'top': 0.91,
                               'wspace': 0.1, 'width_ratios': (4, 3.9)})
        camera.imshow(cv2.cvtColor(self._without_noise(shot.picture), cv2.COLOR_BGR2RGB))
        camera.set_axis_off()
        camera.set_title('what the camera sees', fontsize=9)
        self._draw_map(table, shot)
        is_silent = not shot.objects
        state = re.split('[,;]', shot.state)[0]
        self._figure.text(0.01, 0.035, ('silent: ' if is_silent else '') + state, fontsize=9,
                          color=SILENT if is_silent else 'black')
        if shot.largest_error_cm is not None:
            self._figure.text(0.99, 0.035, f'largest error {10 * shot.largest_error_cm:.2f} mm',
                              fontsize=9, ha='right')
        self._canvas.draw()
        return Image.fromarray(np.asarray(self._canvas.buffer_rgba())[:, :, :3])

    def _without_noise(self, picture: np.ndarray) -> np.ndarray:
        small = cv2.resize(picture, (480, 360), interpolation=cv2.INTER_AREA)
        if self._shown is not None:
            changed = cv2.absdiff(small, self._shown).max(axis=2, keepdims=True) > NOISE_LEVELS
            small = np.where(changed, small, self._shown)
        self._shown = small
        return small

    def _draw_map(self, axes, shot: Shot) -> None:
        width, height = TUTORIAL_WIDTH_CM, CM_PER_PX * SIZE[1]
        corners = [self._place((x, y)) for x, y in (
            (0, 0), (width, 0), (width, height), (0, height), (0, 0))]
        axes.plot(*zip(*corners), color='0.7', lw=1)
        axes.plot(0, 0, marker='s', color='0.25', ms=9)
        axes.annotate('robot', (0, 0), (0.9, -0.2), fontsize=8, va='center')
        points = [self._place(one.point) for one in shot.objects]
        self._trails = [*self._trails[-TRAIL_FRAMES:], points]
        old = [point for trail in self._trails for point in trail]
        if old:
            axes.plot(*zip(*old), '.', color=TRAIL, alpha=0.25, ms=2)
        for number, (one, point) in enumerate(zip(shot.objects, points), start=1):
            self._draw_object(axes, number, one, point)
        axes.set(xlim=(-22.5, 23), ylim=(-4, 26), aspect='equal')
        axes.set_title('where the robot finds it: base frame, cm', fontsize=9)
        axes.tick_params(labelsize=7, length=2)

    def _draw_object(self, axes, number: int, one: LocatedObject, point: Point) -> None:
        # About x by half a turn: what turns from x towards y in the camera frame turns back here.
        angle = 0.0 if one.yaw is None else -math.degrees(one.yaw)
        width, length = sorted(cv2.minAreaRect(one.detection.outline)[1])
        axes.add_patch(Ellipse(point, CM_PER_PX * length, CM_PER_PX * width, angle=angle,
                               color=OBJECT, alpha=0.8))
        axes.annotate(f'{number}: {point[0]:.2f}, {point[1]:.2f}', point,
                      (point[0], point[1] - 2.6), fontsize=8, ha='center', va='center')

    def _place(self, point: Point) -> Point:
        x, y, _ = self._base.convert_point(*point)
        return x, y


def write_animation(pictures: Sequence[Image.Image], path: Path) -> None:
    """Write a GIF whose frames share one palette, so that what does not change costs nothing."""
    width, height = pictures[0].size
    tall = Image.new('RGB', (width, 3 * height))
    for row, picture in enumerate((pictures[0], pictures[len(pictures) // 2], pictures[-1])):
        tall.paste(picture, (0, row * height))
    # Colours of thin lines and of texts need a place of their own.
    for row, colour in enumerate((SILENT, OBJECT, TRAIL)):
        tall.paste(to_hex(colour), (0, row * height, width, row * height + 20))
    palette = tall.quantize(COLOURS)
    frames = [np.asarray(picture.quantize(palette=palette, dither=Image.Dither.NONE))
              for picture in pictures]
    # A pixel that has not changed is transparent: such pixels need hardly any space.
    changes = [np.where(after == before, COLOURS, after).astype(np.uint8)
               for before, after in zip(frames, frames[1:])]
    first, *others = [_with_palette(frame, palette) for frame in (frames[0], *changes)]
    first.save(path, save_all=True, append_images=others, duration=round(1000 / FRAMES_PER_S),
               loop=0, optimize=False, disposal=1, transparency=COLOURS)


def _with_palette(frame: np.ndarray, palette: Image.Image) -> Image.Image:
    picture = Image.frombytes('P', frame.shape[::-1], frame.tobytes())
    picture.putpalette([*palette.getpalette()[:3 * COLOURS], 0, 0, 0])
    picture.info['transparency'] = COLOURS
    return picture


if __name__ == '__main__':
    sys.exit(main())
