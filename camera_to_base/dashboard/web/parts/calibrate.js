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

// Calibrate: how the camera sees the surface, from a printed board that lies on it.

import {createBoardLook} from './board_look.js';
import {createBoardReport} from './board_report.js';
import {createMarkers} from './markers.js';
import {fetchFile, keepFile} from '../base/actions.js';
import {button, card, createUndo, element, setText, show} from '../base/dom.js';
import {attempt} from '../base/notices.js';
import {read, sentence as asSentence} from '../base/numbers.js';
import {board} from '../base/sessions.js';

/** Make the part. */
export function createCalibrate(store) {
  const hint = element('p', {class: 'hint', role: 'status'});
  const lead = element('p', {class: 'lead'}, 'The camera learns where each pixel lies on the ' +
    'surface, from a printed board. The camera must not move from now on.');
  const undo = createUndo(() => board('undo'));
  const sheets = createSheets();
  const options = createOptions();
  const look = createBoardLook(store);
  const report = createBoardReport();
  const table = createMarkers();
  let isShown = false;
  const follow = () => {
    const isLooking = Boolean(store.get('board')) && store.get('board').step !== 'off';
    if (isShown && isLooking) look.start();
    else look.stop();
    if (isShown && store.get('markers')?.step === 'looking') table.start();
    else table.stop();
  };
  store.on('board', (state) => {
    setText(hint, asSentence(state.error) ?? state.busy ?? state.hint ?? '');
    hint.classList.toggle('error', Boolean(state.error));
    [lead, sheets, options.node].forEach((each) => show(each, state.step === 'off'));
    options.update(state);
    look.update(state);
    report.update(state);
    undo.update(state);
    follow();
  });
  store.on('markers', (state) => {
    table.update(state);
    follow();
  });
  const node = element('div', {class: 'calibrate'},
    lead, sheets, options.node, hint, undo.node, look.node, report.node, table.node);
  return {
    node,
    shown: () => { isShown = true; follow(); },
    hidden: () => { isShown = false; follow(); },
  };
}

function createSheets() {
  const paper = element('select', {id: 'paper'}, element('option', {}, 'A4'),
    element('option', {}, 'Letter'));
  const kinds = {board: 'Chessboard', charuco: 'Board with markers', markers: 'Markers'};
  const draw = async (event, kind) => {
    const clicked = event.currentTarget;
    clicked.disabled = true;
    const sheet = await attempt(() => fetchFile('/api/sheet', {
      charuco: kind === 'charuco', markers: kind === 'markers', paper: paper.value}), () => null);
    clicked.disabled = false;
    if (sheet) keepFile(sheet, `${kind}.pdf`);
  };
  const sheets = Object.entries(kinds).map(([kind, name]) =>
    button(`${name} (PDF)`, (event) => draw(event, kind)));
  return card('1. Print a board', element('p', {}, 'Print it at 100 %, measure the ruler on the ' +
    'sheet (it must be 100 mm), and glue it to something flat.'),
  element('p', {class: 'buttons'}, element('label', {for: 'paper'}, 'Paper'), paper,
    ...sheets),
  element('p', {class: 'quiet'}, 'The chessboard must lie completely in the picture. The board ' +
    'with markers may be cut off or covered in part.'));
}

function createOptions() {
  const columns = countField('corners-x', 'Inner corners in a row');
  const rows = countField('corners-y', 'Inner corners in a column');
  const square = countField('square', 'Edge of a square in mm');
  const charuco = element('input', {type: 'checkbox', id: 'charuco'});
  let isEdited = false;
  const start = button('Start', async () => { isEdited = !await board('start', {
    corners: [read(columns.input.value), read(rows.input.value)],
    square_mm: read(square.input.value), charuco: charuco.checked}); }, {class: 'primary'});
  const details = element('details', {}, element('summary', {}, 'Another board'),
    element('div', {class: 'inline-fields'}, columns.node, rows.node, square.node,
      element('p', {}, charuco, ' ', element('label', {for: 'charuco'}, 'Board with markers'))));
  details.addEventListener('input', () => { isEdited = true; });
  const update = ({options}) => {
    if (isEdited || document.activeElement?.closest('.inline-fields')) return;
    columns.input.value = options.corners[0];
    rows.input.value = options.corners[1];
    square.input.value = options.square_mm;
    charuco.checked = options.charuco;
  };
  return {update, node: card('2. Look for the board', details,
    element('div', {class: 'buttons'}, start))};
}

function countField(id, text) {
  const input = element('input', {type: 'text', inputmode: 'decimal', id, class: 'short'});
  return {input, node: element('p', {}, element('label', {for: id}, text), ' ', input)};
}
