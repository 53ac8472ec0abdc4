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

// The choice between several cells, each with nodes in a namespace of its own.

import {chosenCell} from '../base/state.js';
import {element, setText, show, sync} from '../base/dom.js';

/** Fill the choice as cells come and go; with one cell there is none. */
export function createCells(store) {
  const choice = document.getElementById('cell');
  choice.addEventListener('change', () => {
    const address = new URL(location.href);
    address.searchParams.set('cell', choice.value);
    location.assign(address);
  });
  store.on('cells', (cells) => {
    const names = [...new Set([...cells.map((each) => each.cell), chosenCell()])].sort();
    sync(choice, names, (name) => name, () => element('option'), (node, name) => {
      node.value = name;
      setText(node, name === '/' ? '/ (no namespace)' : name);
    });
    choice.value = chosenCell();
    show(document.getElementById('cell-choice'), names.length > 1);
  });
}
