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

"""Symmetric matrices as parameters: the upper triangle, row by row."""

from typing import List, Sequence

import numpy as np


def triangle_length(size: int) -> int:
    """Return how many numbers the upper triangle of a matrix of shape (size, size) has."""
    return size * (size + 1) // 2


def triangle_of(matrix: np.ndarray) -> List[float]:
    """
    Return the upper triangle of a symmetric matrix, row by row.

    :param matrix: Shape (n, n).
    """
    return matrix[np.triu_indices(len(matrix))].tolist()


def symmetric(numbers: Sequence[float], size: int) -> np.ndarray:
    """
    Return the symmetric matrix of an upper triangle, of shape (size, size).

    :param numbers: As many as :func:`triangle_length` says, row by row.
    """
    matrix = np.zeros((size, size))
    matrix[np.triu_indices(size)] = numbers
    return matrix + np.triu(matrix, 1).T
