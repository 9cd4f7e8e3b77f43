// Figures one can look into: drag to zoom, shift-drag to pan, double-click to reset, arrow keys, panels in step,
// values under the cursor. The data lie beside each figure as JSON; nothing is loaded. Without
// scripting the printed picture stays in place.
"use strict";
const live = (() => {
  const HINT = matchMedia("(pointer: coarse)").matches
    ? "Drag across to zoom, tap to read values."
    : "Drag to zoom, shift-drag to pan, ctrl-wheel to zoom, double-click to reset.";
  const KEYS = "Arrow keys pan, with shift they move the cursor; plus and minus zoom, Escape resets.";
  // a step of the cursor by a key, as a share of the axis
  const STEP = 0.02;

  const states = [];

  // ---- building the figure ---------------------------------------------------------------------
  function element(tag, className, text = "") {
    const made = document.createElement(tag);
    made.className = className;
    made.textContent = text;
    return made;
  }

  function build(figure, data) {
    const plot = figure.querySelector(".plot");
    plot.style.gridTemplateColumns = `repeat(${Math.min(data.columns, data.panels.length)}, minmax(0, 1fr))`;
    const state = { data, shared: data.shared, link: data.link, cursor: null, panels: [] };
    states.push(state);
    // of several columns the legend stands above all, each name once
    const common = element("p", "legend common");
    if (data.columns > 1) plot.before(common);
    data.panels.forEach((panel, index) => {
      const box = element("div", "panel");
      if (panel.title) box.append(element("p", "panel-title", panel.title));
      const head = element("div", "panel-head");
      const label = element("span", "axis-label");
      const legend = data.columns > 1 && index === 0 ? common : element("span", "legend");
      head.append(label);
      if (legend !== common) head.append(legend);
      const canvas = document.createElement("canvas");
      canvas.tabIndex = 0;
      canvas.setAttribute("role", "img");
      const curves = [...new Set(panel.layers.map((layer) => layer.label).filter(Boolean))].join(", ");
      canvas.setAttribute("aria-label", [panel.title, `${axisLabel(panel.y, 0)} over ${axisLabel(panel.x, 0)}`, curves]
        .filter(Boolean).join(": "));
      canvas.setAttribute("aria-description", KEYS);
      canvas.style.height = `${panel.height}px`;
      box.append(head, canvas);
      plot.append(box);
      const below = index + data.columns >= data.panels.length || !data.shared;
      const view = { panel, canvas, label, keys: [], x: [...panel.x.range], y: [...panel.y.range], below };
      prepare(panel, data.xs);
      const ground = (layer) => layer.kind === "band" || layer.kind === "shade";
      [...panel.layers].sort((a, b) => ground(a) - ground(b))
        .filter((layer) => layer.label && !(data.columns > 1 && state.panels.some((other) => isNamed(other, layer))))
        .forEach((layer) => view.keys.push(legendKey(legend, state, view, layer)));
      state.panels.push(view);
      listen(state, view);
    });
    const tools = element("p", "tools");
    const reset = element("button", "reset", "Reset view");
    reset.type = "button";
    reset.addEventListener("click", () => resetView(state));
    const zoom = (text, name, factor) => {
      const button = element("button", "reset", text);
      button.type = "button";
      button.title = name;
      button.setAttribute("aria-label", name);
      button.addEventListener("click", () => zoomAbout(state, state.panels[0], 0.5, factor));
      return button;
    };
    tools.append(reset, zoom("+", "Zoom in", 0.5), zoom("−", "Zoom out", 2), element("span", "", HINT));
    plot.after(tools);
    figure.classList.add("live");
    const redraw = () => drawFigure(state);
    new ResizeObserver(redraw).observe(plot);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
    document.fonts.ready.then(redraw);
    redraw();
    return state;
  }

  // Shows other data in a figure of the same panels and layers; what is hidden stays so.
  function load(state, data) {
    state.panels.forEach((view, n) => {
      const [old, panel] = [view.panel, data.panels[n]];
      if (old !== panel) prepare(panel, data.xs);
      panel.layers.forEach((layer, k) => { layer.off = old.layers[k]?.off; });
      view.keys.forEach((key) => { key.layer = panel.layers[old.layers.indexOf(key.layer)]; });
      view.panel = panel;
    });
    resetView(state);
  }

  // Shows what has changed in the data of a figure.
  function update(state) {
    state.panels.forEach((view) => { prepare(view.panel, state.data.xs); rescale(view); });
    drawFigure(state);
  }

  // Sets the cursor to a place on the x axis.
  function point(state, at) {
    const [view] = state.panels;
    state.cursor = { view: null, x: share(view.panel.x, view.x, at) };
    drawFigure(state);
  }

  const isNamed = (view, layer) => view.keys.some((key) => key.layer.label === layer.label);

  // A key switches its curve in every panel of the figure.
  function legendKey(legend, state, view, layer) {
    const key = element("button", "key");
    key.type = "button";
    key.title = "Show or hide";
    key.setAttribute("aria-pressed", "true");
    const sample = element("i", `sample ${layer.kind} ${layer.dash || ""}`);
    sample.style.color = `var(${layer.color})`;
    if (layer.kind === "line") sample.style.borderTopWidth = `${Math.max(2, layer.width)}px`;
    const made = { layer, reading: element("output", "") };
    key.append(sample, layer.label, made.reading);
    legend.append(key);
    key.addEventListener("click", () => {
      const { layer } = made;
      const off = !layer.off;
      const curves = ["line", "bars", "dots"];
      const alike = (other) => state.data.columns > 1 && curves.includes(other.kind) && curves.includes(layer.kind)
        && (!other.label || other.label === layer.label);
      const same = (other) => other.color === layer.color
        && (alike(other) || (other.kind === layer.kind && other.dash === layer.dash));
      state.panels.forEach((panel) => panel.panel.layers.filter(same).forEach((other) => { other.off = off; }));
      key.setAttribute("aria-pressed", String(!off));
      state.panels.forEach(rescale);
      drawFigure(state);
    });
    return made;
  }

  // ---- zooming ---------------------------------------------------------------------------------
  function partners(state, view) {
    return state.shared ? state.panels : [view];
  }

  function setX(state, view, range) {
    const [a, b] = range;
    const far = 1e-9 * Math.max(Math.abs(a), Math.abs(b));
    if (!(b - a > far) || !Number.isFinite(b - a)) return;
    for (const other of linked(state)) {
      (other === state ? partners(state, view) : other.panels).forEach((panel) => { panel.x = [a, b]; rescale(panel); });
      if (other !== state) drawFigure(other);
    }
  }

  // Figures over the same axis move together.
  function linked(state) {
    return state.link ? states.filter((other) => other.link === state.link) : [state];
  }

  function resetView(state) {
    for (const other of linked(state)) {
      other.panels.forEach((view) => {
        view.x = [...view.panel.x.range];
        view.y = [...view.panel.y.range];
        view.fixed = false;
        rescale(view);
      });
      drawFigure(other);
    }
  }

  function zoomAbout(state, view, s, factor) {
    const at = (t) => value(view.panel.x, view.x, t);
    setX(state, view, [at(s - s * factor), at(s + (1 - s) * factor)]);
    drawFigure(state);
  }

  function pan(state, view, start, dx, dy) {
    const moved = (axis, range, by) => [value(axis, range, by), value(axis, range, 1 + by)];
    setX(state, view, moved(view.panel.x, start.x, -dx));
    if (dy) { view.y = moved(view.panel.y, start.y, dy); view.fixed = true; }
    drawFigure(state);
  }

  function listen(state, view) {
    const { canvas } = view;
    let drag = null;
    const place = (event) => {
      const box = canvas.getBoundingClientRect();
      const area = view.area;
      return {
        x: Math.min(1, Math.max(0, (event.clientX - box.left - area.left) / area.width)),
        y: Math.min(1, Math.max(0, (event.clientY - box.top - area.top) / area.height)),
      };
    };
    canvas.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      canvas.setPointerCapture(event.pointerId);
      drag = { from: place(event), pan: event.shiftKey, x: view.x, y: view.y };
      setCursor(state, { view, ...drag.from });
    });
    canvas.addEventListener("pointermove", (event) => {
      const to = place(event);
      setCursor(state, { view, ...to });
      if (drag && drag.pan) return pan(state, view, drag, to.x - drag.from.x, to.y - drag.from.y);
      view.box = drag ? { from: drag.from, to } : null;
      drawFigure(state);
    });
    canvas.addEventListener("pointerup", (event) => {
      const zoom = drag && !drag.pan;
      const from = drag && drag.from;
      drag = null;
      view.box = null;
      if (zoom) zoomTo(state, view, from, place(event));
      drawFigure(state);
    });
    canvas.addEventListener("pointercancel", () => { drag = view.box = null; drawFigure(state); });
    // a finger that was lifted leaves the values it read
    canvas.addEventListener("pointerleave", (event) => {
      if (event.pointerType !== "touch") { setCursor(state, null); drawFigure(state); }
    });
    canvas.addEventListener("dblclick", () => resetView(state));
    canvas.addEventListener("wheel", (event) => {
      // a bare wheel scrolls the page
      if (!event.ctrlKey && !event.shiftKey) return;
      event.preventDefault();
      zoomAbout(state, view, place(event).x, (event.deltaY || event.deltaX) > 0 ? 1.25 : 0.8);
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const step = (by) => {
        const at = (state.cursor ? state.cursor.x : 0.5) + by;
        setCursor(state, { view, x: Math.min(1, Math.max(0, at)), y: 0.5 });
        drawFigure(state);
      };
      const keys = {
        "+": () => zoomAbout(state, view, 0.5, 0.8),
        "-": () => zoomAbout(state, view, 0.5, 1.25),
        ArrowLeft: () => (event.shiftKey ? step(-STEP) : pan(state, view, view, 0.1, 0)),
        ArrowRight: () => (event.shiftKey ? step(STEP) : pan(state, view, view, -0.1, 0)),
        Escape: () => resetView(state),
      };
      if (!keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });
  }

  function setCursor(state, cursor) {
    for (const other of linked(state)) {
      other.cursor = cursor;
      if (other !== state) drawFigure(other);
    }
    state.follow?.(cursor && value(cursor.view.panel.x, cursor.view.x, cursor.x));
  }

  // A flat drag takes a range of x, a high one also a range of y.
  function zoomTo(state, view, from, to) {
    const { width, height } = view.area;
    const { x, y } = view.panel;
    const sorted = (a, b) => (a < b ? [a, b] : [b, a]);
    const [left, right] = sorted(from.x, to.x);
    const [top, bottom] = sorted(from.y, to.y);
    if ((right - left) * width < 4) return;
    const high = (bottom - top) * height > 24;
    if (high) { view.y = [value(y, view.y, 1 - bottom), value(y, view.y, 1 - top)]; view.fixed = true; }
    setX(state, view, [value(x, view.x, left), value(x, view.x, right)]);
  }

  for (const figure of document.querySelectorAll("figure[data-interactive]")) {
    build(figure, JSON.parse(figure.querySelector("script[type='application/json']").textContent));
  }
  for (const choice of document.querySelectorAll(".versions")) {
    choice.hidden = false;
    choice.addEventListener("change", (event) => {
      display.version = event.target.value;
      states.forEach((state) => { state.panels.forEach(rescale); drawFigure(state); });
    });
  }
  // the picture is embedded once: the link takes it from the image
  for (const link of document.querySelectorAll("a[data-picture]")) {
    link.href = link.closest("figure").querySelector(".picture img").src;
    link.hidden = false;
  }
  return { build, load, point, update };
})();
