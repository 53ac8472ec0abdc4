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

// The card of the markers: which of the printed ones are seen, and where they lie on the surface.

import {button, card, element, setAttribute, setText, show, svg, sync} from '../base/dom.js';
import {LivePicture} from '../pieces/pictures.js';
import {markers} from '../base/sessions.js';

/** Make the card. */
export function createMarkers() {
  const picture = new LivePicture('frame', 'The live picture with the markers that are seen.');
  const hint = element('p', {class: 'verdict', role: 'status'});
  const known = element('p', {class: 'quiet'});
  const start = button('Look for markers', () => markers('start'));
  const learn = button('Learn these markers', () => markers('learn'), {class: 'primary'});
  const stop = button('Stop looking', () => markers('cancel'));
  const look = element('div', {}, picture.node, hint,
    element('div', {class: 'buttons'}, learn, stop));
  const node = card('Markers', element('p', {}, 'Four markers that stay on the table let the ' +
    'camera be moved later. Print them, and glue them flat near the corners of the working area. ' +
    'Calibrate the surface first, and do not move the camera before the markers are learned.'),
  known, element('div', {class: 'buttons'}, start), look);
  const update = (state) => {
    const isLooking = state.step === 'looking';
    show(look, isLooking);
    show(start, !isLooking);
    start.disabled = Boolean(state.needs);
    learn.disabled = !state.can_learn || state.seen.length < 3;
    setText(hint, state.error ?? state.hint);
    setText(known, state.error ?? state.needs ?? (state.known.length ?
      `The camera node knows the markers ${state.known.join(', ')}. The robot can touch them.` :
      'No markers are learned.'));
    sync(picture.overlay, state.seen, ({number}) => number, () => svg('circle'),
      (circle, {pixel: [u, v]}) => {
        const place = {class: 'pair', cx: u, cy: v, r: picture.size.width * 0.03};
        Object.entries(place).forEach(([name, value]) => setAttribute(circle, name, value));
      });
  };
  return {node, update, start: () => picture.start(), stop: () => picture.stop()};
}
