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

// What the page asks the server to do. A refusal is an error with the server's sentence.

import {address} from './state.js';

const NO_ANSWER = 'The dashboard does not answer. Is it still running? Nothing was changed.';

/** An action that was refused; `errors` has a sentence for each parameter concerned. */
export class Refused extends Error {
  constructor(sentence, errors = {}) {
    super(sentence);
    this.errors = errors;
  }
}

/** Post a body to an action, and return the answer. */
export async function act(path, body = {}) {
  return answer(path, {
    method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify(body)});
}

/** Ask for JSON. */
export async function ask(path) {
  return answer(path, {});
}

/** Post a body, and return the file that is answered. */
export async function fetchFile(path, body = {}) {
  return (await request(path, {method: 'POST', body: JSON.stringify(body)})).blob();
}

/** Let the browser keep a file, in its folder for downloads. */
export function keepFile(content, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

async function answer(path, options) {
  return (await request(path, options)).json().catch(() => ({}));
}

async function request(path, options) {
  let response;
  try {
    response = await fetch(address(path), options);
  } catch {
    throw new Refused(NO_ANSWER);
  }
  if (!response.ok) {
    const content = await response.json().catch(() => ({}));
    throw new Refused(content.error ?? `The dashboard answered ${response.status}.`,
      content.errors);
  }
  return response;
}
