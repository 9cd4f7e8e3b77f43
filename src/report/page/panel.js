// A live figure on its canvases: axes, grid, layers, cursor and the values under it.
"use strict";
const drawFigure = (() => {
  const MARGIN = { top: 6, right: 22, bottom: 24 };

  function draw(state) {
    const style = getComputedStyle(document.documentElement);
    const color = (name) => style.getPropertyValue(name).trim();
    const prepared = state.panels.map((view) => {
      const context = view.canvas.getContext("2d");
      context.font = `11.5px ${FONT}`;
      const plotHeight = view.panel.height - MARGIN.top - MARGIN.bottom - (view.below ? 20 : 0);
      const y = atLeastThree(view, Math.min(10, Math.max(2, plotHeight / 38)));
      const width = Math.max(...y.list.map((tick) => context.measureText(tick.label).width), 10);
      return { view, context, y, plotHeight, left: width + 9 };
    });
    // aligned left axes; side by side each column would only lose room, so all share the widest
    const left = Math.max(...prepared.map((panel) => panel.left));
    prepared.forEach((panel) => drawPanel(state, { ...panel, left, color }));
  }

  // One label does not show a scale.
  function atLeastThree(view, count) {
    const y = ticks(view.panel.y, view.y, count);
    return y.list.length < 3 && count < 12 ? atLeastThree(view, count + 1) : y;
  }

  function drawPanel(state, { view, context, y, plotHeight, left, color }) {
    const { canvas, panel } = view;
    const ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(panel.height * ratio);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.font = `11.5px ${FONT}`;
    const area = { left, top: MARGIN.top, width: Math.max(20, width - left - MARGIN.right), height: plotHeight };
    view.area = area;
    const px = (v) => area.left + clamp(share(panel.x, view.x, v)) * area.width;
    const py = (v) => area.top + (1 - clamp(share(panel.y, view.y, v))) * area.height;
    const x = ticks(panel.x, view.x, Math.max(1, area.width / 80));
    view.label.textContent = axisLabel(panel.y, y.exponent);
    context.lineWidth = 1;
    context.textBaseline = "middle";
    context.textAlign = "right";
    for (const tick of y.list) {
      segment(context, color("--grid"), area.left, py(tick.at), area.left + area.width, py(tick.at));
      context.fillStyle = color("--muted");
      context.fillText(tick.label, area.left - 7, py(tick.at));
    }
    context.save();
    context.beginPath();
    context.rect(area.left, area.top - 1, area.width, area.height + 2);
    context.clip();
    const [from, to] = panel.x.range.map((v) => share(panel.x, view.x, v));
    // a line that goes up and down by more than this looks like a blot under a thick pen
    const crowd = 8 * area.width / area.height * Math.abs(view.y[1] - view.y[0]) * (to - from);
    for (const layer of panel.layers.filter(isShown)) drawLayer(context, layer, px, py, area, color, crowd);
    drawCursor(context, state, view, area, color);
    context.restore();
    const foot = area.top + area.height;
    segment(context, color("--axis"), area.left, foot, area.left + area.width, foot);
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const tick of x.list) {
      segment(context, color("--axis"), px(tick.at), foot, px(tick.at), foot + 4.5);
      context.fillStyle = color("--muted");
      if (view.below) context.fillText(tick.label, px(tick.at), foot + 8);
    }
    context.fillStyle = color("--ink");
    context.font = `12px ${FONT}`;
    if (view.below) context.fillText(axisLabel(panel.x, x.exponent), area.left + area.width / 2, foot + 27);
    readOut(state, view);
  }

  function drawCursor(context, state, view, area, color) {
    const { cursor } = state;
    if (cursor && cursor.x >= 0 && cursor.x <= 1 && (cursor.view === view || state.shared)) {
      context.globalAlpha = 0.6;
      const x = area.left + cursor.x * area.width;
      segment(context, color("--muted"), x, area.top, x, area.top + area.height);
      context.globalAlpha = 1;
    }
    if (!view.box) return;
    const { from, to } = view.box;
    const high = Math.abs(to.y - from.y) * area.height > 24;
    context.fillStyle = color("--muted");
    context.globalAlpha = 0.25;
    context.fillRect(
      area.left + from.x * area.width,
      high ? area.top + from.y * area.height : area.top,
      (to.x - from.x) * area.width,
      high ? (to.y - from.y) * area.height : area.height,
    );
    context.globalAlpha = 1;
  }

  // Values of the nearest samples beside the legend, those of the panel under the cursor; the place of the cursor
  // beside the axis label.
  function readOut(state, view) {
    const { cursor } = state;
    const seen = cursor?.view ?? view;
    const here = cursor && (seen === view || state.shared);
    const at = here ? value(view.panel.x, view.x, cursor.x) : null;
    for (const { layer, reading } of view.keys) {
      const read = seen === view ? layer : counterpart(seen.panel, layer);
      const readable = here && read?.y && read.sorted && isShown(layer);
      const index = readable ? nearest(read.xs, at) : -1;
      reading.textContent = index < 0 ? "" : readOff(read.y[index], view.y);
    }
    if (cursor && cursor.view === view) {
      const height = value(view.panel.y, view.y, 1 - cursor.y);
      view.label.textContent += `   (${readOff(at, view.x)}, ${readOff(height, view.y)})`;
    }
  }

  // The layer of another panel that the same key of the legend stands for.
  function counterpart(panel, layer) {
    const look = ({ kind, color, dash, width }) => [kind, color, dash, width].join();
    return panel.layers.find((other) => look(other) === look(layer));
  }

  function nearest(xs, at) {
    let [low, high] = [0, xs.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (xs[middle] <= at) low = middle; else high = middle;
    }
    return high < 0 || Math.abs(xs[low] - at) <= Math.abs(xs[high] - at) ? Math.min(low, high) : high;
  }

  return draw;
})();
