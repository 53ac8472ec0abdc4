# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Measures a frame's whole way in the camera node, stage by stage, relative to the tutorial's calls.

    scripts/benchmark whole_way [--quick] [--json FILE]

One thread, CPU time, medians. The frames take turns: one goes through the tutorial's OpenCV calls,
the next one the whole way; then the same again with each stage timed. A textured table has a
strong grain. `cameras` is how many cameras of that size one core can serve at 30 frames a second,
without the time to receive and decode a frame. `goal` says whether a row with one coin meets its
ratio; `rest` is what the stages leave of the whole. All of it takes less than three minutes, on a
machine without other work.
"""

import argparse
import json
import sys
import time
from typing import Any, Callable, Dict, List, Sequence, Tuple, Union

from camera_to_base.detection import Detection, DetectorSettings, ObjectLocator
from camera_to_base.pipeline import (
    ArmCheck, CameraPipeline, DamageCheck, FrameRecord, Limits, PositionGate, Standpoint,
    ViewWatch)
from camera_to_base.sources import DEVICE
from camera_to_base.surface import HomographySurface
import cv2
from detection_accuracy import versions
from methods import METHODS
import numpy as np

SIZES = (640, 480), (1280, 720), (1920, 1080), (3840, 2160)
TABLES = 'plain', 'textured'
SCENES = {'empty': 0, 'one coin': 1, 'four coins': 4}
# More than a core's cache holds; and more frames than the damage check remembers.
_FRAMES_BYTES, _LEAST_FRAMES = 64e6, 18
_COINS = (0.4, 0.55), (0.15, 0.2), (0.85, 0.3), (0.6, 0.85)
_RATE_HZ = 30
# The ratio that one coin must reach, by the picture's width.
_GOALS = {640: 1.0, 1920: 1.6}


def table(size: Tuple[int, int], is_textured: bool) -> np.ndarray:
    """Draw a light table, with a strong grain if it is textured; shape (h, w, 3), float32."""
    width, height = size
    picture = np.full((height, width, 3), (150, 165, 175), np.float32)
    if is_textured:
        random = np.random.default_rng(3)
        scale = width / 640
        for strength, length in (10, (25, 2)), (6, (80, 12)):
            field = random.standard_normal((height, width), dtype=np.float32)
            field = cv2.GaussianBlur(field, (0, 0), length[0] * scale, sigmaY=length[1] * scale)
            picture += (strength / field.std() * field)[..., None]
    return picture


def make_frames(
    picture: np.ndarray, coin_count: int, count: int, noise: float = 1.5
) -> List[np.ndarray]:
    """Take frames of a table with some coins, of which the first one moves slowly to and fro."""
    height, width = picture.shape[:2]
    random = np.random.default_rng(1)
    frames = []
    for number in range(count):
        seen = picture.copy()
        for index, (u, v) in enumerate(_COINS[:coin_count]):
            drift = 0.0 if index else 0.004 * abs(number % 20 - 10)
            centre = int((u + drift) * width * 16), int(v * height * 16)
            cv2.circle(seen, centre, int(0.0336 * width * 16), (52, 60, 70), -1, cv2.LINE_AA, 4)
        seen += noise * random.standard_normal(seen.shape, dtype=np.float32)
        frames.append(np.clip(np.rint(seen), 0, 255).astype(np.uint8))
    return frames


class TimedDetector:
    """A detector that notes what it takes."""

    def __init__(self, detector: Any, seconds: List[float]) -> None:
        self._detector, self._seconds = detector, seconds

    def __getattr__(self, name: str) -> Any:
        """Give everything else as the detector does."""
        return getattr(self._detector, name)

    def detect(self, frame: np.ndarray) -> List[Detection]:
        """Find the objects on a frame."""
        begin = time.thread_time()
        found = self._detector.detect(frame)
        self._seconds.append(time.thread_time() - begin)
        return found


class TimedSettings(DetectorSettings):
    """Settings of a timed detector; `seconds` is what its detections take."""

    def detector(self, background: np.ndarray) -> TimedDetector:
        """Make the detector."""
        self.seconds: List[float] = []
        return TimedDetector(super().detector(background), self.seconds)


class Parts:
    """
    The parts of the pipeline, each timed on its own.

    :param background: Shape (h, w, 3), uint8, BGR.
    """

    def __init__(self, background: np.ndarray) -> None:
        settings = TimedSettings()
        self.seconds: Dict[str, List[float]] = {}
        self._damage = DamageCheck()
        self._view = ViewWatch(background, Limits(), background)
        self._locator = ObjectLocator(background, surface_of(background), settings)
        self.seconds['detection'] = settings.seconds
        self._standpoint = Standpoint.as_calibrated(surface_of(background))
        self._arms = ArmCheck(background)
        self._gate = PositionGate(Limits().max_frame_age_s, Limits().confirm_jump_px)

    def process(self, frame: np.ndarray) -> None:
        """Take a frame the whole way, and note what each stage takes."""
        self._timed('damage', self._damage.reason, frame)
        self._timed('view', self._view.reason, frame)
        found = self._timed('detection and location', self._locator.find, frame)
        now = time.monotonic()
        record = self._timed('arms', self._arms.judge, FrameRecord(
            frame, self._standpoint, now, now, aligned=frame, objects=found.objects,
            left_out=found.left_out))
        self._timed('gate', self._gate.judge, record)

    def medians_ms(self) -> Dict[str, float]:
        """Give the median of each stage, in ms."""
        medians = {name: 1e3 * float(np.median(values)) for name, values in self.seconds.items()}
        medians['location'] = medians.pop('detection and location') - medians['detection']
        return medians

    def _timed(self, name: str, stage: Callable, *arguments) -> Any:
        begin = time.thread_time()
        result = stage(*arguments)
        self.seconds.setdefault(name, []).append(time.thread_time() - begin)
        return result


def surface_of(background: np.ndarray) -> HomographySurface:
    """Make the surface of a camera that looks straight down."""
    height, width = background.shape[:2]
    return HomographySurface(np.diag([36 / width, 36 / width, 1]), (width, height))


class Whole:
    """The node's whole way of a frame: the damage check and the pipeline."""

    def __init__(self, background: np.ndarray) -> None:
        self._damage = DamageCheck()
        self._pipeline = CameraPipeline(surface_of(background), kind=DEVICE)
        self._pipeline.restore_background(background, 0.0)

    def process(self, frame: np.ndarray) -> None:
        """Take a frame the whole way."""
        if self._damage.reason(frame) is None:
            self._pipeline.process(frame)


