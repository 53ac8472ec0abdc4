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

// Save: what changed against the loaded file, and the button that writes it.

import {act} from '../base/actions.js';
import {button, card, element, fillRow, row, setAttribute, setText, show, sync, table} from '../base/dom.js';
import {attempt} from '../base/notices.js';
import {sentence as asSentence} from '../base/numbers.js';
import {hasAnotherSurface} from '../base/reasons.js';
import {address} from '../base/state.js';

const NODES = {camera: 'camera_publisher', transform: 'robot_base_publisher', both: 'both'};
const LONGEST_TEXT = 60;

/** Make the part. */
export function createSave(store) {
  const path = element('input', {type: 'text', id: 'path', autocomplete: 'off', class: 'long'});
  const write = button('Save', () => save(), {class: 'primary'});
  const save = (more = {}) => attempt(
    () => act('/api/save', {...path.value ? {path: path.value} : {}, ...more}), () => null);
  const question = createQuestion((removes) => save({removes}));
  const former = createFormer();
  const keep = button('Keep the correction', () => attempt(
    () => act('/api/correction', path.value ? {path: path.value} : {}), () => null));
  const corrected = element('p');
  const nudged = card('The camera was nudged', corrected,
    element('p', {class: 'lead'}, 'To keep the correction writes the corrected surface into the file below. ' +
      'The base frame, the markers and the areas stay, and the old file is kept.'),
    element('p', {class: 'buttons'}, keep));
  show(nudged, false);
  store.on('health', ({nodes}) => {
    const one = nodes.find(({reason}) => hasAnotherSurface(reason));
    show(nudged, Boolean(one));
    if (one) setText(corrected, asSentence(one.sentence));
  });
  const sentence = element('p', {class: 'verdict', role: 'status'});
  const loaded = element('p', {class: 'quiet'});
  const calibration = element('p');
  const folder = element('p', {class: 'quiet'});
  const warnings = element('ul', {class: 'warnings'});
  const changes = table('Parameters that differ from the file', ['Parameter', 'In the file', 'Now', 'Node'],
    {class: 'wrapped'});
  const none = element('p', {}, 'Nothing has changed since the file was loaded or saved.');
  const changed = card('What changed', none, changes.node);
  const download = element('a', {class: 'button', href: address('/api/file'), download: 'cell.yaml'},
    'Download the file');
  let known = null;
  store.on('save', (state) => {
    if (state.path !== known && document.activeElement !== path) path.value = known = state.path;
    setText(loaded, state.from ? `Loaded from ${state.from}.` : 'No file was loaded.');
    setText(calibration, asSentence(state.calibration ?? ''));
    tell(sentence, state);
    question.update(state);
    former.update(state);
    setText(folder, `The file lies in ${state.folder}: the dashboard writes nowhere else.`);
    write.disabled = Boolean(state.needs);
    sync(warnings, state.warnings ?? [], (text) => text, () => element('li'), setText);
    show(none, !state.changes.length && !state.needs);
    show(changed, !state.needs || state.changes.length);
    show(changes.node, state.changes.length);
    sync(changes.body, state.changes, ({name, nodes}) => `${name} ${nodes}`, () => row(4),
      (node, {name, old, new: now, nodes}) => fillRow(node, [
        name, short(old) ?? '–', short(now) ?? '–', NODES[nodes] ?? nodes]));
  });
  return {node: element('div', {}, nudged,
    card('File for both nodes',
      element('p', {class: 'lead'}, 'The file holds all parameters of both nodes. Start them with ' +
        'it, and everything is as it is now. The last five files are kept.'),
      loaded, calibration, warnings,
      element('p', {class: 'buttons save-row'}, element('label', {for: 'path'}, 'File'), path, write, download),
      question.node, sentence, folder),
    changed, former.node)};
}

/** Asks before a calibration is removed from a file, or replaced by an older one. */
function createQuestion(allow) {
  const sentence = element('p');
  let removes = [];
  const yes = button('', () => allow(removes));
  const node = element('div', {class: 'question', role: 'alertdialog', 'aria-label': 'Before saving'},
    sentence, element('div', {class: 'buttons'},
      button('Keep the file as it is', () => saving('cancel'), {class: 'primary'}),
      yes));
  const update = ({question}) => {
    show(node, question);
    setText(sentence, question?.sentence ?? '');
    setText(yes, `${question?.verb ?? 'Remove'}, and save`);
    removes = question?.removes ?? [];
  };
  return {node, update};
}

/** The kept former files; the nodes can have the values of each. */
function createFormer() {
  const list = element('ul', {class: 'areas'});
  const revert = button('Load the file', () => saving('load'));
  const undo = button('Undo', () => saving('undo'), {'aria-label': 'Undo the loading'});
  const node = card('Go back', element('p', {}, 'The running nodes take the values of the file, or ' +
    'of one of those that it replaced. Nothing is written.'),
  element('div', {class: 'buttons'}, revert, undo), list);
  const update = ({former, from, can_undo: canUndo}) => {
    show(node, from || former.length);
    show(revert, from);
    show(undo, canUndo);
    sync(list, former, ({number}) => number, ({number}) => element('li', {}, element('span'),
      button('Load', () => saving('load', {number}), {class: 'quiet small'})),
    (item, {name, date}) => {
      setText(item.firstChild, `${name}, replaced after ${date}`);
      setAttribute(item.lastChild, 'aria-label', `Load ${name}`);
    });
  };
  return {node, update};
}

function saving(action, body) {
  return attempt(() => act(`/api/save/${action}`, body), () => null);
}

function tell(sentence, {error, needs, saved}) {
  setText(sentence, error ?? needs ?? saved?.sentence ?? '');
  sentence.classList.toggle('bad', Boolean(error ?? needs));
  sentence.classList.toggle('good', !error && !needs && Boolean(saved));
}

function short(text) {
  if (text === null || text === undefined) return null;
  return text.length > LONGEST_TEXT ? `${text.slice(0, LONGEST_TEXT)} …` : text;
}
