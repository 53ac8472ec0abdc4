# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Measures precision, recall and position error of each method.

    scripts/benchmark detection_accuracy [--quick] [--json FILE]

First on photometric pictures, see `photometric`, which share nothing with the detector; then on
difficult scenes of the simulated board. Precision and recall count every frame after the first,
which is the background. A detection is right within 5 px of a true object. An object that a hand
touches, or that exceeds the picture by less than a pixel, does not count in either way. On the
board, all methods but the tutorial's have the same limits: 0.5 to 20 cm², and not at the picture's
edge.
"""

import argparse
from dataclasses import asdict
import json
import platform
import sys
from typing import Dict, List, Optional

from camera_to_base.detection import Detection, object_on_surface
from camera_to_base.simulation import BoardConditions, SimulatedBoard, TrueObject
import cv2
from methods import METHODS
import numpy as np
from photometric import Conditions, Lamp, Photographer

SCENES = {
    'noise 2': BoardConditions(noise=2),
    'noise 5': BoardConditions(noise=5),
    'noise 10': BoardConditions(noise=10),
    'light drift -60': BoardConditions(light_drift=-60),
    'exposure x 0.75': BoardConditions(exposure_step=0.75),
    'soft shadow -35': BoardConditions(shadow=35),
    'hand passes twice': BoardConditions(hands=2),
    'contrast 70': BoardConditions(contrast=70),
    'small dark coin, 22 px': BoardConditions(diameters_cm=(1.24,)),
    'light coin, dark table': BoardConditions(table_level=50, contrast=-130),
    'coin with a highlight': BoardConditions(highlight=True),
    'two coins': BoardConditions(diameters_cm=(2.4, 1.8)),
    'textured table': BoardConditions(texture=12),
    'coin half out': BoardConditions(over_edge=True),
    'coin in the first frame': BoardConditions(in_first_frame=True),
    'coin that rests': BoardConditions(rests=True),
    'all at once': BoardConditions(noise=5, light_drift=-40, exposure_step=0.8, hands=2),
}
PHOTOMETRIC = {
    'plain': Conditions(),
    'noise': Conditions(electrons=900),
    'lens out of focus': Conditions(blur=2.0),
    'JPEG 50': Conditions(quality=50),
    'lamp flickers by 15 %': Conditions(flicker=0.15),
    'own shadow, small lamp': Conditions(thickness=12, lamp=Lamp(radius=5)),
    'own shadow, wide lamp': Conditions(thickness=12, lamp=Lamp(radius=250)),
    'own deep shadow': Conditions(thickness=16, lamp=Lamp(radius=20, share=0.7)),
    'light object and shadow': Conditions(colour=(0.8,), thickness=12, lamp=Lamp(radius=20)),
    'arm takes light': Conditions(shade=0.5),
    'orange': Conditions(colour=(0.06, 0.38, 0.75)),
    'faint': Conditions(colour=(0.34, 0.37, 0.4)),
    'striped object': Conditions(second_colour=(0.6,)),
    'glossy object': Conditions(gloss=1.5),
    'bar': Conditions(shape='bar', radius=15),
    'ring': Conditions(shape='ring'),
    'plus': Conditions(shape='plus'),
    'block': Conditions(shape='block', radius=22),
    '10 px small': Conditions(radius=5),
    'grain': Conditions(pattern='grain'),
    'red on a board': Conditions(pattern='board', colour=(0.05, 0.1, 0.6)),
    'light on a board': Conditions(pattern='board', colour=(0.95,), radius=20),
    'dark on a board': Conditions(pattern='board', colour=(0.03,), radius=20),
    'grain, camera trembles': Conditions(pattern='grain', tremble=1),
    'board, camera trembles': Conditions(pattern='board', colour=(0.05, 0.1, 0.6), tremble=1),
    'a lot at once': Conditions(pattern='grain', thickness=10, shade=0.35, flicker=0.1,
                                electrons=3000, quality=60),
}
_RIGHT_WITHIN_PX = 5.0
_AREA_CM2 = 0.5, 20.0


class Score:
    """Counts what a method got right on one scene."""

    def __init__(self) -> None:
        """Start with all counts at zero."""
        self.right = self.wrong = self.wanted = 0
        self.errors_px: List[float] = []
        self.disc_errors_px: List[float] = []
        self.point_errors_cm: List[float] = []
        self.corrected_errors_cm: List[float] = []

    def add(
        self, detections: List[Detection], truths: List[TrueObject], board: SimulatedBoard
    ) -> None:
        """Compare the detections on a frame with the truth."""
        left = list(detections)
        for truth in truths:
            optional = truth.hidden or -1.0 < truth.cut_off < 1.0
            absent = truth.cut_off >= 1.0
            self.wanted += not optional and not absent
            if not left:
                continue
            distances = [np.hypot(*np.subtract(d.centre, truth.pixel)) for d in left]
            nearest = int(np.argmin(distances))
            if optional and distances[nearest] < 2 * truth.radius:
                left.pop(nearest)
            elif not absent and distances[nearest] <= _RIGHT_WITHIN_PX:
                self._add_right(left.pop(nearest), distances[nearest], truth, board)
        self.wrong += len(left)

    def _add_right(
        self, detection: Detection, error: float, truth: TrueObject, board: SimulatedBoard
    ) -> None:
        self.right += 1
        self.errors_px.append(error)
        disc = project(board.pixel_from_surface, np.array([truth.point]))[0]
        self.disc_errors_px.append(np.hypot(*(detection.centre - disc)))
        point = project(board.surface_from_pixel, np.array([detection.centre]))[0]
        self.point_errors_cm.append(np.hypot(*(point - truth.point)))
        corrected = object_on_surface(
            lambda pixels: project(board.surface_from_pixel, pixels), detection).point
        self.corrected_errors_cm.append(np.hypot(*(corrected - truth.point)))

    def row(self) -> Dict[str, float]:
        """Return the sums; the error is empty if no detection was right."""
        said = self.right + self.wrong
        return {
            'precision': self.right / said if said else None,
            'recall': self.right / self.wanted if self.wanted else None,
            'mean_px': _mean(self.errors_px),
            'max_px': max(self.errors_px, default=None),
            'disc_mean_px': _mean(self.disc_errors_px),
            'point_mean_cm': _mean(self.point_errors_cm),
            'corrected_mean_cm': _mean(self.corrected_errors_cm),
        }


def project(matrix: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Map points of shape (n, 2) by a homography of shape (3, 3)."""
    scaled = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    return scaled[:, :2] / scaled[:, 2:]