def measure(size: Tuple[int, int], is_textured: bool, scene: str, turns: int) -> dict:
    """Measure a scene; return the row of the table."""
    picture = table(size, is_textured)
    count = int(min(max(_FRAMES_BYTES / picture.size, _LEAST_FRAMES), 40))
    background = make_frames(picture, 0, 1)[0]
    frames = make_frames(picture, SCENES[scene], count)
    tutorial, whole, parts = METHODS['tutorial'](background), Whole(background), Parts(background)
    reference_s, whole_s = _medians(frames, turns, tutorial.detect, whole.process)
    _medians(frames, turns, tutorial.detect, parts.process)
    stages = parts.medians_ms()
    return {'width': size[0], 'height': size[1], 'table': TABLES[is_textured], 'scene': scene,
            'tutorial_ms': 1e3 * reference_s, 'whole_ms': 1e3 * whole_s,
            'ratio': reference_s / whole_s, 'cameras': 1 / (_RATE_HZ * whole_s),
            'goal': _goal_text(size[0], scene, reference_s / whole_s),
            **{f'{name}_ms': value for name, value in stages.items()},
            'rest_ms': 1e3 * whole_s - sum(stages.values())}


def _medians(frames: Sequence[np.ndarray], turns: int, *ways: Callable) -> List[float]:
    # In s. Only ways that take turns with the tutorial's calls: each way makes the caches cold.
    seconds: List[List[float]] = [[] for _ in ways]
    for turn in range(turns):
        for index, way in enumerate(ways):
            frame = frames[(turn + index * len(frames) // 2) % len(frames)]
            begin = time.thread_time()
            way(frame)
            seconds[index].append(time.thread_time() - begin)
    return [float(np.median(values)) for values in seconds]


def _goal_text(width: int, scene: str, ratio: float) -> str:
    goal = _GOALS.get(width)
    if goal is None or scene != 'one coin':
        return '-'
    return f'{goal:g} {"met" if ratio >= goal else "missed"}'


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--quick', action='store_true', help='few turns, for its exit code')
    parser.add_argument('--json', metavar='FILE', help='write the rows as a list of objects')
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    print(f'{versions()}, one thread, CPU time in ms')
    rows: List[dict] = []
    for size in SIZES[:1] if arguments.quick else SIZES:
        turns = 4 if arguments.quick else max(24, int(150 * 640 * 480 / (size[0] * size[1])))
        for is_textured in (False, True):
            for scene in SCENES:
                rows.append(measure(size, is_textured, scene, turns))
                if len(rows) == 1:
                    print('  '.join(f'{name.removesuffix("_ms"):>10}' for name in rows[0]))
                print('  '.join(f'{_text(value):>10}' for value in rows[-1].values()), flush=True)
    if arguments.json:
        with open(arguments.json, 'w', encoding='utf-8') as file:
            json.dump(rows, file, indent=1)


def _text(value: Union[str, int, float]) -> str:
    return f'{value:.2f}' if isinstance(value, float) else str(value)


if __name__ == '__main__':
    sys.exit(main())
