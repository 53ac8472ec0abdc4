# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Draws the chart of a sweep: number of frames with an object, over the parameter's value."""

from camera_to_base.commands.locate.sweep import SweepResult
import numpy as np


def sweep_picture(result: SweepResult) -> np.ndarray:
    """
    Draw the chart of a sweep; a vertical line marks the current value.

    :returns: Shape (h, w, 3), uint8, BGR.
    """
    # Not pyplot, which looks for a display and keeps the figure in memory.
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    figure = Figure((9.6, 5.4), layout='constrained')
    axes, counters = figure.add_subplot(), result.counters
    frames = max(counter.frames for counter in counters)
    axes.plot(result.values, [counter.with_any for counter in counters], 'o-',
              label='one object or more')
    axes.plot(result.values, [counter.with_one for counter in counters], 's-', label='exactly one')
    if result.values[0] <= result.current <= result.values[-1]:
        axes.axvline(result.current, color='C3', linestyle='--', label=f'now: {result.current:g}')
    axes.set(title=f'frames of {frames} with an object', xlabel=result.name, ylabel='frames')
    axes.set_ylim(bottom=0)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.grid(alpha=0.4)
    axes.legend()
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.ascontiguousarray(np.asarray(canvas.buffer_rgba())[..., 2::-1])
