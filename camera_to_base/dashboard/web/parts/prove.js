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

// Prove: published positions beside true ones that the calibration has not seen.

import {button, card, createUndo, element, row, setAttribute, setText, show, sync, table} from '../base/dom.js';
import {createChoice, markPlaces} from '../pieces/choice.js';
import {fixed, point, sentence as asSentence} from '../base/numbers.js';
import {prove} from '../base/sessions.js';
import {createTouch} from './touch.js';

const HEADS = ['No.', 'Published x, y in cm', 'True x, y in cm', 'Error in mm', 'Said: ± mm', 'Verdict',
  'Change'];
const VERDICTS = {true: 'within the ellipse', false: 'outside the ellipse', null: 'no ellipse'};

/** Make the part. */
export function createProve(store) {
  const hint = element('p', {class: 'hint', role: 'status'});
  const undo = createUndo(() => prove('undo'));
  const {picture, buttons} = createChoice(store, (pixel) => prove('see', pixel));
  const touch = createTouch(prove, {id: 'true-place', label: 'True x and y in the base frame',
    add: 'Compare'});
  const stop = button('Another object', () => prove('cancel'), {class: 'quiet'});
  touch.node.append(stop);
  const results = createResults();
  const work = element('div', {class: 'columns'},
    card('1. Put an object down', picture.node, element('p', {class: 'quiet'},
      'Click an object that the calibration has not seen, or choose it here.'), buttons), touch.node);
  let isShown = false;
  const follow = () => {
    if (isShown && !store.get('prove')?.needs) picture.start();
    else picture.stop();
  };
  store.on('prove', (state) => {
    setText(hint, asSentence(state.error) ?? state.hint);
    hint.classList.toggle('error', Boolean(state.error ?? state.needs));
    show(work, !state.needs);
    show(stop, state.open);
    [touch, results, undo].forEach((each) => each.update(state));
    markPlaces(picture, [
      ...state.proofs.filter(({pixel, invalid_because: why}) => pixel && !why).map((one) => (
        {...one, name: one.within === false ? 'pair bad' : 'pair'})),
      ...(state.open?.pixel ? [{number: 'open', pixel: state.open.pixel, name: 'chosen'}] : [])]);
    follow();
  });
  const node = element('div', {class: 'robot'}, element('p', {class: 'lead'}, 'A calibration fits ' +
    'the places that it was made from. Whether it holds elsewhere is seen at places that it does ' +
    'not know: what is published there is compared with where the robot touches the object, or ' +
    'where you measure it.'), hint, undo.node, work, results.node);
  return {
    node,
    shown: () => { isShown = true; follow(); },
    hidden: () => { isShown = false; follow(); },
  };
}

function createResults() {
  const sentence = element('p', {class: 'verdict', role: 'status'});
  const list = table('The ellipse holds 95 % of the errors that are to be expected', HEADS,
    {class: 'numbers'});
  const node = card('3. How far it is off', sentence, list.node);
  const update = ({proofs, sentence: text, good}) => {
    show(node, proofs.length);
    setText(sentence, text ?? 'No place counts any more: prove the new calibration.');
    sentence.classList.toggle('good', good === true);
    sentence.classList.toggle('bad', good === false);
    sync(list.body, proofs, ({number}) => number, proofRow, fill);
  };
  return {node, update};
}

function proofRow({number}) {
  const node = row(HEADS.length);
  node.cells[5].className = 'words';
  node.cells[6].append(button('Remove', () => prove('remove', {number}), {
    class: 'quiet small', 'aria-label': `Remove place ${number}`}));
  return node;
}

function fill(node, {number, seen, true: place, error_mm: error, distance_mm: distance, ellipse,
  within, invalid_because: why}) {
  setAttribute(node, 'class', why ? 'outdated' : within === false ? 'bad' : 'good');
  [String(number), point(seen), point(place),
    `${fixed(distance, 2)} (x ${fixed(error.x, 2)}, y ${fixed(error.y, 2)})`,
    ellipse ? fixed(ellipse.major_mm, 2) : '–', why ?? VERDICTS[within]]
    .forEach((text, index) => setText(node.cells[index], text));
}
