// The curves of a live figure: their numbers, which of them are shown, and the range that they fill.
"use strict";
// the model whose curves the reader chose, on the whole page
const display = { version: "both" };

// Numbers as the page stores them: as they are, or the differences of their multiples of a power of ten.
function column(stored) {
  if (!stored || Array.isArray(stored)) return stored;
  const power = Math.pow(10, stored.d);
  let sum = 0;
  return stored.v.map((step) => (step === null ? null : (sum += step) / power));
}

function prepare(panel, xs) {
  panel.layers.forEach((layer) => {
    layer.xs = column(xs[layer.x]) || [];
    ["y", "low", "high"].forEach((name) => { layer[name] = column(layer[name]); });
    layer.travel = travel(layer.y || []);
    layer.sorted = layer.xs.every((v, i) => i === 0 || v === null || v >= layer.xs[i - 1]);
  });
}

// All ups and downs of a curve added.
function travel(ys) {
  return ys.reduce((sum, y, i) => sum + (i && y !== null && ys[i - 1] !== null ? Math.abs(y - ys[i - 1]) : 0), 0);
}

const isShown = (layer) =>
  !layer.off && (display.version === "both" || !layer.version || layer.version === display.version);

// The y range of what is seen, as long as the reader chose none.
function rescale(view) {
  if (view.fixed) return;
  const whole = view.x.every((v, i) => v === view.panel.x.range[i]) && view.panel.layers.every(isShown);
  if (whole) { view.y = [...view.panel.y.range]; return; }
  let [low, high] = [Infinity, -Infinity];
  const see = (y) => { if (y !== null) { low = Math.min(low, y); high = Math.max(high, y); } };
  for (const layer of view.panel.layers.filter((l) => l.y && isShown(l))) {
    layer.xs.forEach((x, i) => {
      if (x === null || x < view.x[0] || x > view.x[1]) return;
      see(layer.y[i]);
      if (layer.kind === "bars") { see(layer.low[i]); see(layer.high[i]); }
    });
  }
  if (!(high > low)) return;
  const log = view.panel.y.log;
  const room = log ? Math.pow(high / low, 0.06) : 0.06 * (high - low);
  view.y = log ? [low / room, high * room] : [low - room, high + room];
}
