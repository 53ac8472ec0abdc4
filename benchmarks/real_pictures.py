# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Compares the default detector with simple rivals on pictures of real tables, labelled by eye.

    scripts/benchmark real_pictures --folder FOLDER [--set NAME] [--quick] [--json FILE]

FOLDER holds a clone of each repository that benchmarks/real/*.txt names. Without it, the commands
that fetch them are printed. What is cut off is left out of all results. A report is right within
half an object's radius of its label, merged where its outline has several labels in it, and
false otherwise. CPU time of one thread; the methods take turns on each frame.
"""

import argparse
import fnmatch
from itertools import islice
from pathlib import Path
import statistics
import sys
import time
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.detection import AbsoluteDifferenceDetector, PreciseDifferenceDetector
import cv2
import numpy as np
from rows import print_rows

LABELS = Path(__file__).parent / 'real'
_MOST_FRAMES = 60  # of a video, for its median
_RIVAL_LEVELS, _LEAST_AREA = 45, 30


class Label(NamedTuple):
    """
    One object by eye.

    :param place: u, v in px.
    :param radius: In px; half of it is the tolerance.
    :param may_miss: Whether it may be left out.
    """

    place: Tuple[float, float]
    radius: float
    may_miss: bool


class Scene(NamedTuple):
    """
    The labelled pictures of one repository, see the text files.

    :param frames: The frames' names, with the labels of each.
    """

    name: str
    repository: str
    commit: str
    background: str
    frames: Dict[str, List[Label]]

    @property
    def clone(self) -> str:
        """The name of the repository's clone: two owners may use one name."""
        return self.repository.replace('/', '_')


Method = Callable[[np.ndarray], List[np.ndarray]]


def read_scene(path: Path) -> Scene:
    """Read a text file of labels."""
    words: Dict[str, str] = {}
    frames: Dict[str, List[Label]] = {}
    for line in path.read_text(encoding='utf-8').splitlines():
        first, _, rest = line.partition(' ')
        if first == 'frame':
            frames[rest] = []
        elif first[:1].isdigit() or first == '?':
            u, v, radius = map(float, line.lstrip('? ').split())
            [*frames.values()][-1].append(Label((u, v), radius, first == '?'))
        elif first != '#':
            words[first] = rest
    return Scene(path.stem, words['repository'], words['commit'], words['background'], frames)


def compare(scene: Scene, folder: Path, repeats: int) -> Iterator[Dict[str, Any]]:
    """Compare all methods on a scene: a row for each."""
    root = folder / scene.clone
    background = read_background(root, scene.background)
    frames = {name: _picture(root, name) for name in scene.frames}
    methods = _methods(background)
    counts = {name: dict.fromkeys(('right', 'missed', 'merged', 'false'), 0) for name in methods}
    times: Dict[str, List[float]] = {name: [] for name in methods}
    for repeat in range(repeats):
        for name, frame in frames.items():
            for method, detect in methods.items():
                start = time.thread_time()
                outlines = detect(frame)
                times[method].append(time.thread_time() - start)
                if repeat == 0:
                    for kind, count in judge(outlines, scene.frames[name], frame).items():
                        counts[method][kind] += count
    usual = _percentiles(times['tutorial'])
    for method in methods:
        half, most = _percentiles(times[method])
        yield {'scene': scene.name, 'method': method, **counts[method],
               'p50_ms': round(1e3 * half, 2), 'p95_ms': round(1e3 * most, 2),
               'p50_ratio': round(half / usual[0], 1), 'p95_ratio': round(most / usual[0], 1)}


def judge(outlines: List[np.ndarray], labels: List[Label], frame: np.ndarray) -> Dict[str, int]:
    """
    Count what is right, missed, merged and false on a frame.

    :param outlines: One of each report, shape (n, 1, 2), int32.
    """
    found, counts = set(), {'right': 0, 'missed': 0, 'merged': 0, 'false': 0}
    height, width = frame.shape[:2]
    for outline in outlines:
        x, y, across, down = cv2.boundingRect(outline)
        if x <= 0 or y <= 0 or x + across >= width or y + down >= height:
            continue
        inside = [number for number, label in enumerate(labels)
                  if cv2.pointPolygonTest(outline, label.place, False) >= 0]
        near = [number for number, label in enumerate(labels)
                if np.hypot(*(_centre(outline) - label.place)) <= label.radius / 2]
        if len(inside) > 1:
            counts['merged'] += 1
        elif near and near[0] not in found:
            found.add(near[0])
            counts['right'] += not labels[near[0]].may_miss
        elif not any(labels[number].may_miss for number in inside):
            counts['false'] += 1
    required = sum(not label.may_miss for label in labels)
    counts['missed'] = required - counts['right']
    return counts


def _centre(outline: np.ndarray) -> np.ndarray:
    moments = cv2.moments(outline)
    if moments['m00'] == 0:
        return outline[:, 0].mean(axis=0)
    return np.array([moments['m10'], moments['m01']]) / moments['m00']


def _methods(background: np.ndarray) -> Dict[str, Method]:
    precise = PreciseDifferenceDetector(background)
    tutorial = AbsoluteDifferenceDetector(background, threshold=_RIVAL_LEVELS)

    def by_detector(detector: Any) -> Method:
        return lambda frame: [np.int32(one.outline)[:, None] for one in detector.detect(frame)]

    def largest_channel(frame: np.ndarray) -> List[np.ndarray]:
        away = cv2.inRange(cv2.absdiff(frame, background), 0, (_RIVAL_LEVELS,) * 3)
        return _outlines(cv2.bitwise_not(away))

    def otsu(frame: np.ndarray) -> List[np.ndarray]:
        grey = cv2.cvtColor(cv2.absdiff(frame, background), cv2.COLOR_BGR2GRAY)
        return _outlines(cv2.threshold(grey, 0, 1, cv2.THRESH_BINARY + cv2.THRESH_OTSU)[1])

    return {'precise': by_detector(precise), 'tutorial': by_detector(tutorial), 'otsu': otsu,
            'largest channel': largest_channel}


def _outlines(mask: np.ndarray) -> List[np.ndarray]:
    found, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    return [one for one in found if cv2.contourArea(one) >= _LEAST_AREA]


def _percentiles(times: List[float]) -> Tuple[float, float]:
    return statistics.median(times), float(np.percentile(times, 95))


def read_background(root: Path, name: str) -> np.ndarray:
    """Read a scene's background: a still picture, the median of several, or that of a video."""
    if Path(name).suffix in ('.mp4', '.avi'):
        count = sum(1 for _ in _grabbed(root / name))
        pictures = _frames(root / name, range(0, count, -(-count // _MOST_FRAMES)))
    else:
        folder = root / Path(name).parent
        pictures = [_read(path) for path in sorted(folder.iterdir())
                    if fnmatch.fnmatch(path.name, Path(name).name)]
    return np.median(pictures, axis=0).astype(np.uint8)


def _picture(root: Path, name: str) -> np.ndarray:
    path, _, number = name.rpartition(' ')
    return _frames(root / path, [int(number)])[0] if number.isdigit() else _read(root / name)


def _read(path: Path) -> np.ndarray:
    picture = cv2.imread(str(path))
    if picture is None:
        sys.exit(f'cannot read {path}: is the clone complete?')
    return picture


def _frames(path: Path, numbers: Sequence[int]) -> List[np.ndarray]:
    """Read some frames of a video, in order: a machine may not have room for all of them."""
    upto = islice(_grabbed(path), numbers[-1] + 1)
    return [video.retrieve()[1] for number, video in enumerate(upto) if number in numbers]


def _grabbed(path: Path) -> Iterator[cv2.VideoCapture]:
    video = cv2.VideoCapture(str(path))
    while video.grab():
        yield video


def _how_to_get(scenes: List[Scene], folder: str) -> str:
    lines = {f'git clone https://github.com/{one.repository} {folder}/{one.clone}'
             f'  # commit {one.commit}' for one in scenes}
    return '\n'.join(['The pictures are not part of this repository. Get them with',
                      *sorted(lines)])


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[1])
    parser.add_argument('--folder', help='where the clones are')
    parser.add_argument('--set', dest='name', help='only one of the files in benchmarks/real')
    parser.add_argument('--quick', action='store_true', help='each frame once')
    parser.add_argument('--json', help='file to write')
    options = parser.parse_args()
    scenes = [read_scene(path) for path in sorted(LABELS.glob('*.txt'))
              if options.name in (None, path.stem)]
    folder: Optional[str] = options.folder
    here = [scene for scene in scenes
            if folder and (Path(folder) / scene.clone).is_dir()]
    if len(here) < len(scenes):
        print(_how_to_get([one for one in scenes if one not in here], folder or 'FOLDER'))
    cv2.setNumThreads(1)
    print_rows((row for scene in here for row in compare(
        scene, Path(folder), 1 if options.quick else 5)), options.json)


if __name__ == '__main__':
    main()
