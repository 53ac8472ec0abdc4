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

// The report of a fitted board, and the button that puts it to use.

import {button, card, element, setAttribute, setText, show, sync} from '../base/dom.js';
import {fixed, sentence as asSentence} from '../base/numbers.js';
import {board} from '../base/sessions.js';

/** Make the card. */
export function createBoardReport() {
  const figures = element('dl', {class: 'figures'});
  const warnings = element('ul', {class: 'warnings'});
  const pictures = element('div', {class: 'report-pictures'});
  const lines = element('pre', {tabindex: 0});
  const full = element('a', {target: '_blank', rel: 'noopener'}, 'The report as text');
  const drops = element('p', {class: 'warnings'});
  const accept = button('Accept: use it now', () => board('accept'), {class: 'primary'});
  const done = element('p', {class: 'verdict good', role: 'status'});
  const clear = element('span', {}, 'clear the table and ', element('a', {href: '#detect'},
    'take the background'), ', then ');
  const next = element('p', {}, 'Next: ', clear, element('a', {href: '#robot'},
    'touch objects with the robot'), '.');
  const after = element('div', {class: 'accepted'}, done, next);
  const body = element('div', {}, figures, warnings, pictures,
    element('details', {}, element('summary', {}, 'All figures'), lines, full), drops,
    element('div', {class: 'buttons'}, accept));
  const node = card('4. Check the report', body, after);
  const update = ({report, busy, would_drop: dropped, accepted}) => {
    show(node, report || accepted);
    show(body, report);
    show(after, accepted);
    show(clear, !accepted?.has_background);
    setText(done, accepted?.sentence ?? '');
    accept.disabled = Boolean(busy) || Boolean(accepted);
    setText(drops, dropped?.length && !accepted
      ? `When you accept, these must be measured again: ${dropped.join(', ')}.` : '');
    if (report) fill(report);
  };
  const fill = (report) => {
    sync(figures, figuresOf(report), ([name]) => name,
      ([name]) => element('div', {}, element('dt', {}, name), element('dd')),
      (item, [, text]) => setText(item.lastChild, text));
    sync(warnings, report.warnings, (text) => text, () => element('li'), setText);
    sync(pictures, report.pictures ?? [], ({title}) => title, makePicture, fillPicture);
    setText(lines, report.lines.join('\n'));
    setAttribute(full, 'href', report.text_url);
    show(full, report.text_url);
  };
  return {node, update};
}

function figuresOf({held_out_mm: heldOut, rms_mm: rms, largest_mm: largest, covered, placements,
  error_map_mm: map}) {
  const errors = (map ?? []).flat().filter((value) => value !== null);
  return [
    ['Error at points that were not fitted', `${fixed(heldOut, 2)} mm`],
    ['Error at the fitted points', `${fixed(rms, 2)} mm, ${fixed(largest, 2)} mm at most`],
    ['Covered', `${fixed(100 * covered, 0)} % of the picture, ${placements} ` +
      (placements === 1 ? 'placement' : 'placements')],
    ...(errors.length ? [['Expected error over the picture',
      `${fixed(Math.min(...errors), 2)} to ${fixed(Math.max(...errors), 2)} mm`]] : []),
  ];
}

function makePicture() {
  return element('figure', {}, element('a', {target: '_blank', rel: 'noopener'}, element('img')),
    element('figcaption'));
}

function fillPicture(node, {title, url}) {
  setAttribute(node.firstChild, 'href', url);
  setAttribute(node.querySelector('img'), 'src', url);
  setAttribute(node.querySelector('img'), 'alt', `${title}. The figures above say the same.`);
  setText(node.lastChild, asSentence(title));
}
