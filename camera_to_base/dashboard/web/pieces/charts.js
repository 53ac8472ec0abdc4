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

// Charts, drawn by uPlot: numbers over the last minutes, and points in a plane.

import {button, element, setAttribute, setText} from '../base/dom.js';
import {fixed} from '../base/numbers.js';

/** The longest time that a chart shows. */
export const LONGEST_S = 600;

const UPLOT = '/web/vendor/uplot/uPlot.iife.min.js';
const SPANS = {60: '1 min', 180: '3 min', [LONGEST_S]: '10 min'};
const TIME_STEPS_S = [5, 10, 15, 30, 60, 120, 180];
const HEIGHT = 110;
// The same room beside both axes of a plane: a millimetre is as long upwards as sideways.
const [WIDE, HIGH, MARGIN] = [52, 30, 14];
const FONT_REM = 0.75;
// Ticks of time are wider than others.
const TIME_SPACE = 64;
const DARK = matchMedia('(prefers-color-scheme: dark)');
let loading = null;

/** Load uPlot when the first chart is seen: the first picture does not wait for it. */
function loadUplot() {
  loading ??= new Promise((resolve) => document.head.append(element('script', {src: UPLOT,
    onload: () => resolve(window.uPlot), onerror: (event) => {
      event.target.remove();
      loading = null;
      resolve(null);
    }})));
  return loading;
}

/** Make the choice of how long a time is shown; `onchange(seconds)` is called with another one. */
export function createSpans(onchange) {
  const choices = Object.entries(SPANS).map(([seconds, name], index) => button(name, (event) => {
    choices.forEach((one) => setAttribute(one, 'aria-pressed', one === event.currentTarget));
    onchange(Number(seconds));
  }, {'aria-pressed': index === 0}));
  return element('div', {class: 'choices', role: 'group', 'aria-label': 'Time that is shown'}, ...choices);
}

/**
 * Make a chart of a number over time; a number that is missing leaves a gap.
 *
 * `update({times, values, span, now, text})` draws the values, which were measured at the times, up
 * to `now`, all in s; `text` says what the last value and their range are.
 */
export function createTimeChart(title, unit, {decimals = 1, range}) {
  let shown = {times: [], values: [], span: 60, now: 0};
  const current = element('strong');
  const words = element('span', {class: 'quiet'});
  const box = element('div', {class: 'chart', role: 'img', 'aria-label': title});
  const say = (index) => {
    const value = shown.values[index ?? shown.values.length - 1] ?? null;
    const back = shown.now - shown.times[index];
    setText(current, (value === null ? '–' : `${fixed(value, decimals)} ${unit}`) +
      (index === null || back < 1 ? '' : `, ${tickOf(-back, shown.span).slice(1)} ago`));
  };
  const plot = new Plot(box, () => HEIGHT, () => ({
    scales: {x: {time: false, range: () => [-shown.span, 0]}, y: {range: (_, low, high) => range(low, high)}},
    series: [{}, {stroke: () => colour('--accent'), width: 2, points: {show: false}}],
    axes: [axis({size: HIGH, space: TIME_SPACE, incrs: TIME_STEPS_S, values: (_, ticks) =>
      ticks.map((seconds) => tickOf(seconds, shown.span))}), axis({size: WIDE, space: 24})],
    cursor: {drag: {x: false, y: false}, y: false},
    hooks: {setCursor: [({cursor}) => say(cursor.idx ?? null)]},
  }));
  const update = (next) => {
    shown = next;
    say(plot.pointed);
    setText(words, next.text);
    setAttribute(box, 'aria-label', `${title}: ${current.textContent}, ${next.text}`);
    plot.draw([next.times.map((time) => time - next.now), next.values]);
  };
  const node = element('figure', {class: 'chart-box'},
    element('figcaption', {}, `${title} `, current), box, words);
  return {node, update};
}

/** Make a chart of points in a plane around its middle; `update(xs, ys, most, label)` draws them. */
export function createPlane() {
  let most = 1;
  const scale = {time: false, range: () => [-most, most]};
  const box = element('div', {class: 'chart plane', role: 'img'});
  const plot = new Plot(box, (width) => width - WIDE + HIGH, () => ({
    scales: {x: scale, y: scale},
    series: [{}, {stroke: () => colour('--accent'), paths: () => null,
      points: {show: true, size: 4, width: 0, fill: () => colour('--accent')}}],
    axes: [axis({size: HIGH}), axis({size: WIDE})],
    cursor: {show: false},
  }));
  const update = (xs, ys, widest, label) => {
    most = widest;
    setAttribute(box, 'aria-label', label);
    // uPlot takes its points from left to right.
    const order = xs.map((_, index) => index).sort((one, other) => xs[one] - xs[other]);
    plot.draw([order.map((index) => xs[index]), order.map((index) => ys[index])]);
  };
  return {node: box, update};
}

/** A plot that is as wide as its box, and is drawn only while that is seen. */
class Plot {
  #box;
  #plot = null;
  #data = null;
  #width = 0;
  #isMaking = false;

  constructor(box, heightOf, options) {
    this.#box = box;
    new ResizeObserver(([{contentRect: {width}}]) => {
      this.#width = Math.floor(width);
      if (!this.#width) return;
      this.#plot?.setSize({width: this.#width, height: heightOf(this.#width)});
      this.draw(this.#data);
    }).observe(box);
    DARK.addEventListener('change', () => this.#plot?.redraw(false));
    this.make = (uPlot) => new uPlot({width: this.#width, height: heightOf(this.#width),
      legend: {show: false}, padding: [MARGIN, MARGIN, 0, 0], ...options()}, this.#data, box);
  }

  /** The index of the point below the pointer; null for none. */
  get pointed() {
    return this.#plot?.cursor.idx ?? null;
  }

  async draw(data) {
    this.#data = data;
    if (!this.#width || !data || this.#isMaking) return;
    if (this.#plot) {
      this.#plot.setData(data);
      return;
    }
    this.#isMaking = true;
    const uPlot = await loadUplot();
    this.#isMaking = false;
    if (uPlot && this.#width) this.#plot = this.make(uPlot);
  }
}

function axis(options) {
  const size = FONT_REM * parseFloat(getComputedStyle(document.documentElement).fontSize);
  return {font: `${size}px system-ui, sans-serif`, stroke: () => colour('--quiet'),
    grid: {stroke: () => colour('--line'), width: 1}, ticks: {show: false}, gap: 6, values: (_, ticks) => ticks.map((one) => String(one).replace('-', '−')),
    ...options};
}

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function tickOf(seconds, span) {
  if (!seconds) return 'now';
  return span > 120 && seconds % 60 === 0 ? `−${-seconds / 60} min` : `−${fixed(-seconds, 0)} s`;
}
