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

// The picture on which an object is chosen, by a click or by its button.

import {button, element, setAttribute, svg, sync} from '../base/dom.js';
import {LivePicture} from './pictures.js';

/** Make picture and buttons; `see({u, v})` is called with the pixel that is chosen. */
export function createChoice(store, see) {
  const picture = new LivePicture('annotated', 'The live picture with the number of each object.');
  const buttons = element('div', {class: 'buttons', role: 'group',
    'aria-label': 'Objects in the picture'});
  picture.node.addEventListener('click', (event) => {
    const pixel = picture.pixelAt(event);
    if (pixel) see(pixel);
  });
  store.on('watch', ({objects}) => sync(buttons, objects.filter((each) => each.pixel),
    ({number}) => number, ({number}) => button(`Object ${number}`, () => {
      const object = store.get('watch').objects.find((each) => each.number === number);
      if (object) see({u: object.pixel[0], v: object.pixel[1]});
    }), () => {}));
  return {picture, buttons};
}

/** Mark places on a picture, each {number, pixel, name}: a ring, or a dot for a measured one. */
export function markPlaces(picture, marks) {
  const r = picture.size.width * 0.02;
  sync(picture.overlay, marks, ({number}) => number, () => svg('circle'),
    (node, {pixel: [u, v], name}) => {
      const place = {class: name, cx: u, cy: v, r: name.startsWith('pair') ? r : 2.5 * r};
      Object.entries(place).forEach(([key, value]) => setAttribute(node, key, value));
    });
}
