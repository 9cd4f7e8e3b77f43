// What if a parameter had another value: recordings simulated by the identified model of model.js.
"use strict";
const whatIf = (() => {
  // The steps of the time have 32 bits, of which ten nanoseconds are kept; signals are whole steps above their least value.
  const decoded = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const floats = (text) => new Float32Array(decoded(text).buffer);
  const signal = ({ bytes, least, step, values }) => {
    const from = decoded(values);
    const whole = (k) => from.subarray(bytes * k, bytes * (k + 1)).reduceRight((sum, byte) => 256 * sum + byte, 0);
    return Float64Array.from({ length: from.length / bytes }, (_, k) => least + whole(k) * step);
  };
  const pairs = ([a, b]) => { const second = signal(b); return Array.from(signal(a), (v, k) => [v, second[k]]); };

  function recording(data) {
    const t = [data.start];
    for (const step of floats(data.steps)) t.push(t[t.length - 1] + Math.round(step * 1e8) / 1e8);
    const starts = data.starts.map(([row, isPiece, [a1, a2, w1, w2]]) => (
      { row, isPiece, alpha: [a1, a2], omega: [w1, w2] }));
    return { t, input: pairs(data.input), omega: pairs(data.omega), starts };
  }

  // Speeds of the free simulation, which starts anew behind gaps, with the two errors of the program.
  function simulate(robot, { t, input, omega, starts }) {
    const acting = robot.acting(t, input);
    const from = (list) => {
      let last = null;
      return list.flatMap((start, k) => {
        const end = k + 1 < list.length ? list[k + 1].row : t.length;
        const before = start.isPiece ? null : last;
        last = robot.motion(t, acting, start.row, end, start.alpha, start.omega, before);
        return last.omega;
      });
    };
    const pieces = starts.filter((start) => start.isPiece);
    const free = from(pieces);
    return { free, ise: ise(t, errors(omega, free), pieces), rms: rms(errors(omega, from(starts))) };
  }

  // Squared errors of both wheels, row by row.
  const errors = (measured, simulated) => measured.map((w, k) =>
    (w[0] - simulated[k][0]) ** 2 + (w[1] - simulated[k][1]) ** 2);

  const rms = (squares) => Math.sqrt(squares.reduce((sum, e) => sum + e, 0) / (2 * squares.length));

  // Integral of the squared errors by trapezia, without the gaps before pieces.
  function ise(t, squares, pieces) {
    const begins = new Set(pieces.map((piece) => piece.row));
    return squares.reduce((sum, e, k) =>
      (begins.has(k) ? sum : sum + 0.5 * (t[k] - t[k - 1]) * (squares[k - 1] + e)), 0);
  }

  return { recording, simulate };
})();

for (const box of typeof document === "undefined" ? [] : document.querySelectorAll(".what-if")) {
  const data = JSON.parse(box.querySelector("script").textContent);
  const sliders = [...box.querySelectorAll(".slider")].map((row, k) => (
    { ...data.parameters[k], input: row.querySelector("input"), said: row.querySelector("output") }));
  const numbers = [...box.querySelectorAll(".numbers div")].map((part) => (
    { value: part.querySelector("output"), note: part.querySelector(".note") }));
  // points drawn of a curve, how far beyond the measured speeds a panel reaches at most, and the time between two
  // simulations while a slider moves [ms]
  const [POINTS, FAR, FRAME] = [2000, 2, 16];
  let [shown, measured, identified, state, waiting] = [null, null, null, null, false];
  box.hidden = false;

  function values() {
    return Object.fromEntries(sliders.map((s) => [s.name, s.value + Number(s.input.value) * s.step]));
  }

  function choose(number) {
    shown = data.recordings[number];
    measured = whatIf.recording(shown);
    identified = whatIf.simulate(model(), measured);
    box.querySelector(".recording").textContent = shown.name;
    const { t } = measured;
    const stride = Math.ceil(t.length / POINTS);
    data.figure.xs = [t.filter((_, k) => k % stride === 0)];
    draw([measured.omega, identified.free, identified.free], stride);
    data.figure.panels.forEach((panel) => { panel.x.range = [t[0], t[t.length - 1]]; });
    if (state) live.load(state, data.figure); else state = live.build(box.querySelector("figure"), data.figure);
    update();
  }

  // Fills the curves of both panels, those that are given.
  function draw(curves, stride) {
    data.figure.panels.forEach((panel, wheel) => {
      curves.forEach((rows, k) => {
        if (!rows) return;
        const ys = rows.filter((_, row) => row % stride === 0).map((row) => row[wheel]);
        Object.assign(panel.layers[k], { x: 0, y: ys.map((y) => (Number.isFinite(y) ? y : null)) });
      });
      panel.y.range = range(panel.layers.map((layer) => layer.y));
    });
  }

  function range([first, ...others]) {
    const ends = (ys) => ys.reduce(([a, b], y) => (y === null ? [a, b] : [Math.min(a, y), Math.max(b, y)]), [0, 0]);
    const [low, high] = ends(first);
    const reach = FAR * Math.max(high - low, 1e-6);
    const all = others.map(ends);
    const least = Math.max(low - reach, Math.min(low, ...all.map((e) => e[0])));
    const most = Math.min(high + reach, Math.max(high, ...all.map((e) => e[1])));
    const room = 0.06 * (most - least);
    return [least - room, most + room];
  }

  function update() {
    waiting = false;
    const now = whatIf.simulate(model(values()), measured);
    draw([null, null, now.free], Math.ceil(measured.t.length / POINTS));
    live.update(state);
    sliders.forEach(tell);
    const floor = shown.floor ? `, noise floor ${format(shown.floor, 3)}` : "";
    ["rms", "ise"].forEach((key, k) => {
      const finite = Number.isFinite(now[key]);
      numbers[k].value.textContent = finite ? format(now[key], 3) : "diverges";
      numbers[k].note.textContent = `identified ${format(identified[key], 3)}${key === "rms" ? floor : ""}`;
    });
  }

  // The value of a slider, and by how much it differs from the estimate.
  function tell({ value, step, unit, input, said }) {
    const at = Number(input.value) * step;
    const percent = Math.round(100 * at / Math.abs(value));
    const change = at && Number.isFinite(percent) ? ` (${percent > 0 ? "+" : "−"}${Math.abs(percent)} %)` : "";
    said.textContent = `${format(value + at, 4)} ${unit}${change}`;
    input.setAttribute("aria-valuetext", said.textContent);
  }

  const later = () => { if (!waiting) { waiting = true; setTimeout(update, FRAME); } };
  sliders.forEach(({ input }) => input.addEventListener("input", later));
  box.querySelector(".tools .reset").addEventListener("click", () => {
    sliders.forEach(({ input }) => { input.value = 0; });
    update();
  });

  // the first simulation waits until the reader opens the section
  const choice = document.querySelector(".explorer select");
  const chosen = () => choose(choice ? choice.selectedIndex : 0);
  const begin = () => { chosen(); choice?.addEventListener("change", chosen); };
  const folded = box.closest("details");
  if (folded && !folded.open) folded.addEventListener("toggle", begin, { once: true }); else begin();
}

if (typeof module !== "undefined") module.exports = whatIf;
