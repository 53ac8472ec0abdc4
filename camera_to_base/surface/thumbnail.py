# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A small picture of the surface in a parameter, and whether a view shows the same structure."""

import base64
import binascii
from typing import Optional, Sequence

from camera_to_base.errors import InvalidValueError
import cv2
import numpy as np

# Of the kept picture, which goes into a parameter file as text.
_SIZE = 64, 48
# Of a pixel that something hid, such as the chessboard.
_UNKNOWN = 0
# Contrast in grey levels below which a view has no structure: a bare table has 0.3, faint wood 2.
_LEAST_CONTRAST = 1.0
# Correlation below which two views share nothing. Pictures of the same surface in other light,
# with shadows or nudged, have 0.42 or more; of unrelated pictures one of ten has more than 0.25,
# one of a hundred more than 0.3.
_LEAST_CORRELATION = 0.3
# A nudge is the business of the view check: structure is searched within so many pixels.
_REACH = 3
# With fewer known pixels nothing can be told.
_LEAST_KNOWN = 0.2


def view_thumbnail(picture: np.ndarray, hidden: Optional[Sequence[np.ndarray]] = None) -> str:
    """
    Make the parameter that shows a surface.

    :param picture: Shape (h, w, 3), uint8, BGR.
    :param hidden: Outlines of what does not belong to the surface, each of shape (n, 2), in px.
    :returns: A grey picture of 64 x 48 px, as PNG in base64.
    """
    small = np.maximum(_small(picture), 1).round().astype(np.uint8)
    if hidden is not None:
        mask = np.zeros(picture.shape[:2], np.uint8)
        for outline in hidden:
            cv2.fillConvexPoly(mask, np.round(outline).astype(np.int32), 255)
        small[cv2.resize(mask, _SIZE, interpolation=cv2.INTER_AREA) > 0] = _UNKNOWN
    return base64.b64encode(cv2.imencode('.png', small)[1].tobytes()).decode()


def read_thumbnail(text: str) -> Optional[np.ndarray]:
    """
    Read the parameter.

    :returns: Shape (48, 64), uint8; None for an empty text.
    :raises InvalidValueError: If it is no such picture.
    """
    if not text:
        return None
    try:
        content = np.frombuffer(base64.b64decode(text, validate=True), np.uint8)
        small = cv2.imdecode(content, cv2.IMREAD_GRAYSCALE) if content.size else None
    except (binascii.Error, ValueError, cv2.error):
        small = None
    if small is None or small.shape != _SIZE[::-1]:
        raise InvalidValueError(
            'calibration.thumbnail must be a PNG of 64 x 48 px in base64, as calibrate writes it: '
            'calibrate again, or remove it')
    return small


def shares_structure(thumbnail: np.ndarray, picture: np.ndarray) -> Optional[bool]:
    """
    Return whether a picture shows the structure of a thumbnail, in whatever light.

    :param thumbnail: Shape (48, 64), uint8, see :func:`read_thumbnail`.
    :param picture: Shape (h, w, 3), uint8, BGR.
    :returns: None if one of them has too little structure, or too little of it is known.
    """
    known = thumbnail != _UNKNOWN
    # The known mean, so that the edge of what was hidden is no structure.
    mean = thumbnail[known].mean() if known.any() else 0
    there = _bands(np.where(known, thumbnail, mean).astype(np.float32))
    here = _bands(_small(picture))
    inner = np.s_[_REACH:-_REACH, _REACH:-_REACH]
    mask = cv2.erode(known.astype(np.uint8), np.ones((3, 3)))[inner] > 0
    if mask.mean() < _LEAST_KNOWN or min(
            there[inner][mask].std(), here[inner].std()) < _LEAST_CONTRAST:
        return None
    there, here = _even(there)[inner][mask], _even(here)
    height, width = here.shape
    steps = range(2 * _REACH + 1)
    best = max(np.corrcoef(there, here[
        down:height - 2 * _REACH + down, right:width - 2 * _REACH + right][mask])[0, 1]
        for down in steps for right in steps)
    return bool(best >= _LEAST_CORRELATION)


def _small(picture: np.ndarray) -> np.ndarray:
    grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
    return cv2.resize(grey, _SIZE, interpolation=cv2.INTER_AREA).astype(np.float32)


def _bands(small: np.ndarray) -> np.ndarray:
    """Leave out what light changes, which is coarse, and noise, which is fine."""
    return cv2.GaussianBlur(small, (0, 0), 0.7) - cv2.GaussianBlur(small, (0, 0), 3)


def _even(bands: np.ndarray) -> np.ndarray:
    """Give all parts of a view the same contrast."""
    return bands / np.sqrt(cv2.GaussianBlur(bands ** 2, (0, 0), 5) + 1.0)