def publishable(detection: Detection, board: SimulatedBoard) -> bool:
    """Return whether an object is complete, and its area on the surface within the limits."""
    outline = project(board.surface_from_pixel, detection.outline)
    area = cv2.contourArea(outline.astype(np.float32))
    return not detection.cut_off and _AREA_CM2[0] <= area <= _AREA_CM2[1]


def measure(scene: str, tilt_deg: float, methods: List[str], frames: int) -> List[dict]:
    """Run the methods over one round of a scene."""
    board = SimulatedBoard(
        tilt_deg=tilt_deg, frame_rate=frames / 60, seed=4, **asdict(SCENES[scene]))
    background = board.read()
    detectors = {name: METHODS[name](background) for name in methods}
    scores = {name: Score() for name in methods}
    for _ in range(frames):
        frame = board.read()
        for name, detector in detectors.items():
            detections = detector.detect(frame)
            if not name.startswith('tutorial'):
                detections = [d for d in detections if publishable(d, board)]
            scores[name].add(detections, board.true_objects, board)
    return [{'method': name, 'scene': scene, 'tilt_deg': tilt_deg, **score.row()}
            for name, score in scores.items()]


def measure_photometric(
    scene: str, methods: List[str], frames: int, seed: int = 4
) -> List[dict]:
    """Run the methods over photometric pictures of one kind, with one object on each."""
    camera = Photographer(PHOTOMETRIC[scene], seed)
    background = camera.background()
    detectors = {name: METHODS[name](background) for name in methods}
    scores: Dict[str, List[List[float]]] = {name: [] for name in methods}
    for _ in range(frames):
        frame, truth = camera.frame()
        for name, detector in detectors.items():
            scores[name].append([float(np.hypot(*np.subtract(found.centre, truth)))
                                 for found in detector.detect(frame) if not found.cut_off])
    return [{'method': name, 'scene': scene, 'tilt_deg': None, **_photometric_row(errors)}
            for name, errors in scores.items()]


