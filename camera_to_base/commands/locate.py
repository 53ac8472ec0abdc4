# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The command `locate`: finds objects on a recording, a camera or a bag, without ROS."""

import argparse
from contextlib import ExitStack
import csv
import itertools
import sys
from typing import Any, Iterator, List, Optional

from camera_to_base.calibration import next_step
from camera_to_base.commands.calibrate.options import CommandParser, drop_output
from camera_to_base.commands.positions import (
    COLUMNS, csv_cells, positions, SightingCounter, table_header, table_line)
from camera_to_base.drawing import (
    AnnotatedVideo, AreaOverlay, check_video_path, draw_ellipses, draw_note, draw_objects, Label,
    object_label)
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.files import Interrupt, refuse_existing, refuse_same_file, serve_signals
from camera_to_base.parameters import read_parameter_file
from camera_to_base.pipeline import DamageCheck, Sighting
from camera_to_base.settings import CameraSettings, NodeSettings, read_node_settings
from camera_to_base.shell_commands import full_command, with_full_commands
from camera_to_base.sources import (
    BAG, BagFile, kind_of, LiveRecording, open_frame_source, PlayedRecording, Recording,
    SIMULATED, TimedFrame)
from camera_to_base.uncertainty import uncertain_transform, UncertainTransform

DESCRIPTION = """
Finds objects on a recording, without ROS, and prints their positions in the camera frame and in
the robot's base frame. The two nodes publish the same positions with the same parameter file. The
first frame, or as many as background_frames says, must show the empty surface.

  locate last_night.mp4 --params-file cell.yaml
  locate last_night.mp4 --params-file cell.yaml --csv positions.csv --annotated seen.mp4
  locate rosbag2_2026_01_31/ --topic /camera/image_raw --every 10
  locate 0 --params-file cell.yaml                           a camera, until Ctrl-C

Do not control an arm with this command: a camera's frames wait in a queue while one is processed.
The nodes always take the newest frame."""

# The simulated objects repeat their path after this time.
_SIMULATED_S = 60


def parse(args: Optional[List[str]]) -> argparse.Namespace:
    """
    Parse the command line.

    :raises InvalidValueError: If an option has an invalid value, or an output file exists already.
    :raises SystemExit: With code 0 after --help, with 1 if an option is unknown or missing.
    """
    options = _parser().parse_args(args)
    if options.every < 1:
        raise InvalidValueError(f'--every must be 1 or more, got {options.every}')
    if options.topic and kind_of(options.source) != BAG:
        raise InvalidValueError(f"--topic is for a bag, got '{options.source}': leave it out")
    _check_files(options)
    return options


