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

// Detect: the picture with the mask over it, and a field for each parameter of both nodes.

import {act} from '../base/actions.js';
import {createAreas} from '../pieces/areas.js';
import {button, card, element, setText, show} from '../base/dom.js';
import {everydayName} from '../base/names.js';
import {createField} from '../pieces/fields.js';
import {attempt} from '../base/notices.js';
import {LivePicture} from '../pieces/pictures.js';

const TITLES = {
  detector: 'Detection', '': 'General', view: 'Check of the view', surface: 'Surface',
  uncertainty: 'Uncertainty', debug_image: 'Debug image', calibration: 'Calibration',
  simulated: 'Simulated camera', transform: 'Base frame', qos_overrides: 'Quality of service, read at the start only', fixed: 'Read at the start only',
};
const ORDER = ['detector', '', 'transform', 'view', 'uncertainty', 'debug_image', 'simulated',
  'surface', 'calibration', 'fixed', 'qos_overrides'];

/** Make the part. */
export function createDetect(store) {
  const picture = new LivePicture('annotated', 'The live picture with the outlines of the objects.');
  const mask = new LivePicture('mask', 'The mask: pixels that belong to objects are bright.');
  const fields = createFields(store);
  const strength = element('input', {type: 'range', id: 'mask-strength', min: 0, max: 100, value: 40,
    oninput: () => mask.node.style.setProperty('opacity', strength.value / 100)});
  mask.node.classList.add('over');
  mask.node.style.setProperty('opacity', strength.value / 100);
  picture.overlay.before(mask.node);
  const effect = card('Effect', element('figure', {}, picture.node),
    element('p', {class: 'mask-strength'}, element('label', {for: 'mask-strength'},
      'Mask: what belongs to objects, over the picture'), strength));
  effect.classList.add('effect');
  // Its tools lie below the picture, which is in its place now.
  const areas = createAreas(store, picture);
  const parameters = card('Parameters', fields.node);
  parameters.classList.add('sticky');
  const node = element('div', {class: 'detect'},
    element('div', {},
      effect,
      createBackground(),
      areas.node),
    parameters);
  return {
    node,
    shown: () => { picture.start(); mask.start(); },
    hidden: () => { picture.stop(); mask.stop(); },
  };
}

function createBackground() {
  const take = button('Take the background now', async () => {
    take.disabled = true;
    await attempt(() => act('/api/background'),
      (answer) => `The background is new: ${answer.sentence}.`);
    take.disabled = false;
  }, {class: 'primary'});
  return card('Background', element('p', {},
    'The background is the picture of the empty surface. Clear the surface first: what lies on ' +
    'it now is not found later.'), take);
}

function createFields(store) {
  const fields = new Map();
  const groups = new Map();
  const none = element('p', {}, 'The nodes have not answered yet.');
  const search = element('input', {type: 'search', id: 'find-parameter', autocomplete: 'off'});
  const result = element('p', {class: 'quiet', role: 'status'});
  const place = element('div');
  search.addEventListener('input', () => setText(result, filter(groups, search.value)));
  store.on('parameters', (parameters) => {
    for (const name of ORDER) groupFor(groups, place, name);
    for (const node of ['camera', 'transform']) {
      for (const spec of parameters[node] ?? []) {
        const key = `${node}:${spec.name}`;
        if (!fields.has(key)) fields.set(key, addField(groups, place, node, spec));
        fields.get(key).update(spec);
        fields.get(key).node.classList.toggle('idle', isIdle(spec, parameters[node]));
      }
    }
    show(none, !fields.size);
    groups.forEach((group) => show(group.node, group.fields.length));
  });
  return {node: element('div', {}, none, element('p', {class: 'search'},
    element('label', {for: 'find-parameter'}, 'Find a parameter '), search), result, place)};
}

/** Tell whether a parameter belongs to a choice that is not taken, such as another method. */
function isIdle({name, description, choices}, specs) {
  // A choice itself explains each of its values.
  if (choices?.length) return false;
  const choice = description.match(/^(\w+): /)?.[1];
  const group = name.split('.')[0];
  const chooser = specs.find((spec) => spec.name.startsWith(`${group}.`) &&
    spec.choices?.includes(choice));
  return Boolean(chooser) && chooser.value !== choice;
}

function addField(groups, place, node, spec) {
  const first = (spec.group ?? '').split('.')[0];
  const own = node === 'transform' ? 'transform' : first;
  const name = first === 'qos_overrides' ? first : spec.read_only ? 'fixed' : own;
  const field = createField(spec, `p-${node}-${spec.name.replaceAll('.', '-')}`,
    (value) => act('/api/parameters', {node, values: {[spec.name]: value}}));
  const group = groupFor(groups, place, name);
  group.fields.push({node: field.node, text: `${everydayName(spec.name)} ${spec.name} ${spec.description}`.toLowerCase()});
  group.node.append(field.node);
  return field;
}

function groupFor(groups, place, name) {
  if (!groups.has(name)) {
    const node = element('details', {class: 'group', open: name === 'detector', hidden: true},
      element('summary', {}, TITLES[name] ?? name));
    place.append(node);
    groups.set(name, {node, fields: []});
  }
  return groups.get(name);
}

function filter(groups, text) {
  const wanted = text.trim().toLowerCase();
  let count = 0;
  for (const {node, fields} of groups.values()) {
    const hits = fields.filter((field) => field.text.includes(wanted));
    fields.forEach((field) => show(field.node, hits.includes(field)));
    show(node, hits.length);
    if (wanted && hits.length) node.open = true;
    count += hits.length;
  }
  return wanted ? `${count} ${count === 1 ? 'parameter' : 'parameters'} found.` : '';
}
