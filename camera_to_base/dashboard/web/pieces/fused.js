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

// The pictures of a fused cell: one of each camera, with the way to that camera's own cell.

import {element, sync} from '../base/dom.js';
import {LivePicture} from './pictures.js';

/** Make the pictures; `update(cameras)` shows those of some cells, and of none ends them. */
export function createFused() {
  const node = element('div', {class: 'fused'});
  const pictures = new Map();
  const make = (camera) => {
    const picture = new LivePicture('annotated', `The live picture of ${camera}, with outlines.`, camera);
    pictures.set(camera, picture);
    return element('figure', {}, picture.node, element('figcaption', {},
      element('a', {href: `?${new URLSearchParams({cell: camera})}`}, camera),
      ': its own numbers and positions'));
  };
  const update = (cameras) => {
    for (const [camera, picture] of pictures) {
      if (!cameras.includes(camera)) {
        picture.stop();
        pictures.delete(camera);
      }
    }
    sync(node, cameras, (camera) => camera, make, () => {});
    pictures.forEach((picture) => picture.start());
  };
  return {node, update};
}
