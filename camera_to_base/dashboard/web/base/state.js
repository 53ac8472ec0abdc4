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

// The state of a cell as the server sends it, and the connection that it comes by.

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 4000;
// A socket that is closed and opened again within this time is not worth a word.
const PATIENCE_MS = 2000;
// The node behind the page tells of itself each second: on a line that is cut, nothing is closed.
const SILENT_MS = 5000;

/** The newest data of each part; who listens to a part is called with what came, and at once. */
export class Store {
  #parts = new Map();
  #listeners = new Map();

  on(part, listener) {
    this.#listeners.set(part, [...(this.#listeners.get(part) ?? []), listener]);
    if (this.#parts.has(part)) listener(this.#parts.get(part));
  }

  get(part) {
    return this.#parts.get(part);
  }

  set(part, data) {
    this.#parts.set(part, data);
    for (const listener of this.#listeners.get(part) ?? []) listener(data);
  }
}

/** Address of a socket or an action for the chosen cell. */
export function address(path, query = {}) {
  const url = new URL(path, location.href);
  url.search = new URLSearchParams({cell: chosenCell(), ...query});
  return url;
}

/** The cell that the address names; the root namespace where it names none. */
export function chosenCell() {
  return new URLSearchParams(location.search).get('cell') || '/';
}

/** Open a WebSocket of the chosen cell. */
export function socket(path, query) {
  const url = address(path, query);
  url.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
  return new WebSocket(url);
}

/** Keep the store filled; `connection` is 'open', 'lost' or a sentence of refusal. */
export function connect(store) {
  let wait = FIRST_WAIT_MS;
  let lost = null;
  let silent = null;
  const open = () => {
    const line = socket('/ws/state', {confirms: 'yes'});
    const waitOn = () => {
      clearTimeout(silent);
      silent = setTimeout(() => {
        store.set('connection', 'lost');
        line.close();
      }, SILENT_MS);
    };
    line.onopen = waitOn;
    line.onmessage = (message) => {
      wait = FIRST_WAIT_MS;
      line.send('got');
      waitOn();
      clearTimeout(lost);
      lost = null;
      store.set('connection', 'open');
      const {part, data} = JSON.parse(message.data);
      store.set(part, data);
    };
    line.onclose = (event) => {
      clearTimeout(silent);
      if (event.code === 1008 && event.reason) {
        clearTimeout(lost);
        store.set('connection', event.reason);
      } else lost ??= setTimeout(() => store.set('connection', 'lost'), PATIENCE_MS);
      setTimeout(open, wait);
      wait = Math.min(2 * wait, LONGEST_WAIT_MS);
    };
  };
  open();
}
