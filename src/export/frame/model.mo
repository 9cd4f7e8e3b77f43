{{header}}
//
// TwoWheelRobot.Robot takes the recorded torques and gives angles and speeds at a fixed step;
// TwoWheelRobot.acceleration is the right-hand side alone. The state y has eight numbers, alpha, omega, and of a
// second body its speeds u and twists phi; without one they are not used.
package TwoWheelRobot "Identified model of a two-wheel robot"
  {{parameters}}

  constant Real direction[4, 2] = {{1, 0}, {0, 1}, {1, -1}, {1, 1}};

  function power "a to the power b"
    input Real a;
    input Real b;
    output Real c;
  algorithm
    c := a ^ b;
  end power;

  function erf "Error function, by its series of terms of one sign; 1 to the last bit from 6 on"
    input Real x;
    output Real y;
  protected
    Real term;
  algorithm
    term := min(max(x, -6), 6);
    y := term;
    for n in 1:150 loop
      term := term * min(x * x, 36) / (n + 0.5);
      y := y + term;
    end for;
    y := min(max(y * exp(-min(x * x, 36)) * 1.1283791670955126, -1), 1);
  end erf;

  function terms "Mass matrix (m11, m12, m22), resisting torques, levels of dry friction"
    input Real t;
    input Real alpha[2];
    input Real omega[2];
    input Real body[4];
    output Real mass[3];
    output Real torque[2];
    output Real level[4];
  protected
    Real x[{{terms_temporaries}}];
  algorithm
    {{terms}}
  end terms;

  function bodyRates "Rates of the state of a second body; zero without one"
    input Real t;
    input Real alpha[2];
    input Real omega[2];
    input Real body[4];
    output Real rate[4];
  protected
    Real x[{{body_temporaries}}];
  algorithm
    rate := {0, 0, 0, 0};
    {{body}}
  end bodyRates;

  function fastestRate "Fastest rate of a two-mass drivetrain [1/s]; zero without one"
    input Real t;
    input Real alpha[2];
    input Real omega[2];
    input Real body[4];
    output Real fastest[1];
  protected
    Real x[{{fastest_temporaries}}];
  algorithm
    {{fastest}}
  end fastestRate;

  function drive "Torques before lag and delay, from the recorded torques [N m]"
    input Real M[2];
    output Real acting[2];
  protected
    Real x[{{drive_temporaries}}];
  algorithm
    {{drive}}
  end drive;

  function behind "Acting torques, from those after lag and delay [N m]"
    input Real M[2];
    output Real acting[2];
  protected
    Real x[{{behind_temporaries}}];
  algorithm
    {{behind}}
  end behind;

  function solve "Solves (m11 m12; m12 m22) x = b"
    input Real mass[3];
    input Real b[2];
    output Real x[2];
  protected
    Real det;
  algorithm
    det := mass[1] * mass[3] - mass[2] * mass[2];
    x[1] := (mass[3] * b[1] - mass[2] * b[2]) / det;
    x[2] := (mass[1] * b[2] - mass[2] * b[1]) / det;
  end solve;

  function sweep "One sweep over the resting directions: what holds each of them, within its level"
    input Real mass[3];
    input Real level[4];
    input Boolean resting[4];
    input Real a0[2];
    input Real held0[4];
    output Real a[2];
    output Real held[4];
    output Boolean moved;
  protected
    Real g[2];
    Real wanted;
  algorithm
    a := a0;
    held := held0;
    moved := false;
    for j in 1:4 loop
      if resting[j] then
        g := solve(mass, direction[j, :]);
        wanted := held[j] + (direction[j, :] * a) / (direction[j, :] * g);
        wanted := min(max(wanted, -level[j]), level[j]);
        moved := moved or abs(wanted - held[j]) > 1e-14 * level[j];
        a := a - g * (wanted - held[j]);
        held[j] := wanted;
      end if;
    end for;
  end sweep;

  function contact "Sign of the friction in each direction, and whether the direction sticks"
    input Real t;
    input Real y[8];
    input Real acting[2];
    output Real s[4];
    output Boolean stuck[4];
  protected
    Real mass[3];
    Real torque[2];
    Real level[4];
    Real a[2];
    Real b[2];
    Real held[4];
    Boolean resting[4];
    Boolean moved;
    Integer sweeps;
  algorithm
    (mass, torque, level) := terms(t, y[1:2], y[3:4], y[5:8]);
    b := acting - torque;
    for j in 1:4 loop
      s[j] := if level[j] > 0 then sign(direction[j, :] * y[3:4]) else 0;
      resting[j] := level[j] > 0 and s[j] == 0;
      stuck[j] := false;
      held[j] := 0;
      b := b - direction[j, :] * (max(level[j], 0) * s[j]);
    end for;
    a := solve(mass, b);
    moved := resting[1] or resting[2] or resting[3] or resting[4];
    sweeps := 0;
    while moved and sweeps < 200 loop
      (a, held, moved) := sweep(mass, level, resting, a, held);
      sweeps := sweeps + 1;
    end while;
    for j in 1:4 loop
      if resting[j] then
        stuck[j] := abs(direction[j, :] * a) <= 1e-9;
        s[j] := if stuck[j] then 0 else sign(direction[j, :] * a);
      end if;
    end for;
  end contact;

  function constrained "Acceleration in a fixed state of contact [rad/s^2]"
    input Real t;
    input Real y[8];
    input Real acting[2];
    input Real s[4];
    input Boolean stuck[4];
    output Real a[2];
  protected
    Real mass[3];
    Real torque[2];
    Real level[4];
    Real b[2];
    Real n[2];
    Real inertia;
    Integer count;
  algorithm
    (mass, torque, level) := terms(t, y[1:2], y[3:4], y[5:8]);
    b := acting - torque;
    n := {0, 0};
    count := 0;
    for j in 1:4 loop
      b := b - direction[j, :] * (max(level[j], 0) * s[j]);
      if stuck[j] then
        count := count + 1;
        n := {-direction[j, 2], direction[j, 1]};
      end if;
    end for;
    if count == 0 then
      a := solve(mass, b);
    elseif count > 1 then
      a := {0, 0};
    else
      inertia := mass[1] * n[1] * n[1] + 2 * mass[2] * n[1] * n[2] + mass[3] * n[2] * n[2];
      a := n * ((n * b) / inertia);
    end if;
  end constrained;

  function started "The state in which a simulation starts: a second body moves with the wheels"
    input Real alpha[2];
    input Real omega[2];
    output Real y[8];
  algorithm
    y := {alpha[1], alpha[2], omega[1], omega[2], omega[1], omega[2], 0, 0};
  end started;

  function rates "Rates of a state y; M as recorded"
    input Real t;
    input Real y[8];
    input Real M[2];
    output Real k[8];
  protected
    Real acting[2];
    Real s[4];
    Boolean stuck[4];
  algorithm
    acting := behind(drive(M));
    (s, stuck) := contact(t, y, acting);
    k := moving(t, y, acting, s, stuck);
  end rates;

  function acceleration "Acceleration of the wheels [rad/s^2]; M as recorded"
    input Real t;
    input Real alpha[2];
    input Real omega[2];
    input Real M[2];
    output Real a[2];
  protected
    Real k[8];
  algorithm
    k := rates(t, started(alpha, omega), M);
    a := k[3:4];
  end acceleration;

  function moving "Rates of a state in a fixed state of contact"
    input Real t;
    input Real y[8];
    input Real acting[2];
    input Real s[4];
    input Boolean stuck[4];
    output Real k[8];
  protected
    Real a[2];
    Real rate[4];
  algorithm
    a := constrained(t, y, acting, s, stuck);
    rate := bodyRates(t, y[1:2], y[3:4], y[5:8]);
    k := {y[3], y[4], a[1], a[2], rate[1], rate[2], rate[3], rate[4]};
  end moving;

  function rungeKutta "One step in a fixed state of contact"
    input Real t;
    input Real h;
    input Real y[8];
    input Real first[2];
    input Real last[2];
    input Real s[4];
    input Boolean stuck[4];
    output Real new[8];
  protected
    Real k1[8];
    Real k2[8];
    Real k3[8];
    Real k4[8];
    Real middle[2];
  algorithm
    middle := first + 0.5 * (last - first);
    k1 := moving(t, y, first, s, stuck);
    k2 := moving(t + 0.5 * h, y + 0.5 * h * k1, middle, s, stuck);
    k3 := moving(t + 0.5 * h, y + 0.5 * h * k2, middle, s, stuck);
    k4 := moving(t + h, y + h * k3, last, s, stuck);
    new := y + h / 6 * (k1 + 2 * (k2 + k3) + k4);
  end rungeKutta;

  function reversal "The part of a step after which a direction reverses first, and which one"
    input Real before[2];
    input Real after[2];
    input Real s[4];
    output Real share;
    output Integer reversed;
  protected
    Real first;
    Real last;
  algorithm
    share := 1;
    reversed := 0;
    for j in 1:4 loop
      first := direction[j, :] * before;
      last := direction[j, :] * after;
      if s[j] * last < 0 then
        if reversed == 0 or first / (first - last) < share then
          share := first / (first - last);
          reversed := j;
        end if;
      end if;
    end for;
  end reversal;

  function piece "The step up to the first reversal in it, which is placed by a secant"
    input Real t;
    input Real h;
    input Real y0[8];
    input Real first[2];
    input Real last[2];
    output Real y[8];
    output Real share "of the step that was made: 1 if nothing reverses";
  protected
    Real s[4];
    Boolean stuck[4];
    Real n[2];
    Real left;
    Integer reversed;
  algorithm
    (s, stuck) := contact(t, y0, first);
    y := rungeKutta(t, h, y0, first, last, s, stuck);
    (share, reversed) := reversal(y0[3:4], y[3:4], s);
    if reversed > 0 then
      y := rungeKutta(t, share * h, y0, first, first + share * (last - first), s, stuck);
      n := {-direction[reversed, 2], direction[reversed, 1]};
      left := if stuck[1] or stuck[2] or stuck[3] or stuck[4] then 0
              else (n[1] * y[3] + n[2] * y[4]) / (n[1] * n[1] + n[2] * n[2]);
      y := {y[1], y[2], left * n[1], left * n[2], y[5], y[6], y[7], y[8]};
    end if;
  end piece;

  function advance "One step; where a direction reverses in it, it is split there"
    input Real t0;
    input Real h0;
    input Real y0[8];
    input Real start[2];
    input Real last[2];
    output Real y[8];
  protected
    Real t;
    Real h;
    Real first[2];
    Real share;
    Integer pieces;
  algorithm
    t := t0;
    h := h0;
    y := y0;
    first := start;
    share := 0;
    pieces := 0;
    while share < 1 and pieces < 8 loop
      (y, share) := piece(t, h, y, first, last);
      t := t + share * h;
      h := (1 - share) * h;
      first := first + share * (last - first);
      pieces := pieces + 1;
    end while;
  end advance;

  function follow "One step in parts of at most half the time constant of a two-mass drivetrain"
    input Real t;
    input Real h;
    input Real y0[8];
    input Real first[2];
    input Real last[2];
    output Real y[8];
  protected
    Real fastest[1];
    Integer parts;
    Integer k;
  algorithm
    fastest := fastestRate(t, y0[1:2], y0[3:4], y0[5:8]);
    parts := integer(2 * h * fastest[1]) + 1;
    y := y0;
    k := 0;
    while k < parts and k < 1000 loop
      y := advance(t + k * h / parts, h / parts, y, first + k / parts * (last - first),
                   first + (k + 1) / parts * (last - first));
      k := k + 1;
    end while;
  end follow;

  constant Integer rows = {{delay_rows}} "rows that the delay takes at steps of 1 ms and more";

  function held "Lagged torques, newest first, at the start"
    input Real M[2];
    output Real slow[rows, 2];
  algorithm
    for row in 1:rows loop
      slow[row, 1] := M[1];
      slow[row, 2] := M[2];
    end for;
  end held;

  function later "Lagged torques, newest first, one step later"
    input Real before[rows, 2];
    input Real first[2];
    input Real last[2];
    input Real left;
    input Real mean;
    output Real slow[rows, 2];
  algorithm
    for i in 1:2 loop
      slow[1, i] := left * before[1, i] + (mean - left) * first[i] + (1 - mean) * last[i];
      for row in 2:rows loop
        slow[row, i] := before[row - 1, i];
      end for;
    end for;
  end later;

  function passed "Lagged torques of so many whole steps and a share of one ago"
    input Real slow[rows, 2];
    input Real whole;
    input Real share;
    output Real acting[2];
  protected
    Integer k;
  algorithm
    k := integer(whole) + 1;
    for i in 1:2 loop
      acting[i] := (1 - share) * slow[k, i] + share * slow[k + 1, i];
    end for;
  end passed;

  model Robot "Fixed-step simulation under recorded torques"
    parameter Real step = 1e-3 "step of the integration [s]";
    parameter Boolean linear = {{linear}} "the torque runs straight over a step, else it is held";
    parameter Real alpha0[2] = {0, 0} "first angles [rad]";
    parameter Real omega0[2] = {0, 0} "first speeds [rad/s]";
    input Real M[2] "torques as recorded";
    discrete output Real alpha[2](start = alpha0, each fixed = true) "angles [rad]";
    discrete output Real omega[2](start = omega0, each fixed = true) "speeds [rad/s]";
  protected
    constant Real lag = {{lag}} "time constant of the first-order lag [s]";
    constant Real delay = {{delay}} "pure delay [s]";
    parameter Real whole = min(floor(delay / step + 1e-9), rows - 2) "whole steps of the delay";
    parameter Real share = delay / step - whole "the rest of it";
    parameter Real left = if 40 * lag > step then exp(-step / max(lag, 1e-12)) else 0;
    parameter Real mean = (1 - left) * lag / step;
    discrete Real y[8](start = {alpha0[1], alpha0[2], omega0[1], omega0[2], omega0[1], omega0[2], 0, 0},
                       each fixed = true);
    discrete Real commanded[2](each start = 0, each fixed = true);
    discrete Real slow[rows, 2](each start = 0, each fixed = true) "lagged torques, newest first";
    discrete Real acting[2](each start = 0, each fixed = true);
  algorithm
    when sample(0, step) then
      commanded := drive(M);
      slow := if time > 0.5 * step then later(pre(slow), pre(commanded), commanded, left, mean)
              else held(commanded);
      acting := behind(passed(slow, whole, share));
      if time > 0.5 * step then
        y := follow(time - step, step, pre(y), pre(acting),
                    if linear then acting else pre(acting));
      end if;
      alpha := y[1:2];
      omega := y[3:4];
    end when;
  end Robot;
end TwoWheelRobot;
