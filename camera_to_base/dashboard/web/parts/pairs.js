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

// The pairs that were measured, with their errors.

import {button, card, element, row, setAttribute, setText, show, sync, table} from '../base/dom.js';
import {fixed, point} from '../base/numbers.js';
import {robot} from '../base/sessions.js';

const HEADS = ['No.', 'Seen x, y in cm', 'Touched x, y in cm', 'Error in mm',
  'Error when left out in mm', 'State', 'Change'];

/** Make the card. */
export function createPairs() {
  const list = table('Seen by the camera and touched by the robot', HEADS, {class: 'numbers'});
  const none = element('p', {class: 'quiet'}, 'No pair yet.');
  const stop = button('Stop, and drop the pairs', () => robot('cancel'));
  const node = card('Pairs', none, list.node, stop);
  const update = ({pairs, step}) => {
    show(stop, step === 'measuring');
    show(none, !pairs.length);
    show(list.node, pairs.length);
    sync(list.body, pairs, ({number}) => number, ({number}) => pairRow(number), fill);
  };
  return {node, update};
}

function pairRow(number) {
  const node = row(HEADS.length);
  node.cells[5].className = 'words';
  node.cells[6].append(
    button('Again', () => robot('again', {number}), {
      class: 'quiet small', 'aria-label': `Measure pair ${number} again`}),
    button('Remove', () => robot('remove', {number}), {
      class: 'quiet small', 'aria-label': `Remove pair ${number}`}));
  return node;
}

function fill(node, pair) {
  const isGood = pair.valid && pair.fits;
  setAttribute(node, 'class', isGood ? 'good' : 'bad');
  const state = pair.valid ? pair.sentence ?? 'fits' : pair.invalid_because ?? 'no longer valid';
  [String(pair.number), point(pair.camera), point(pair.base), fixed(pair.residual_mm, 2),
    fixed(pair.left_out_mm, 2), state].forEach((text, index) => setText(node.cells[index], text));
}