def _photometric_row(errors: List[List[float]]) -> Dict[str, Optional[float]]:
    right = [min(one) for one in errors if one and min(one) <= _RIGHT_WITHIN_PX]
    said = sum(map(len, errors))
    return {'precision': len(right) / said if said else None, 'recall': len(right) / len(errors),
            'mean_px': _mean(right), 'max_px': max(right, default=None)}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--quick', action='store_true', help='few frames, for its exit code')
    parser.add_argument('--frames', type=int, default=240, help='for one round of a scene')
    parser.add_argument('--seed', type=int, default=4, help='of the photometric pictures')
    parser.add_argument('--scene', action='append', choices=SCENES, help='only this one')
    parser.add_argument('--method', action='append', choices=METHODS, help='only this one')
    parser.add_argument('--json', metavar='FILE', help='write the rows as a list of objects')
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    frames = 6 if arguments.quick else arguments.frames
    methods = arguments.method or ['tutorial', 'precise', 'MOG2', 'KNN']
    print(versions(), f'{frames} frames a scene, 640 x 480')
    print('precision / recall / mean error / largest error, px')
    rows: List[dict] = []

    def tell(scene: str, results: List[dict]) -> None:
        rows.extend(results)
        print(f'{scene:26}' + ''.join(f'{_text(row):30}' for row in results), flush=True)

    if arguments.scene is None:
        print(f'\n{"photometric":26}' + ''.join(f'{name:30}' for name in methods))
        for scene in PHOTOMETRIC:
            tell(scene, measure_photometric(scene, methods, min(frames, 100), arguments.seed))
    for tilt in (0.0, 40.0):
        print(f'\n{f"tilt {tilt:g}":26}' + ''.join(f'{name:30}' for name in methods))
        for scene in arguments.scene or list(SCENES)[:3 if arguments.quick else None]:
            tell(scene, measure(scene, tilt, methods, frames))
    _print_corrections(rows)
    if arguments.json:
        with open(arguments.json, 'w', encoding='utf-8') as file:
            json.dump(rows, file, indent=1)


def versions() -> str:
    """Return the versions and the machine of the measurement."""
    return (f'OpenCV {cv2.__version__}, numpy {np.__version__}, Python '
            f'{platform.python_version()}, {_processor()};')


def _print_corrections(rows: List[dict]) -> None:
    print('\nthe centre of the disc, mean over the scenes of method precise:')
    for tilt in (0.0, 40.0):
        chosen = [row for row in rows if row['method'] == 'precise' and row['tilt_deg'] == tilt
                  and row['mean_px'] is not None]
        if chosen:
            disc, point, corrected = (
                _mean([row[name] for row in chosen])
                for name in ('disc_mean_px', 'point_mean_cm', 'corrected_mean_cm'))
            print(f'  tilt {tilt:g}: {disc:.3f} px beside the projected centre of the disc; '
                  f'on the surface {10 * point:.4f} mm off, {10 * corrected:.4f} mm corrected')


def _processor() -> str:
    try:
        with open('/proc/cpuinfo', encoding='utf-8') as file:
            return next(line.split(':')[1].strip() for line in file if 'model name' in line)
    except (OSError, StopIteration):
        return platform.machine()


def _mean(values: List[float]) -> Optional[float]:
    return float(np.mean(values)) if values else None


def _text(row: Dict[str, float]) -> str:
    return ' / '.join('-' if row[name] is None else f'{row[name]:.{digits}f}'
                      for name, digits in (('precision', 2), ('recall', 2),
                                           ('mean_px', 3), ('max_px', 2)))


if __name__ == '__main__':
    sys.exit(main())
