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

// Short messages at the page's edge; a screen reader reads them out.

import {button, element} from './dom.js';
import {sentence as asSentence} from './numbers.js';

const SHOWN_MS = 8000;

/** Show a message; one that tells of an error stays until it is closed. */
export function notice(sentence, level = 'info') {
  const place = document.getElementById('notices');
  const note = element('div', {class: `notice ${level}`}, element('p', {}, asSentence(sentence)));
  note.append(button('Close', () => note.remove(), {class: 'quiet'}));
  place.append(note);
  while (place.children.length > 3) place.firstChild.remove();
  if (level !== 'error') setTimeout(() => note.remove(), SHOWN_MS);
}

/** Run an action; say what it answers, or why it was refused. Return the answer or null. */
export async function attempt(action, said = (answer) => answer.sentence) {
  try {
    const answer = await action();
    const sentence = said(answer);
    if (sentence) notice(sentence);
    return answer;
  } catch (error) {
    notice(error.message, 'error');
    return null;
  }
}