def _parser() -> argparse.ArgumentParser:
    parser = CommandParser(
        prog='locate', description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('source', metavar='SOURCE',
                        help='a video file; a rosbag2 bag (its folder, a .mcap or .db3 file; '
                             'needs the library rosbags); a device (0, /dev/video0) or a '
                             "stream's URL, until Ctrl-C; or simulated, for one minute")
    parser.add_argument('--params-file', metavar='FILE',
                        help="the nodes' parameters, as `calibrate` writes them and `ros2 run` "
                             'takes them (default: their defaults)')
    parser.add_argument('--namespace', metavar='NAME',
                        help="the nodes' namespace, if the file has parameters for several")
    parser.add_argument('--topic', metavar='NAME',
                        help="a bag's topic of sensor_msgs/Image or CompressedImage "
                             '(default: the only one)')
    parser.add_argument('--every', type=int, default=1, metavar='N',
                        help='use the first frame and every Nth after it (default: all)')
    parser.add_argument('--csv', metavar='OUT.csv', help='also write the table to this file')
    parser.add_argument('--annotated', metavar='OUT.mp4',
                        help='write a video of the frames with the objects drawn on them')
    parser.add_argument('--force', action='store_true', help='overwrite files')
    return parser


def _check_files(options: argparse.Namespace) -> None:
    outputs = [path for path in (options.csv, options.annotated) if path]
    refuse_same_file([options.source, options.params_file, *outputs])
    if options.annotated:
        check_video_path(options.annotated)
    if not options.force:
        refuse_existing(outputs)


def main(args: Optional[List[str]] = None) -> int:
    """Run the command; return its exit code."""
    try:
        serve_signals()
        options = parse(args)
        with Interrupt() as interrupt:
            return _run(options, interrupt)
    except CameraToBaseError as error:
        print(f'locate: {with_full_commands(str(error))}', file=sys.stderr)
        return 1
    except BrokenPipeError:
        drop_output()  # the reader has closed the pipe
        return 0
    except OSError as error:
        print(f'locate: cannot write any further: {error.strerror or error}', file=sys.stderr)
        drop_output()
        return 1
    except KeyboardInterrupt:
        return 130


def _run(options: argparse.Namespace, interrupt: Interrupt) -> int:
    settings = read_node_settings(options.params_file, options.namespace)
    for warning in settings.warnings:
        print(f'locate: {warning}', file=sys.stderr)
    recording = _open(options, settings.camera)
    try:
        frames = _frames(recording, options.every, interrupt)
        _locate(options, settings, recording, frames)
    finally:
        recording.release()
    return 130 if interrupt.came and recording.kind.ends else 0


def _open(options: argparse.Namespace, settings: CameraSettings) -> Recording:
    name, kind = options.source, kind_of(options.source)
    if kind == BAG:
        return BagFile(name, options.topic)
    if kind == SIMULATED:
        board = settings.simulated.board(settings.image_size)
        count = round(_SIMULATED_S * board.kind.frame_rate)
        return PlayedRecording(board, count, last=count)
    source = open_frame_source(name, settings.image_size)
    if kind.is_live:
        return LiveRecording(source)
    return PlayedRecording(source, source.frame_count)


def _frames(recording: Recording, every: int, interrupt: Interrupt) -> Iterator[TimedFrame]:
    """Iterate over every Nth frame until Ctrl-C, with a progress bar on a terminal."""
    from tqdm import tqdm

    count = recording.frame_count
    # A Ctrl-C between two used frames counts at once, not at the next one that is used.
    frames = itertools.islice(
        itertools.takewhile(lambda _: not interrupt.came, recording.frames()), 0, None, every)
    return iter(tqdm(frames, total=count and -(-count // every), unit='frame', leave=False,
                     disable=None))


def _locate(
    options: argparse.Namespace, settings: NodeSettings, recording: Recording,
    frames: Iterator[TimedFrame],
) -> None:
    counter, beyond_reach = SightingCounter(
        settings.camera, recording.kind, options.source,
        DamageCheck() if recording.kind.is_live else None), 0
    transform = uncertain_transform(settings.transform)
    with ExitStack() as files:
        rows = _csv_writer(files, options.csv) if options.csv else None
        video, areas = None, AreaOverlay(settings.camera.surface, settings.camera.detector.areas)
        if options.annotated:
            video = AnnotatedVideo(options.annotated, recording.kind.frame_rate / options.every)
            files.callback(video.release)
        _say(table_header(), rows, [column.name for column in COLUMNS])
        label = object_label(settings.camera.label_conversion)
        for timed in frames:
            sighting = counter.see(timed)
            beyond_reach += _tell(timed, sighting, transform, counter, rows)
            if video is not None:
                _annotate(video, timed, sighting, label, areas, counter)
    counter.check_any_used()
    print(with_full_commands('\n'.join(counter.summary())), file=sys.stderr)
    if beyond_reach:
        print(f'objects beyond reach_cm, without a place in the base frame: {beyond_reach}',
              file=sys.stderr)
    for name in filter(None, (options.csv, options.annotated)):
        print(f'file: {name}', file=sys.stderr)
    step = _next_command(options.params_file)
    if step:
        print(f'next: {step}', file=sys.stderr)


def _next_command(path: Optional[str]) -> Optional[str]:
    """Return the command that gives a cell what it lacks; None if it lacks nothing."""
    try:
        values = {} if path is None else read_parameter_file(path).values
    except InvalidValueError:
        return None  # parameters for single nodes: a cell that was made by hand
    step = next_step(path or 'cell.yaml', values)
    return full_command('calibrate', *step.arguments) if step.arguments else None


def _csv_writer(files: ExitStack, path: str) -> Any:
    try:
        file = files.enter_context(open(path, 'w', encoding='utf-8', newline=''))
    except OSError as error:
        raise InvalidValueError(f"cannot write '{path}': {error.strerror}") from error
    return csv.writer(file, lineterminator='\n')


def _tell(
    timed: TimedFrame, sighting: Sighting, transform: UncertainTransform,
    counter: SightingCounter, rows: Any,
) -> int:
    """Write the table's lines for a frame; return the number of objects beyond reach."""
    if sighting.reason is not None:
        return 0
    uncertainty = counter.uncertainty(timed.frame)
    found = list(positions(timed, sighting.objects, transform, uncertainty.of,
                           counter.surface))
    for position in found:
        _say(table_line(position), rows, csv_cells(position))
    return sum(position.base is None for position in found)


def _say(line: str, rows: Any, cells: List[str]) -> None:
    """Print a line, and write its CSV row; `rows` is a `csv.writer`, or None."""
    from tqdm import tqdm

    if rows is not None:
        rows.writerow(cells)
    tqdm.write(line)  # clears and redraws the progress bar
    sys.stdout.flush()


def _annotate(
    video: AnnotatedVideo, timed: TimedFrame, sighting: Sighting, label: Label,
    areas: AreaOverlay, counter: SightingCounter,
) -> None:
    try:
        picture = draw_objects(timed.frame, sighting.objects, label)
        uncertainty = counter.uncertainty(timed.frame)
        draw_ellipses(picture, [(found.detection.centre, uncertainty.in_picture(found))
                                for found in sighting.objects])
        areas.draw(picture)
    except CameraToBaseError:
        return  # the frame cannot be decoded
    reason = '' if sighting.reason is None else f', {sighting.reason.sentence}'
    draw_note(picture, f'frame {timed.number}, {timed.stamp_ns / 1e9:.3f} s{reason}')
    video.add(picture)


if __name__ == '__main__':
    sys.exit(main())
