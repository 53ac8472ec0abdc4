# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.sources.status import stamp_reason
import pytest

NOW = 1_790_000_000 * 10**9


@pytest.mark.parametrize('age_s, kind', [
    (0.0, None), (0.29, None), (-0.09, None), (0.31, 'stamp_old'), (1.7e9, 'stamp_old'),
    (-0.11, 'stamp_ahead'), (-1e6, 'stamp_ahead'), (1_790_000_000, 'no_stamp')])
def test_stamp_is_compared_with_the_clock(age_s, kind):
    reason = stamp_reason(NOW - round(age_s * 1e9), NOW, 0.3)
    assert (None if reason is None else reason.kind) == kind


def test_sentence_tells_how_far_and_what_to_do():
    assert 'is 2.50 s old by its stamp' in stamp_reason(NOW - 25 * 10**8, NOW, 0.3).sentence
    assert 'stamped 3 days in the future' in stamp_reason(
        NOW + 3 * 86400 * 10**9, NOW, 0.3).sentence


def test_stamp_of_0_is_good_at_the_beginning_of_a_simulation():
    assert stamp_reason(0, 10**8, 0.3) is None
