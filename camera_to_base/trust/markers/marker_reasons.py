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
"""What the node says about markers."""

from typing import Tuple

from camera_to_base.markers import NO_ARUCO
from camera_to_base.reason import Level, Reason

_CURE = 'clear the surface, and call ~/capture_background'


def unclear(trouble: str) -> Reason:
    """Tell that nothing is published because the markers do not say where the camera stands."""
    return Reason('markers_unclear', Level.ERROR, (
        f'where the camera stands cannot be told: {trouble}; uncover the markers, or learn them '
        'again with calibrate markers'))


def disagree() -> Reason:
    """Tell that markers are elsewhere although the view is the background's."""
    return Reason('markers_disagree', Level.ERROR, (
        'the markers are seen elsewhere, but the rest of the view is as it was: put them back, or '
        f'learn them again with calibrate markers; if the camera was moved, {_CURE}'))


def background_awaited(numbers: Tuple[int, ...], is_automatic: bool) -> Reason:
    """Tell that only the background is missing where the camera stands now."""
    cure = ('clear the surface, uncover all markers and keep still: then a new background is taken'
            if is_automatic else f'{_CURE}, or set background_retake to auto')
    return Reason('background_awaited', Level.ERROR, (
        f'the camera was moved; the markers {_listed(numbers)} tell where it stands, but the '
        f'background is of another place: {cure}'))


def by_markers(numbers: Tuple[int, ...], moved: Tuple[int, ...]) -> Reason:
    """Tell that positions are located by a surface computed anew."""
    return Reason('surface_by_markers', Level.WARN, (
        f'the camera was moved: the surface is computed anew from the markers {_listed(numbers)}'
        + (f' (marker {_listed(moved)} was moved)' if moved else '')
        + '; calibrate again where this is not exact enough'))


def marker_moved(moved: Tuple[int, ...]) -> Reason:
    """Tell that markers were moved on the surface."""
    names = f'marker {moved[0]} was' if len(moved) == 1 else f'the markers {_listed(moved)} were'
    return Reason('marker_moved', Level.WARN, (
        f'{names} moved on the surface: put it back, or learn the markers again with calibrate '
        'markers'))


def without_aruco() -> Reason:
    """Tell that OpenCV cannot find markers."""
    return Reason('markers_not_looked_for', Level.WARN, f'the markers have no effect: {NO_ARUCO}')


def _listed(numbers: Tuple[int, ...]) -> str:
    return ', '.join(map(str, numbers))
