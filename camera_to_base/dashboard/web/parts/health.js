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

// Health: what each node says of itself, its counters, the rates, and the last messages.

import {createSpans, createTimeChart, LONGEST_S} from '../pieces/charts.js';
import {card, element, fillRow, row, setAttribute, setText, show, sync, table} from '../base/dom.js';
import {ago, clock, fixed, sentence as asSentence} from '../base/numbers.js';

const WORDS = {ok: 'Well', warn: 'Warning', error: 'Fault', stale: 'Silent'};
const SEVERITY = {debug: 0, info: 1, warn: 2, error: 3, fatal: 4};

/** Make the part. */
export function createHealth(store) {
  const whole = element('p', {class: 'sentence'}, element('span', {class: 'mark'}),
    element('span', {id: 'cell-state'}));
  const nodes = element('div', {class: 'nodes'});
  const none = element('p', {}, 'No node has said anything yet.');
  const charts = createCharts();
  const log = createLog();
  store.on('health', (health) => {
    show(none, !health.nodes.length);
    fillState(whole, health.state);
    sync(nodes, health.nodes, (node) => node.name, makeNode, (node, told) => {
      fillNode(node, told);
      // What is the cell's state is read there.
      show(node.querySelector('.sentence'), told.sentence !== health.state.sentence);
    });
    charts.update(health.charts);
  });
  store.on('log', log.update);
  return {node: element('div', {},
    card('State', whole),
    card('Nodes', none, nodes),
    card('Rate and latency', charts.node),
    card('Messages', log.node))};
}

function fillState(node, {level, sentence}) {
  setAttribute(node.firstChild, 'class', `mark pill ${level}`);
  setText(node.firstChild, WORDS[level] ?? 'Set-up');
  setText(node.lastChild, ` ${asSentence(sentence)}`);
}

function makeNode({name}) {
  const counters = table(`Counters of ${name}`, ['What', 'Value']);
  return element('article', {class: 'node'},
    element('h4', {}, element('span', {class: 'mark'}), ` ${name}`),
    element('p', {class: 'sentence'}),
    element('p', {class: 'quiet'}),
    element('details', {}, element('summary', {}, 'Counters and details'), counters.node));
}

function fillNode(node, {level, sentence, reason, age_s: age, values}) {
  const mark = node.querySelector('.mark');
  setAttribute(mark, 'class', `mark pill ${level}`);
  setText(mark, WORDS[level] ?? level);
  setText(node.children[1], asSentence(sentence));
  setText(node.children[2], `${ago(age)}${reason && reason !== 'ok' ? ` · ${reason}` : ''}`);
  const pairs = Object.entries(values ?? {});
  sync(node.querySelector('tbody'), pairs, ([key]) => key, () => row(2),
    (line, [key, value]) => fillRow(line, [key.replaceAll('_', ' '), String(value)]));
}

function createCharts() {
  const kept = {rate_hz: [], latency_ms: []};
  let count = 0;
  let span = 60;
  const range = (low, high) => [0, 1.1 * high || 1];
  const charts = {rate_hz: ['Rate', 'Hz'], latency_ms: ['Latency', 'ms']};
  for (const [name, [title, unit]] of Object.entries(charts)) {
    charts[name] = {unit, ...createTimeChart(title, unit, {range})};
  }
  const draw = () => {
    for (const [name, {unit, update}] of Object.entries(charts)) {
      const values = kept[name].slice(-span);
      const known = values.filter((value) => value !== null);
      const time = span === 60 ? 'minute' : `${span / 60} minutes`;
      update({values, times: values.map((_, index) => index - values.length + 1), span, now: 0,
        text: known.length ? `${fixed(Math.min(...known), 1)} to ${fixed(Math.max(...known), 1)} ${unit} ` +
          `in the last ${time}` : `nothing in the last ${time}`});
    }
  };
  /** Add what is new among the values of the last minute, one for each second, the newest last. */
  const update = (told) => {
    if (told.count < count) Object.values(kept).forEach((values) => values.splice(0));
    const added = told.count < count ? told.count : told.count - count;
    count = told.count;
    for (const [name, values] of Object.entries(kept)) {
      const newest = added ? told[name].slice(-added) : [];
      values.push(...Array(added - newest.length).fill(null).slice(-LONGEST_S), ...newest);
      values.splice(0, values.length - LONGEST_S);
    }
    draw();
  };
  const spans = createSpans((seconds) => {
    span = seconds;
    draw();
  });
  return {update, node: element('div', {}, spans, element('div', {class: 'charts'},
    ...Object.values(charts).map(({node}) => node)))};
}

function createLog() {
  const choice = element('select', {id: 'log-level'},
    element('option', {value: 'info'}, 'all'),
    element('option', {value: 'warn'}, 'warnings and errors'),
    element('option', {value: 'error'}, 'errors'));
  const list = table('Last hundred messages, the newest first', ['Time', 'Level', 'Node', 'Text'],
    {class: 'log'});
  let messages = [];
  const draw = () => {
    const least = SEVERITY[choice.value];
    const shown = messages.filter(({level}) => (SEVERITY[level] ?? 1) >= least).reverse();
    sync(list.body, shown, ({time, text}) => `${time} ${text}`, () => row(4), (line, message) => {
      setAttribute(line, 'class', message.level);
      fillRow(line, [clock(message.time), message.level, message.node, message.text]);
    });
  };
  choice.addEventListener('change', draw);
  const update = (items) => {
    messages = items;
    draw();
  };
  return {update, node: element('div', {class: 'log-box'}, element('p', {},
    element('label', {for: 'log-level'}, 'Show '), choice), list.node)};
}
