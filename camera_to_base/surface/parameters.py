# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""From the parameters that describe a calibration to the surface and the area it holds for."""

from functools import lru_cache
from typing import Any, Dict, Mapping, Optional, Tuple, Union

from camera_to_base.checks import ImageSize
from camera_to_base.errors import InvalidValueError
from camera_to_base.surface.distortion import RadialDistortion
from camera_to_base.surface.models import (
    CalibratedSurface, HomographySurface, MOST_CORNERS, ParallelSurface, PolynomialSurface,
    Surface, SURFACE_SPECS)
from camera_to_base.surface.pinhole import pinhole_of_values, pinhole_values, PinholeSurface
from camera_to_base.surface.points import Hull
import numpy as np

# What the surface does not depend on.
_OF_THE_HULL = 'surface.hull', 'surface.reject_outside_hull'


def make_surface(values: Mapping[str, Any]) -> Surface:
    """
    Make the surface of its parameters.

    The same values give the same object, so that a change of other parameters is none of it.

    :param values: By their full names, 'surface.model' and so on, as the specs allow them.
    :raises InvalidValueError: If they describe none.
    """
    return _made_surface(tuple(
        (spec.name, _frozen(values[spec.name])) for spec in SURFACE_SPECS
        if spec.name not in _OF_THE_HULL))


def _frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


@lru_cache(maxsize=8)
def _made_surface(items: Tuple[Tuple[str, Any], ...]) -> Surface:
    values = dict(items)
    if values['surface.model'] == 'pinhole':
        return pinhole_of_values(values)
    return _model(values, values['surface.model'], values['surface.image_size']).seen_from(
        values['surface.camera_height_cm'], values['surface.camera_foot_cm'] or None)


def _model(values: Mapping[str, Any], model: str, image_size: ImageSize) -> CalibratedSurface:
    if model == 'parallel':
        return ParallelSurface(values['surface.parallel.width_cm'], image_size[0]).for_image_size(
            image_size)
    if model == 'polynomial':
        return PolynomialSurface(
            values['surface.polynomial.y_of_v'], values['surface.polynomial.px_per_cm_of_y'],
            values['surface.polynomial.centre_u'], image_size)
    return _homography_surface(values, image_size)


def make_hull(values: Mapping[str, Any]) -> Optional[Hull]:
    """
    Make the area that the calibration was measured in; None where it is not known.

    The same values give the same object.

    :param values: 'surface.hull' is u and v of one corner after the other, in px, or empty.
    :raises InvalidValueError: If it is no area.
    """
    return _made_hull(tuple(values['surface.hull']))


@lru_cache(maxsize=8)
def _made_hull(numbers: Tuple[float, ...]) -> Optional[Hull]:
    if len(numbers) % 2:
        raise InvalidValueError(
            f'surface.hull must be pairs of u and v, got {len(numbers)} numbers')
    if len(numbers) > 2 * MOST_CORNERS:
        raise InvalidValueError(
            f'surface.hull must have at most {MOST_CORNERS} corners, got {len(numbers) // 2}')
    return Hull(np.reshape(numbers, (-1, 2))) if numbers else None


def surface_values(
    surface: Union[HomographySurface, PolynomialSurface], hull: Optional[Hull]
) -> Dict[str, Any]:
    """
    Give the parameters that :func:`make_surface` and :func:`make_hull` make the same of.

    The hull is rounded to hundredths of a px, the rest is exact.
    """
    corners = [] if hull is None else np.round(hull.corners, 2).ravel().tolist()
    values = {'surface.image_size': list(surface.image_size), 'surface.hull': corners}
    if isinstance(surface, PolynomialSurface):
        return {'surface.model': 'polynomial', **values,
                'surface.polynomial.y_of_v': surface.y_of_v.tolist(),
                'surface.polynomial.px_per_cm_of_y': surface.px_per_cm_of_y.tolist(),
                'surface.polynomial.centre_u': surface.centre_u}
    if isinstance(surface, PinholeSurface):
        return {'surface.model': 'pinhole', **values, **pinhole_values(surface)}
    matrix = surface.surface_from_pixel.ravel().tolist()
    return {'surface.model': 'homography', **values,
            'surface.homography.surface_from_pixel': matrix,
            'surface.homography.distortion_coefficient': surface.distortion.coefficient,
            'surface.homography.distortion_centre': list(surface.distortion.centre)}


def _homography_surface(values: Mapping[str, Any], image_size: ImageSize) -> HomographySurface:
    matrix = np.reshape(values['surface.homography.surface_from_pixel'], (3, 3))
    distortion = RadialDistortion.of_picture(
        image_size, values['surface.homography.distortion_coefficient'],
        values['surface.homography.distortion_centre'])
    return HomographySurface(matrix, image_size, distortion)
