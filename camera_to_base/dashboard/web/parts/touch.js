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

// The open object: it is seen in some frames, and then touched by the robot.

import {button, card, element, setText, show} from '../base/dom.js';
import {point, sentence as asSentence} from '../base/numbers.js';

/** Make the card of a session, `run`; `add` is the button, `label` what is typed. */
export function createTouch(run, {id, label, add}) {
  const sentence = element('p', {role: 'status'});
  const bar = element('progress', {max: 20, value: 0, 'aria-label': 'Frames that show the object'});
  const input = element('input', {type: 'text', id, autocomplete: 'off',
    'aria-describedby': `${id}-help`});
  const typed = element('form', {class: 'buttons', onsubmit: async (event) => {
    event.preventDefault();
    if (await run('touch', {text: input.value})) input.value = '';
    else input.focus();
  }}, element('label', {for: id}, label), input,
  element('button', {class: 'primary'}, add));
  const help = element('p', {class: 'quiet', id: `${id}-help`},
    'In cm: 12.5 -3.4. With another unit, write it: 125 -34 mm.');
  const topic = createTopic(run, `${id}-topic`);
  const body = element('div', {}, bar, typed, help, topic.node);
  const node = card('2. Touch it with the robot', sentence, body);
  const update = ({step, open, tool}) => {
    show(node, step !== 'off');
    setText(sentence, open ? asSentence(open.sentence) : 'First choose the object that the robot will touch.');
    show(body, open);
    if (!open) return;
    const isSeen = open.frames >= open.of;
    bar.max = open.of;
    bar.value = open.frames;
    show(bar, !isSeen);
    show(typed, isSeen);
    show(help, isSeen);
    show(topic.node, isSeen);
    topic.update(tool);
  };
  return {node, update};
}

function createTopic(run, id) {
  const input = element('input', {type: 'text', id, autocomplete: 'off',
    placeholder: '/tool_pose'});
  const state = element('p', {class: 'quiet', role: 'status'});
  const take = button('Take it from the topic', () => run('from_topic', {topic: input.value}));
  let known = '';
  const update = (tool) => {
    if (tool.topic !== known && document.activeElement !== input) {
      input.value = tool.topic;
      known = tool.topic;
    }
    setText(state, tool.sentence ?? (tool.position ? `The tool is at ${point(tool.position)} cm.` : ''));
  };
  const node = element('details', {}, element('summary', {},
    "Or take it from a topic of the robot's driver"),
  element('p', {class: 'buttons'}, element('label', {for: id},
    'Topic (geometry_msgs/PoseStamped)'), input, take), state);
  return {node, update};
}
