// Numbers, scales and ticks of the live figures; the printed ones follow the same rules.
"use strict";
const SUPERSCRIPT = "⁰¹²³⁴⁵⁶⁷⁸⁹";
// ---- numbers ---------------------------------------------------------------------------------
const superscript = (n) => (n < 0 ? "⁻" : "") + [...String(Math.abs(n))].map((d) => SUPERSCRIPT[d]).join("");
const minus = (text) => text.replace("-", "−");

function format(value, digits = 4) {
  if (value === null || Number.isNaN(value)) return "–";
  if (value === 0) return "0";
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  const power = Number(exponent);
  if (power < -3 || power > 4) return minus(`${Number(mantissa)}`) + ` × 10${superscript(power)}`;
  return minus(value.toFixed(Math.max(0, digits - 1 - power)));
}

// A value read off an axis: to a thousandth of its largest value.
function readOff(value, [a, b]) {
  const size = Math.floor(Math.log10(Math.max(Math.abs(a), Math.abs(b))));
  if (value === null || Number.isNaN(value) || size < -3 || size > 4) return format(value);
  return minus(value.toFixed(Math.max(0, 3 - size)));
}

// ---- scales ----------------------------------------------------------------------------------
const share = (axis, [a, b], v) => axis.log ? Math.log(v / a) / Math.log(b / a) : (v - a) / (b - a);
const value = (axis, [a, b], s) => axis.log ? a * Math.pow(b / a, s) : a + s * (b - a);

function ticks(axis, [a, b], count) {
  if (axis.log && b / a >= 10) return logTicks(a, b, count);
  const rough = (b - a) / Math.max(1, count);
  const power = Math.pow(10, Math.floor(Math.log10(rough)));
  const step = [1, 2, 2.5, 5, 10].find((n) => n * power >= rough * 0.999999) * power;
  const size = Math.floor(Math.log10(Math.max(Math.abs(a), Math.abs(b)) * (1 + 1e-9)));
  const exponent = size < -3 || size > 4 ? 3 * Math.floor(size / 3) : 0;
  const magnitude = Math.floor(Math.log10(step) + 1e-9);
  const half = Math.abs(step / Math.pow(10, magnitude) - 2.5) < 1e-6 ? 1 : 0;
  const decimals = Math.min(15, Math.max(0, exponent - magnitude + half));
  const list = [];
  for (let i = Math.ceil(a / step - 1e-6); i <= Math.floor(b / step + 1e-6) && list.length < 100; i++) {
    const shown = (i * step / Math.pow(10, exponent)).toFixed(decimals);
    list.push({ at: i * step, label: minus(Number(shown) === 0 ? shown.replace("-", "") : shown) });
  }
  return { list, exponent };
}

function logTicks(a, b, count) {
  const [from, to] = [Math.ceil(Math.log10(a) - 1e-6), Math.floor(Math.log10(b) + 1e-6)];
  const stride = Math.max(1, Math.ceil((to - from + 1) / count));
  const plain = from >= -3 && to <= 4;
  const list = [];
  for (let e = from; e <= to; e++) {
    if (e % stride !== 0) continue;
    for (const digit of from === to ? [1, 2, 5] : [1]) {
      const at = digit * Math.pow(10, e);
      if (at > b * 1.000001) continue;
      const power = (digit > 1 ? `${digit} × ` : "") + "10" + superscript(e);
      list.push({ at, label: plain ? String(Number(at.toPrecision(1))) : power });
    }
  }
  return { list, exponent: 0 };
}

function axisLabel(axis, exponent) {
  const unit = [exponent ? "10" + superscript(exponent) : "", axis.unit].filter(Boolean).join("\u2009");
  return unit ? `${axis.label} [${unit}]`.trim() : axis.label;
}
