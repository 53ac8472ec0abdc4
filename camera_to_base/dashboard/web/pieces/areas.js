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

// The work area and the areas to ignore: drawn on a picture, changed, removed.

import {act} from '../base/actions.js';
import {button, card, createUndo, element, setText, show, svg, sync} from '../base/dom.js';
import {attempt} from '../base/notices.js';
import {Pen} from './pen.js';

const NAMES = {work_area: 'the work area', ignored_areas: 'an area to ignore'};

/** Make the card; the polygons appear on the picture. */
export function createAreas(store, picture) {
  const pen = new Pen(picture);
  const list = element('ul', {class: 'areas'});
  let removed = null;
  const undo = createUndo(() => attempt(() => act('/api/areas', removed), () => null)
    .then((answer) => answer && undo.update({undo: null})));
  /** Set areas; `done` is what can be undone then. */
  const set = async (body, done, said) => {
    const before = asBody(store.get('areas'));
    const answer = await attempt(() => act('/api/areas', body), () => said);
    if (answer && done) {
      removed = before;
      undo.update({undo: done});
    }
    return answer;
  };
  const draw = (kind) => pen.begin(NAMES[kind], kind, [], (corners) => set(kind === 'work_area'
    ? {work_area: corners} : {ignored_areas: [...asBody(store.get('areas')).ignored_areas, corners]},
  `${NAMES[kind]} drawn`, 'The area is in use now.'));
  const edit = ({name, kind, area, replaced}) => pen.begin(`the ${name}`, kind, corners(area),
    (changed) => set(replaced(changed), `${name} changed`, 'The area is in use now.'));
  const needs = element('p', {class: 'quiet'});
  const choices = element('div', {class: 'buttons'},
    button('Draw the work area', () => draw('work_area')),
    button('Draw an area to ignore', () => draw('ignored_areas')));
  let shown = new Map();
  pen.onchange = () => {
    [choices, list].forEach((each) => show(each, !pen.kind));
    drawAreas(picture, store.get('areas'), pen);
  };
  store.on('areas', (areas) => {
    setText(needs, areas.needs ?? '');
    for (const each of choices.children) each.disabled = Boolean(areas.needs);
    shown = new Map(entries(areas).map((entry) => [entry.name, entry]));
    sync(list, [...shown.values()], (entry) => entry.name, ({name}) => element('li', {}, element('span'),
      button('Change', () => edit(shown.get(name)), {class: 'quiet small', 'aria-label': `Change ${name}`}),
      button('Remove', () => set(shown.get(name).replaced(null), `${name} removed`),
        {class: 'quiet small', 'aria-label': `Remove ${name}`})),
    (node, {name, area}) => setText(node.firstChild, `${name}, ${area.px.length} corners`));
    pen.onchange();
  });
  const node = card('Areas', element('p', {},
    'Objects count only inside the work area, and not in the areas to ignore. The areas lie on ' +
    'the surface: they stay right when the camera is calibrated again.'),
  needs, choices, list, undo.node);
  picture.node.before(pen.node);
  picture.node.after(pen.help);
  return {node};
}

/** Return the body that sets all areas as they are, to the last digit. */
function asBody({work_area: work, ignored_areas: ignored}) {
  return {work_area: work?.cm ?? null, ignored_areas: (ignored ?? []).map(({cm}) => cm)};
}

/** Return each area; `replaced(corners)` is the body that sets other corners, or none. */
function entries(areas) {
  const {ignored_areas: ignored} = asBody(areas);
  return [
    ...(areas.work_area ? [{name: 'work area', kind: 'work_area', area: areas.work_area,
      replaced: (corners) => ({work_area: corners})}] : []),
    ...(areas.ignored_areas ?? []).map((area, index) => ({
      name: `ignored area ${index + 1}`, kind: 'ignored_areas', area,
      replaced: (corners) => ({ignored_areas: corners === null ? ignored.toSpliced(index, 1)
        : ignored.with(index, corners)})})),
  ];
}

/** Return an area's corners as the pen has them: where they are seen, and what they are exactly. */
function corners({px, cm}) {
  return cm.map((place, index) => ({pixel: px[index], place}));
}

function drawAreas(picture, areas, pen) {
  const old = [
    ...(areas?.work_area ? [['work-area', areas.work_area.px]] : []),
    ...(areas?.ignored_areas ?? []).map(({px}) => ['ignored-area', px]),
  ].map(([name, pixels]) => svg('polygon', {
    class: name, points: pixels.filter(Boolean).map(([u, v]) => `${u},${v}`).join(' ')}));
  picture.overlay.replaceChildren(...old, ...pen.shapes());
}
