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


"""Formats a calibration's report as text: for the terminal, a parameter file, and the picture."""

from typing import Any, Dict, Iterator, List, Mapping

Report = Dict[str, Any]


def report_lines(report: Mapping[str, Any], with_map: bool = False) -> List[str]:
    """
    Write a report as lines.

    :param report: What `calibrate --json` prints.
    :param with_map: Whether to write the expected errors all over the picture, too.
    """
    return [*_model_lines(report), *figure_lines(report),
            *(_map_lines(report) if with_map else ()), *_verdict_lines(report),
            *(f'warning: {text}' for text in report['warnings'])]


def figure_lines(report: Mapping[str, Any]) -> List[str]:
    """Write the errors, and where they hold, as lines."""
    if 'points' not in report:
        return []
    lines = [f'error at {report["points"]} points: rms {report["rms_mm"]:.2f} mm, '
             f'mean {report["mean_mm"]:.2f} mm, '
             f'largest {report["max_mm"]:.2f} mm ({report["points_are"]} {report["worst_row"]})']
    if report.get('leave_one_out_rms_mm') is not None:
        lines[0] += f', each left out of the fit: rms {report["leave_one_out_rms_mm"]:.2f} mm'
    if 'coverage' in report:
        lines.append(f'the points cover {100 * report["coverage"]:.0f} % of the picture: outside '
                     'of them these figures do not hold')
    if report.get('not_covered'):
        lines += ['the ninths of the picture that the board covered (# covered, + in part):',
                  *(f'  {line}' for line in report['covered_map']),
                  f'not covered: {", ".join(report["not_covered"])}: lay the board there, too, if '
                  'you work there (several pictures, or --placements)']
    if report.get('outside_hull'):
        lines.append(f'{report["outside_hull"]} of the points lie outside the area that the '
                     'calibration was measured in')
    return lines


def _map_lines(report: Mapping[str, Any]) -> Iterator[str]:
    if 'error_map_mm' not in report:
        return
    frame = ('the base transform included' if report['error_map_has_base']
             else 'without the base transform')
    yield (f'95 % of the positions are expected within so many mm, over the picture ({frame}):')
    for row in report['error_map_mm']:
        yield '  ' + ' '.join(
            '-'.rjust(6) if error is None else f'{error:6.1f}' for error in row)


def _verdict_lines(report: Mapping[str, Any]) -> Iterator[str]:
    if 'verdict_sentence' in report:
        yield (f'{report["verdict_sentence"]} '
               f'({"" if report["error_map_has_base"] else "without "}the base transform'
               f'{" included" if report["error_map_has_base"] else ""})')


def _model_lines(report: Mapping[str, Any]) -> List[str]:
    return [line for part, write in _PARTS.items() if part in report for line in write(report)]


def _source(report: Mapping[str, Any]) -> Iterator[str]:
    yield f'{report["model"]} from {report["source"]}, {report["date"]}'


def _image_size(report: Mapping[str, Any]) -> Iterator[str]:
    yield 'for pictures of {} x {} px'.format(*report['image_size'])


def _lens(report: Mapping[str, Any]) -> Iterator[str]:
    if report['distortion_coefficient'] != 0:
        u, v = report['distortion_centre']
        yield (f'lens: radial coefficient {report["distortion_coefficient"]:.4f} about pixel '
               f'({u:.1f}, {v:.1f})')
    elif report['points'] < report['points_for_distortion']:
        yield (f'lens: taken as free of distortion; {report["points_for_distortion"]} points or '
               'more can tell it, with fewer it would follow their noise')
    else:
        yield 'lens: no distortion that would locate other points better'


def _tilt(report: Mapping[str, Any]) -> Iterator[str]:
    told = report['tilt_deg'] is not None
    yield (f'the camera looks at the surface at {report["tilt_deg"]:.1f} degrees from straight '
           'down' if told else "the camera's tilt cannot be told from these points")


def _camera(report: Mapping[str, Any]) -> Iterator[str]:
    yield (f'the camera is {report["camera_height_cm"]:.1f} cm above the surface, its foot point '
           'is at ({:.1f}, {:.1f}) cm'.format(*report['camera_foot_cm'])
           + f'; with these intrinsics the points are off by rms {report["pose_rms_px"]:.2f} px')


def _axes(report: Mapping[str, Any]) -> Iterator[str]:
    yield ('camera frame: origin at pixel ({:.1f}, {:.1f}), '.format(*report['origin_px'])
           + 'x towards pixel ({:.1f}, {:.1f}), '.format(*report['x_towards_px'])
           + 'y towards pixel ({:.1f}, {:.1f}), '.format(*report['y_towards_px'])
           + f'z {report["z_points"]}')


def _equations(report: Mapping[str, Any]) -> Iterator[str]:
    for equation, r_squared in zip(report['equations'], report['r_squared']):
        yield f'{equation}   (R^2 = {r_squared:.6f})'


def _sheet(report: Mapping[str, Any]) -> Iterator[str]:
    if 'marker_mm' in report:
        yield f'four markers of {report["marker_mm"]:g} mm, 0 to 3, on {report["paper"]}'
        return
    columns, rows = report['corners']
    yield (f'a chessboard of {columns} x {rows} inner corners, {report["square_mm"]:g} mm apart, '
           f'on {report["paper"]}')


def _status(report: Mapping[str, Any]) -> Iterator[str]:
    yield report['summary']
    yield from report['holds']
    yield from (f'not in the file: {part}' for part in report['lacks'])
    if 'offer' in report:
        yield f'running node: {report["offer"]}'


def _kept_correction(report: Mapping[str, Any]) -> Iterator[str]:
    yield f'kept: surface of {report["kept_correction"]}'


def _markers(report: Mapping[str, Any]) -> Iterator[str]:
    yield from (f'marker {number}: middle at ({x:.2f}, {y:.2f}) cm, edges of {edge_mm:.1f} mm'
                for number, x, y, edge_mm in report['markers'])


def _rotation(report: Mapping[str, Any]) -> Iterator[str]:
    yield ('camera frame in the base frame: rotated by roll {:.3f}, pitch {:.3f}, yaw {:.3f} '
           'degrees about the fixed axes'.format(*report['rotation_deg']))
    yield 'its origin there: ({:.3f}, {:.3f}, {:.3f}) cm'.format(*report['displacement_cm'])


_PARTS = {
    'source': _source,
    'image_size': _image_size,
    'distortion_coefficient': _lens,
    'equations': _equations,
    'tilt_deg': _tilt,
    'camera_height_cm': _camera,
    'origin_px': _axes,
    'rotation_deg': _rotation,
    'markers': _markers,
    'paper': _sheet,
    'status_of': _status,
    'kept_correction': _kept_correction,
}
