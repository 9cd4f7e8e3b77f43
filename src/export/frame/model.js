{{header}}
//
// const robot = model();                              // or model({ p_a1: 0.03 }), with another value of a parameter
// const a = robot.acceleration(t, alpha, omega, M);   // [rad/s^2]
// const { alpha, omega } = robot.simulate(t, M, alpha0, omega0); // arrays of pairs, one per sample
// const dy = robot.rates(t, y, M);                    // of the state y = [alpha1, alpha2, omega1, omega2]
"use strict";

function model(changed = {}) {
  {{parameters}}
  const LINEAR = {{linear}}; // the torque runs straight between samples; otherwise it is held
  const STATES = {{states}}; // numbers of a state
  const STEP = 1e-3; // longest step of the integration [s]
  const DIRECTIONS = [[1.0, 0.0], [0.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
  const [NODES, WEIGHTS] = [[0.0, 0.5, 0.5, 1.0], [1.0, 2.0, 2.0, 1.0]];
  // the state that terms, bodyRates and fastestRate are asked for: speeds u and twists phi of a second body last
  const at = new Float64Array(STATES);
  const [alpha, omega, body] = [at.subarray(0, 2), at.subarray(2, 4), at.subarray(4)];
  // what terms was asked for last: mass matrix (m11, m12, m22), resisting torques, levels of dry friction
  const [mass, torque, level] = [new Float64Array(3), new Float64Array(2), new Float64Array(4)];
  // the state of contact and places for what the functions compute, made once
  const [sign, stuck, resting, held] = [0, 1, 2, 3].map(() => new Float64Array(4));
  const [all, sum, after] = [0, 1, 2].map(() => new Float64Array(STATES));
  const [a, b, g, start, split, actingAt] = Array.from({ length: 6 }, () => new Float64Array(2));
  const rate = all.subarray(4); // of the state of a second body

  function sgn(x) {
    return (x > 0.0) - (x < 0.0);
  }

  // Error function, by its series of terms of one sign; 1 to the last bit from 6 on.
  function erf(x) {
    const size = Math.min(Math.abs(x), 6.0);
    const square = size * size;
    let [term, sum] = [size, size];
    for (let n = 1; term > 1e-17 * sum; n++) {
      term *= square / (n + 0.5);
      sum += term;
    }
    return sgn(x) * Math.min(sum * Math.exp(-square) * 1.1283791670955126, 1.0);
  }

  function terms(t) {
    {{terms}}
  }

  // Rates of the state of a second body, into rate; none without one.
  function bodyRates(t) {
    {{body}}
  }

  // Fastest rate of a two-mass drivetrain in a state y [1/s]; zero without one.
  function fastestRate(t, y) {
    const fastest = [0.0];
    at.set(y);
    {{fastest}}
    return fastest[0];
  }

  // Torques before lag and delay, from the recorded torques [N m].
  function drive(M) {
    const acting = [0.0, 0.0];
    {{drive}}
    return acting;
  }

  // Acting torques, from those after lag and delay [N m].
  function behind(M) {
    const acting = [0.0, 0.0];
    {{behind}}
    return acting;
  }

  // First-order lag of torques that run straight between samples; tau [s].
  function lagged(t, M, tau) {
    const out = [M[0]];
    for (let k = 1; k < t.length; k++) {
      const h = t[k] - t[k - 1];
      const left = 40.0 * tau > h ? Math.exp(-h / tau) : 0.0;
      const mean = (1.0 - left) * tau / h;
      out.push([0, 1].map((i) => left * out[k - 1][i] + (mean - left) * M[k - 1][i] + (1.0 - mean) * M[k][i]));
    }
    return out;
  }

  // Torques as they were delay [s] ago, straight between samples; the first is held.
  function delayed(t, M, delay) {
    const last = t.length - 1;
    let k = 0;
    return Array.from(t, (now) => {
      const at = now - delay;
      while (k < last && t[k + 1] <= at) k++;
      const share = k === last || at <= t[0] ? 0.0 : (at - t[k]) / (t[k + 1] - t[k]);
      const end = M[Math.min(k + 1, last)];
      return [0, 1].map((i) => M[k][i] + share * (end[i] - M[k][i]));
    });
  }

  function along(j, v) {
    return DIRECTIONS[j][0] * v[0] + DIRECTIONS[j][1] * v[1];
  }

  // Solves (m11 m12; m12 m22) x = b.
  function solve(b, x) {
    const det = mass[0] * mass[2] - mass[1] * mass[1];
    const [first, second] = [b[0], b[1]];
    x[0] = (mass[2] * first - mass[1] * second) / det;
    x[1] = (mass[0] * second - mass[1] * first) / det;
  }

  // Sign of the friction in each direction in a state y, and whether the direction sticks, into sign and stuck.
  function contact(t, y, acting) {
    at.set(y);
    terms(t);
    for (let i = 0; i < 2; i++) b[i] = acting[i] - torque[i];
    let any = false;
    for (let j = 0; j < 4; j++) {
      sign[j] = stuck[j] = resting[j] = held[j] = 0;
      if (level[j] <= 0.0) continue;
      sign[j] = sgn(along(j, omega));
      resting[j] = sign[j] === 0;
      any = any || sign[j] === 0;
      for (let i = 0; i < 2; i++) b[i] -= DIRECTIONS[j][i] * level[j] * sign[j];
    }
    if (any) settle();
  }

  // Which of the directions at rest stick; b holds the torques without their friction.
  function settle() {
    solve(b, a);
    for (let sweep = 0, moved = true; moved && sweep < 200; sweep++) {
      moved = false;
      for (let j = 0; j < 4; j++) {
        if (!resting[j]) continue;
        solve(DIRECTIONS[j], g);
        const wanted = Math.min(Math.max(held[j] + along(j, a) / along(j, g), -level[j]), level[j]);
        moved = moved || Math.abs(wanted - held[j]) > 1e-14 * level[j];
        for (let i = 0; i < 2; i++) a[i] -= g[i] * (wanted - held[j]);
        held[j] = wanted;
      }
    }
    for (let j = 0; j < 4; j++) {
      if (!resting[j]) continue;
      stuck[j] = Math.abs(along(j, a)) <= 1e-9;
      sign[j] = stuck[j] ? 0 : sgn(along(j, a));
    }
  }

  // Acceleration [rad/s^2] of the state at in the state of contact of sign and stuck, into a.
  function constrained(t, acting) {
    const count = stuck[0] + stuck[1] + stuck[2] + stuck[3];
    a[0] = a[1] = 0.0;
    if (count > 1) return;
    terms(t);
    for (let i = 0; i < 2; i++) b[i] = acting[i] - torque[i];
    for (let j = 0; j < 4; j++) {
      for (let i = 0; i < 2; i++) b[i] -= DIRECTIONS[j][i] * Math.max(level[j], 0.0) * sign[j];
    }
    if (count === 0) {
      solve(b, a);
      return;
    }
    const d = DIRECTIONS[stuck.indexOf(1)];
    const [n0, n1] = [-d[1], d[0]];
    const inertia = mass[0] * n0 * n0 + 2.0 * mass[1] * n0 * n1 + mass[2] * n1 * n1;
    const q = (n0 * b[0] + n1 * b[1]) / inertia;
    a[0] = n0 * q;
    a[1] = n1 * q;
  }

  // Rates of the state at in the state of contact of sign and stuck, into all.
  function moving(t, acting) {
    constrained(t, acting);
    bodyRates(t);
    for (let i = 0; i < 2; i++) {
      all[i] = omega[i];
      all[2 + i] = a[i];
    }
  }

  // One step from y in a fixed state of contact, into out.
  function rungeKutta(t, h, y, start, end, out) {
    sum.fill(0.0);
    for (let stage = 0; stage < 4; stage++) {
      const [node, weight] = [NODES[stage], WEIGHTS[stage]];
      for (let i = 0; i < STATES; i++) at[i] = y[i] + (stage ? node * h * all[i] : 0.0);
      for (let i = 0; i < 2; i++) actingAt[i] = start[i] + node * (end[i] - start[i]);
      moving(t + node * h, actingAt);
      for (let i = 0; i < STATES; i++) sum[i] += weight * all[i];
    }
    for (let i = 0; i < STATES; i++) out[i] = y[i] + h / 6.0 * sum[i];
  }

  // Sets the speed along direction j to zero; stuck directions stay so.
  function rest(y, j) {
    const [n0, n1] = [-DIRECTIONS[j][1], DIRECTIONS[j][0]];
    const isHeld = stuck[0] || stuck[1] || stuck[2] || stuck[3];
    const q = isHeld ? 0.0 : (n0 * y[2] + n1 * y[3]) / (n0 * n0 + n1 * n1);
    y[2] = n0 * q;
    y[3] = n1 * q;
  }

  // One step of y; where a direction reverses in it, the step is split there by a secant.
  function advance(t, h, y, from, end) {
    start.set(from);
    for (let piece = 0; piece < 8; piece++) {
      contact(t, y, start);
      rungeKutta(t, h, y, start, end, after);
      let share = 1.0;
      let first = -1;
      for (let j = 0; j < 4; j++) {
        const before = DIRECTIONS[j][0] * y[2] + DIRECTIONS[j][1] * y[3];
        const now = DIRECTIONS[j][0] * after[2] + DIRECTIONS[j][1] * after[3];
        if (sign[j] * now < 0.0 && (first < 0 || before / (before - now) < share)) {
          share = before / (before - now);
          first = j;
        }
      }
      if (first >= 0) {
        for (let i = 0; i < 2; i++) split[i] = start[i] + share * (end[i] - start[i]);
        rungeKutta(t, share * h, y, start, split, after);
        rest(after, first);
      }
      y.set(after);
      if (first < 0) return;
      t += share * h;
      h *= 1.0 - share;
      start.set(split);
    }
  }

  // Rates of a state y; t [s], M as recorded.
  function rates(t, y, M) {
    const acts = behind(drive(M));
    contact(t, y, acts);
    moving(t, acts);
    return Array.from(all);
  }

  // The state in which a simulation starts: a second body moves with the wheels.
  function started(alpha, omega) {
    return Float64Array.from([...alpha, ...omega, ...omega, 0.0, 0.0].slice(0, STATES));
  }

  // Acceleration of the wheels [rad/s^2]; t [s], alpha [rad], omega [rad/s], M as recorded.
  function acceleration(t, alpha, omega, M) {
    return rates(t, started(alpha, omega), M).slice(2, 4);
  }

  // The torques that act at every sample of t [s], from the recorded ones.
  function acting(t, M) {
    return delayed(t, lagged(t, M.map(drive), {{lag}}), {{delay}}).map(behind);
  }

  // The state y one sample later, at sample k, under torques that act.
  function follow(t, torques, k, y) {
    const [from, to] = [new Float64Array(2), new Float64Array(2)];
    const begin = torques[k - 1];
    const finish = LINEAR ? torques[k] : begin;
    const perSecond = Math.max(1.0 / STEP, 2.0 * fastestRate(t[k - 1] - t[0], y));
    const pieces = Math.max(1, Math.ceil((t[k] - t[k - 1]) * perSecond - 1e-9));
    const h = (t[k] - t[k - 1]) / pieces;
    for (let piece = 0; piece < pieces; piece++) {
      for (let i = 0; i < 2; i++) {
        from[i] = begin[i] + piece / pieces * (finish[i] - begin[i]);
        to[i] = begin[i] + (piece + 1.0) / pieces * (finish[i] - begin[i]);
      }
      advance(t[k - 1] - t[0] + piece * h, h, y, from, to);
    }
  }

  // The motion from sample first up to, without, sample end, under torques that act; the wheels at sample first.
  // A second body keeps slip and twist of the motion that ends there, if there is one.
  function motion(t, torques, first, end, alpha, omega, before) {
    const y = started(alpha, omega);
    if (before && STATES > 4) {
      follow(t, torques, first, before.end);
      for (let i = 0; i < 2; i++) {
        y[4 + i] += before.end[4 + i] - before.end[2 + i];
        y[6 + i] = before.end[6 + i];
      }
    }
    const out = { alpha: [[y[0], y[1]]], omega: [[y[2], y[3]]], end: y };
    for (let k = first + 1; k < end; k++) {
      follow(t, torques, k, y);
      out.alpha.push([y[0], y[1]]);
      out.omega.push([y[2], y[3]]);
    }
    return out;
  }

  // The motion from recorded torques M, one pair per sample of t [s], and the first state.
  function simulate(t, M, alpha, omega) {
    return motion(t, acting(t, M), 0, t.length, alpha, omega);
  }

  return { rates, acceleration, acting, motion, simulate };
}

if (typeof module !== "undefined") module.exports = model;
