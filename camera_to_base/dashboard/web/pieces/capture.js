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

// What is kept of the moment: a snapshot as a file, or a recording that can be played as the camera.

import {fetchFile, keepFile} from '../base/actions.js';
import {button, element, setText, show} from '../base/dom.js';
import {attempt} from '../base/notices.js';
import {fixed, sentence as asSentence} from '../base/numbers.js';
import {record} from '../base/sessions.js';

/** Make the buttons. */
export function createCapture(store) {
  const snapshot = button('Snapshot', async () => {
    snapshot.disabled = true;
    const file = await attempt(() => fetchFile('/api/snapshot'), () => null);
    snapshot.disabled = false;
    if (file) keepFile(file, `snapshot_${new Date().toISOString().slice(0, 19).replaceAll(':', '-')}.zip`);
  }, {title: 'The picture, its mask, its positions and the parameters as one file'});
  let isOn = false;
  const toggle = button('Record', () => record(isOn ? 'stop' : 'start'));
  const said = element('p', {class: 'quiet', role: 'status'});
  store.on('record', ({step, seconds, of, error, sentence}) => {
    isOn = step === 'recording';
    toggle.disabled = step === 'writing';
    toggle.classList.toggle('recording', isOn);
    setText(toggle, isOn ? `Stop recording: ${fixed(seconds, 0)} of ${of} s` :
      step === 'writing' ? 'Writing …' : 'Record');
    setText(said, asSentence(error ?? sentence ?? ''));
    said.classList.toggle('field-error', Boolean(error));
    show(said, error ?? sentence);
  });
  return {node: element('div', {class: 'capture'},
    element('div', {class: 'buttons'}, snapshot, toggle), said)};
}
