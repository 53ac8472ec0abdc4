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

// Asks how high the objects are: where the camera's place is known, positions depend on it.

import {act} from '../base/actions.js';
import {button, element, setText, show} from '../base/dom.js';
import {attempt} from '../base/notices.js';
import {fixed, read} from '../base/numbers.js';
import {doubtsHeight} from '../base/reasons.js';

// Less than a gripper notices, and a height: what has one does not count as flat.
const FLAT_CM = 0.1;

/** Make the question; it is urgent while objects do not fit the height that is set, or look solid. */
export function createHeights(store) {
  const sentence = element('p', {role: 'status'});
  const input = element('input', {type: 'text', inputmode: 'decimal', id: 'height', class: 'short',
    autocomplete: 'off'});
  const use = (height) => attempt(
    () => act('/api/parameters', {node: 'camera', values: {object_height_cm: height}}),
    () => `The objects are ${height} cm high now. Save it, so that it stays.`);
  // A flat thing may look solid by chance, such as a card that points away from the camera.
  const flat = button('They are flat', () => use(FLAT_CM));
  const node = element('form', {class: 'heights', hidden: true, onsubmit: (event) => {
    event.preventDefault();
    use(read(input.value));
  }}, sentence, element('p', {class: 'buttons'}, element('label', {for: 'height'}, 'Height of the objects in cm'),
    input, button('Use it', () => {}, {type: 'submit'}), flat));
  const update = () => {
    const height = valueOf(store, 'object_height_cm');
    const isKnown = valueOf(store, 'surface.model') === 'pinhole' || valueOf(store, 'surface.camera_height_cm') > 0;
    const several = valueOf(store, 'object_heights_cm')?.length;
    const doubted = (store.get('watch')?.left_out ?? []).filter(({reason}) => doubtsHeight(reason)).length;
    const solid = Boolean(!height && store.get('watch')?.looks_solid);
    show(node, isKnown && !several || doubted);
    show(flat, solid);
    node.classList.toggle('question', doubted > 0 || solid);
    setText(sentence, doubted ? `${doubted} ${doubted === 1 ? 'object does' : 'objects do'} not fit a height of ` +
      `${fixed(height, 1)} cm. How high are they?` : height ? '' : solid ?
      'Objects look solid: the camera sees their sides. Say how high they are: their positions are off by up to ' +
      'half of what is seen of the sides.' :
      'Objects count as flat. Of solid ones the camera sees the sides, too: say how high they are, or their ' +
      'positions are off.');
    if (document.activeElement !== input && !input.value) input.value = height ?? '';
  };
  ['watch', 'parameters'].forEach((part) => store.on(part, update));
  return {node};
}

function valueOf(store, name) {
  return store.get('parameters')?.camera?.find((each) => each.name === name)?.value;
}
