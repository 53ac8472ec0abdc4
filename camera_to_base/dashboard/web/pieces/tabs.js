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

// The tabs: one part of the page is shown at a time, and the address names it.

import {element, show, svg} from '../base/dom.js';

const ICONS = {
  watch: 'M2 12s4-7 10-7 10 7 10 7-4 7-10 7S2 12 2 12zM12 9a3 3 0 1 0 .01 0',
  detect: 'M3 7h9M18 7h3M15 4a3 3 0 1 0 .01 0M3 17h3M12 17h9M9 14a3 3 0 1 0 .01 0',
  calibrate: 'M4 4h16v16H4zM12 4v16M4 12h16M5 8h6M13 16h6M8 5v6M16 13v6',
  robot: 'M4 21h9M8.500 21v-6L12 8l6 2M12 5.500a2.500 2.500 0 1 0 .01 0M18 10l3-2M18 10l2 4',
  prove: 'M12 3a9 9 0 1 0 .01 0M12 7.500a4.500 4.500 0 1 0 .01 0M12 12h.01M12 1v4M12 19v4M1 12h4M19 12h4',
  health: 'M2 12h5l3-8 4 16 3-8h5',
  save: 'M5 4h11l3 3v13H5zM8 4v5h7V4M8 20v-6h8v6',
};
const STEPS = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1};

/**
 * Make the tabs.
 *
 * `parts` has a title and a part for each name; a part has `node`, and `shown()` and `hidden()`
 * where it has something to start or to stop. `offer(names)` of what is returned shows some tabs alone.
 */
export function createTabs(list, main, parts) {
  let names = Object.keys(parts);
  let current = null;
  for (const name of names) {
    const [title, part] = parts[name];
    list.append(tab(name, title, () => { location.hash = name; }));
    main.append(panel(name, title, part.node));
  }
  list.addEventListener('keydown', (event) => moveFocus(event, names, current));
  const choose = () => {
    const name = names.includes(location.hash.slice(1)) ? location.hash.slice(1) : names[0];
    if (name === current) return;
    if (current) parts[current][1].hidden?.();
    Object.keys(parts).forEach((each) => mark(each, each === name));
    document.title = `${parts[name][0]} · camera_to_base`;
    current = name;
    scrollTo(0, 0);
    parts[name][1].shown?.();
  };
  addEventListener('hashchange', choose);
  document.addEventListener('visibilitychange', () => {
    parts[current][1][document.hidden ? 'hidden' : 'shown']?.();
  });
  choose();
  const offer = (offered) => {
    names = offered;
    Object.keys(parts).forEach((name) => show(document.getElementById(`tab-${name}`), names.includes(name)));
    choose();
  };
  return {offer};
}

function tab(name, title, onclick) {
  return element('button', {
    type: 'button', role: 'tab', id: `tab-${name}`, 'aria-controls': `part-${name}`, onclick,
  }, svg('svg', {viewBox: '0 0 24 24', class: 'icon', 'aria-hidden': 'true'},
    svg('path', {d: ICONS[name]})), element('span', {}, title));
}

function panel(name, title, node) {
  return element('section', {
    role: 'tabpanel', id: `part-${name}`, 'aria-labelledby': `tab-${name}`, hidden: true,
  }, element('h2', {}, title), node);
}

function mark(name, isCurrent) {
  const tabNode = document.getElementById(`tab-${name}`);
  tabNode.setAttribute('aria-selected', isCurrent);
  tabNode.tabIndex = isCurrent ? 0 : -1;
  document.getElementById(`part-${name}`).hidden = !isCurrent;
}

function moveFocus(event, names, current) {
  const here = names.indexOf(current);
  const next = {Home: 0, End: names.length - 1}[event.key] ?? (
    event.key in STEPS ? (here + STEPS[event.key] + names.length) % names.length : null);
  if (next === null) return;
  event.preventDefault();
  location.hash = names[next];
  document.getElementById(`tab-${names[next]}`).focus();
}
