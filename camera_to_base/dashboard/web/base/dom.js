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

// Elements of the page: made in one call, and changed only where something differs.

const SVG = 'http://www.w3.org/2000/svg';
let cards = 0;

/** Make an HTML element; `on…` properties are listeners, null and false leave a property out. */
export function element(tag, properties = {}, ...children) {
  return filled(document.createElement(tag), properties, children);
}

/** Make an SVG element, likewise. */
export function svg(tag, properties = {}, ...children) {
  return filled(document.createElementNS(SVG, tag), properties, children);
}

function filled(node, properties, children) {
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else setAttribute(node, name, value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/** Set an attribute; null removes it, and so does false, except for those of ARIA. */
export function setAttribute(node, name, value) {
  const isState = typeof value === 'boolean' && !name.startsWith('aria-');
  const text = isState ? '' : String(value);
  if (value === null || value === undefined || isState && !value) node.removeAttribute(name);
  else if (node.getAttribute(name) !== text) node.setAttribute(name, text);
}

/** Set a text only where it differs: a live region is not read out again. */
export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** Show a node or hide it. */
export function show(node, isShown) {
  if (node.hidden === Boolean(isShown)) node.hidden = !isShown;
}

/**
 * Make a parent's children those of a list, and keep what is there: focus survives.
 *
 * `keyOf(item)` names an item; `make(item)` makes its node; `update(node, item)` fills it.
 */
export function sync(parent, items, keyOf, make, update) {
  const keys = items.map((item, index) => String(keyOf(item, index)));
  const old = new Map([...parent.children].map((node) => [node.dataset.key, node]));
  // First, so that what stays is not moved: a press on a node that is moved is no click.
  old.forEach((node, key) => keys.includes(key) || node.remove());
  items.forEach((item, index) => {
    let node = old.get(keys[index]);
    if (node) old.delete(keys[index]);
    else {
      node = make(item, index);
      node.dataset.key = keys[index];
    }
    update(node, item, index);
    if (parent.children[index] !== node) parent.insertBefore(node, parent.children[index] ?? null);
  });
  while (parent.children.length > items.length) parent.lastChild.remove();
}

/** Make a table row of as many cells; the first one heads the row. */
export function row(count, properties = {}) {
  const cells = Array.from({length: count}, (_, index) =>
    index ? element('td') : element('th', {scope: 'row'}));
  return element('tr', properties, ...cells);
}

/** Fill a row's cells with texts. */
export function fillRow(node, texts) {
  texts.forEach((text, index) => setText(node.cells[index], text));
}

/** Make a table with a caption and column heads; `body` is its tbody, `heads` its first cells. */
export function table(caption, heads, properties = {}) {
  const body = element('tbody');
  const cells = heads.map((head) => element('th', {scope: 'col'}, head));
  const node = element('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': caption},
    element('table', properties, element('caption', {}, caption),
      element('thead', {}, element('tr', {}, ...cells)), body));
  return {node, body, heads: cells};
}

/** Make a card: a section with a heading. */
export function card(title, ...children) {
  cards += 1;
  const id = `card-${cards}`;
  return element('section', {class: 'card', 'aria-labelledby': id},
    element('h3', {id}, title), ...children);
}

/** Make a button. */
export function button(text, onclick, properties = {}) {
  return element('button', {type: 'button', onclick, ...properties}, text);
}

/** Make a button that brings back what was removed last; `update` takes a state with `undo`. */
export function createUndo(onclick) {
  const node = button('', onclick, {class: 'undo', hidden: true});
  const update = ({undo}) => {
    show(node, undo);
    setText(node, `Undo: ${undo}`);
  };
  return {node, update};
}
