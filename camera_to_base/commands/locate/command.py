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

"""The command `locate`: finds objects on a recording, a camera or a bag, without ROS."""

import argparse
from contextlib import ExitStack
import csv
import itertools
import sys
from typing import Any, Iterator, List, Optional

from camera_to_base.calibration import next_step
from camera_to_base.commands.locate.options import parse
from camera_to_base.commands.locate.position_table import (
    COLUMNS, csv_cells, positions, table_header, table_line)
from camera_to_base.commands.locate.sighting_counter import SightingCounter
from camera_to_base.commands.output import drop_output
from camera_to_base.drawing import AnnotatedVideo, draw_ellipses, draw_note, draw_objects
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.interrupt import Interrupt, serve_signals
from camera_to_base.parameters import read_parameter_file
from camera_to_base.settings import CameraSettings, NodeSettings, read_node_settings
from camera_to_base.shell_commands import full_command, with_full_commands
from camera_to_base.sources import (
    BAG, BagFile, kind_of, LiveRecording, open_frame_source, PlayedRecording, Recording,
    SIMULATED, TimedFrame)
from camera_to_base.trust import DamageCheck, Sighting
from camera_to_base.uncertainty import uncertain_transform, UncertainTransform

# The simulated objects repeat their path after this time.
_SIMULATED_S = 60


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
        video = None
        if options.annotated:
            video = AnnotatedVideo(options.annotated, recording.kind.frame_rate / options.every)
            files.callback(video.release)
        _say(table_header(), rows, [column.name for column in COLUMNS])
        for timed in frames:
            sighting = counter.see(timed)
            beyond_reach += _tell(timed, sighting, transform, counter, rows)
            if video is not None:
                _annotate(video, timed, sighting, settings.camera, counter)
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
    found = list(positions(timed, sighting.objects, transform, uncertainty.of))
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
    video: AnnotatedVideo, timed: TimedFrame, sighting: Sighting, settings: CameraSettings,
    counter: SightingCounter,
) -> None:
    try:
        picture = draw_objects(timed.frame, sighting.objects, settings.debug_label)
        uncertainty = counter.uncertainty(timed.frame)
        draw_ellipses(picture, [(found.detection.centre, uncertainty.in_picture(found))
                                for found in sighting.objects])
        settings.area_overlay.draw(picture)
    except CameraToBaseError:
        return  # the frame cannot be decoded
    reason = '' if sighting.reason is None else f', {sighting.reason.sentence}'
    draw_note(picture, f'frame {timed.number}, {timed.stamp_ns / 1e9:.3f} s{reason}')
    video.add(picture)


if __name__ == '__main__':
    sys.exit(main())
