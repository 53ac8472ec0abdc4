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

// The base frame that the pairs give, and the button that puts it to use.

import {button, card, element, setText, show, sync} from '../base/dom.js';
import {fixed} from '../base/numbers.js';
import {robot} from '../base/sessions.js';

/** Make the card. */
export function createFit() {
  const sentence = element('p', {class: 'verdict', role: 'status'});
  const figures = element('dl', {class: 'figures'});
  const warnings = element('ul', {class: 'warnings'});
  const lines = element('pre', {tabindex: 0});
  const accept = button('Accept: use it now', () => robot('accept'), {class: 'primary'});
  const details = element('details', {}, element('summary', {}, 'All figures'), lines);
  const done = element('p', {class: 'verdict good', role: 'status'});
  const after = element('div', {class: 'accepted'}, done, element('p', {}, 'Next: ',
    element('a', {href: '#save'}, 'save the file'), ', or put an object at a new place and compare ' +
    'its position in ', element('a', {href: '#watch'}, 'Watch'), ' with the robot.'));
  const way = createBaseZ();
  const body = element('div', {}, sentence, figures, warnings, details, way.node,
    element('div', {class: 'buttons'}, accept));
  const node = card('3. Check and accept', body, after);
  const update = ({fit, accepted, base_z: z}) => {
    way.update(z);
    show(node, fit || accepted);
    show(body, fit);
    show(after, accepted);
    setText(done, accepted?.sentence ?? '');
    if (!fit) return;
    setText(sentence, fit.error ?? fit.sentence);
    sentence.classList.toggle('good', fit.can_accept);
    sync(figures, figuresOf(fit), ([name]) => name,
      ([name]) => element('div', {}, element('dt', {}, name), element('dd')),
      (item, [, text]) => setText(item.lastChild, text));
    sync(warnings, fit.warnings ?? [], (text) => text, () => element('li'), setText);
    setText(lines, (fit.lines ?? []).join('\n'));
    show(details, fit.lines?.length);
    accept.disabled = !fit.can_accept;
  };
  return {node, update};
}

function createBaseZ() {
  const choice = element('select', {id: 'base-z'}, element('option', {value: 'up'},
    'up (the robot stands on the table)'), element('option', {value: 'down'},
    'down (the robot hangs above the table)'));
  choice.addEventListener('change', () => robot('base_z', {base_z: choice.value}));
  return {update: (z) => { choice.value = z; },
    node: element('p', {}, element('label', {for: 'base-z'}, 'The z axis of the base frame points '),
      choice)};
}

function figuresOf({rms_mm: rms, left_out_rms_mm: leftOut}) {
  const known = (value) => value !== null && value !== undefined;
  return [
    ...(known(rms) ? [['Error of the pairs', `${fixed(rms, 2)} mm`]] : []),
    ...(known(leftOut) ? [['Error expected at a new point', `${fixed(leftOut, 2)} mm`]] : []),
  ];
}
