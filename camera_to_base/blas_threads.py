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

"""Limits the threads of numpy's linear algebra."""

import os


def use_one_blas_thread() -> None:
    """
    Let OpenBLAS compute in the calling thread; it must be called before numpy is imported.

    The matrices of a fit are small: on a busy machine, threads for them cost fifteen times as
    much. A number of threads that the user has set is kept.
    """
    os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
