// What the live figures draw on a canvas: lines, dots, bands and words of one layer.
"use strict";
const FONT = "Inter, system-ui, 'DejaVu Sans', sans-serif";

// canvas coordinates beyond this are cut off by some browsers
const clamp = (s) => Math.min(1e4, Math.max(-1e4, s));

function segment(context, style, x1, y1, x2, y2) {
  context.strokeStyle = style;
  context.beginPath();
  context.moveTo(x1, y1);
  context.lineTo(x2, y2);
  context.stroke();
}

function drawLayer(context, layer, px, py, area, color, crowd) {
  context.strokeStyle = context.fillStyle = color(layer.color);
  const crowded = layer.kind === "line" && layer.travel > crowd;
  context.lineWidth = Math.min(layer.width || 1.5, crowded ? 0.9 : 10);
  context.lineJoin = "round";
  context.setLineDash({ dashed: [6, 4], dotted: [1.5, 3] }[layer.dash] || []);
  const [right, foot] = [area.left + area.width, area.top + area.height];
  const kinds = {
    line: () => { trace(context, layer.xs, layer.y, px, py); context.stroke(); },
    dots: () => {
      context.globalAlpha = layer.alpha;
      layer.xs.forEach((x, i) => {
        if (x === null || layer.y[i] === null) return;
        context.beginPath();
        context.arc(px(x), py(layer.y[i]), layer.radius, 0, 7);
        context.fill();
      });
    },
    band: () => {
      context.globalAlpha = layer.alpha;
      context.beginPath();
      const whole = layer.xs.map((_, i) => i).filter((i) => layer.low[i] !== null && layer.high[i] !== null);
      whole.forEach((i) => context.lineTo(px(layer.xs[i]), py(layer.high[i])));
      whole.reverse().forEach((i) => context.lineTo(px(layer.xs[i]), py(layer.low[i])));
      context.fill();
    },
    shade: () => {
      context.globalAlpha = layer.alpha;
      layer.ranges.forEach(([a, b]) => context.fillRect(px(a), area.top, px(b) - px(a), area.height));
    },
    hline: () => segment(context, color(layer.color), area.left, py(layer.at), right, py(layer.at)),
    vline: () => segment(context, color(layer.color), px(layer.at), area.top, px(layer.at), foot),
    bars: () => layer.xs.forEach((x, i) => {
      if ([x, layer.y[i], layer.low[i], layer.high[i]].includes(null)) return;
      const ends = [py(layer.low[i]), py(layer.high[i])];
      segment(context, color(layer.color), px(x), ends[0], px(x), ends[1]);
      ends.forEach((y) => segment(context, color(layer.color), px(x) - 3.5, y, px(x) + 3.5, y));
      context.beginPath();
      context.arc(px(x), py(layer.y[i]), 3.2, 0, 7);
      context.fill();
    }),
  };
  kinds[layer.kind]();
  context.globalAlpha = 1;
  context.setLineDash([]);
}

function trace(context, xs, ys, px, py) {
  context.beginPath();
  let broken = true;
  xs.forEach((x, i) => {
    if (x === null || ys[i] === null) { broken = true; return; }
    if (broken) context.moveTo(px(x), py(ys[i])); else context.lineTo(px(x), py(ys[i]));
    broken = false;
  });
}
