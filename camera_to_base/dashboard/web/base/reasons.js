// Copyright 2026 The camera_to_base authors
//
// Licensed under the Apache License, Version 2.0 (the "License");
// you may not use this file except in compliance with the License.
// You may obtain a copy of the License at
//
//     http://www.apache.org/licenses/LICENSE-2.0
//
// Unless required by applicable law or agreed to in writing, software
// distributed under the License is distributed on an "AS IS" BASIS,
// WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
// See the License for the specific language governing permissions and
// limitations under the License.

// What a reason means for the page. Its kind is a stable word of the nodes, see
// docs/topics_and_frames.md; no other module of the page compares kinds.

const WITHOUT_BACKGROUND = [
  'background_missing', 'background_dark', 'background_unsettled', 'other_view'];
const WITHOUT_CAMERA = ['node_ended', 'node_hangs', 'not_running', 'camera_opening', 'camera_waiting',
  'camera_lost', 'topic_type'];
const WITH_ANOTHER_SURFACE = ['view_corrected', 'surface_by_markers'];

/** Tell whether no pictures come from the camera. */
export function lacksCamera(kind) {
  return WITHOUT_CAMERA.includes(kind);
}

/** Tell whether there is no background that can be used, or nobody who knows it. */
export function lacksBackground(kind) {
  return lacksCamera(kind) || WITHOUT_BACKGROUND.includes(kind);
}

/** Tell whether positions are located by a surface that is not the calibrated one. */
export function hasAnotherSurface(kind) {
  return WITH_ANOTHER_SURFACE.includes(kind);
}

/** Tell whether an object was left out as its height is not the one that is set. */
export function doubtsHeight(kind) {
  return ['other_height', 'height_unclear'].includes(kind);
}
