{{header}}
%
% robot = model();
% a = robot.acceleration(t, alpha, omega, M);                  % [rad/s^2]
% [alpha, omega] = robot.simulate(t, M, alpha0, omega0);       % n by 2, one row per sample
% dy = robot.rates(t, y, M);                                   % of the state y = [alpha, omega]
function robot = model()
  robot.terms = @terms;
  robot.drive = @drive;
  robot.behind = @behind;
  robot.rates = @rates;
  robot.acceleration = @acceleration;
  robot.simulate = @simulate;
end

% Mass matrix (m11, m12, m22), resisting torques, levels of dry friction.
function [mass, torque, level] = terms(t, y)
  {{parameters}}
  alpha = y(1:2); omega = y(3:4); body = y(5:end);
  mass = zeros(1, 3); torque = zeros(1, 2); level = zeros(1, 4);
  {{terms}}
end

% Rates of the state of a second body; none without one.
function rate = body_rates(t, y)
  {{parameters}}
  alpha = y(1:2); omega = y(3:4); body = y(5:end);
  rate = zeros(1, {{states}} - 4);
  {{body}}
end

% Fastest rate of a two-mass drivetrain [1/s]; zero without one.
function fastest = fastest_rate(t, y)
  {{parameters}}
  alpha = y(1:2); omega = y(3:4); body = y(5:end);
  {{fastest}}
end

% Torques before lag and delay, from the recorded torques [N m].
function acting = drive(M)
  {{parameters}}
  acting = zeros(1, 2);
  {{drive}}
end

% Acting torques, from those after lag and delay [N m].
function acting = behind(M)
  {{parameters}}
  acting = zeros(1, 2);
  {{behind}}
end

% First-order lag of torques that run straight between samples; tau [s].
function out = lagged(t, M, tau)
  out = M;
  for k = 2:numel(t)
    h = t(k) - t(k - 1);
    left = 0;
    if 40 * tau > h
      left = exp(-h / tau);
    end
    mean = (1 - left) * tau / h;
    out(k, :) = left * out(k - 1, :) + (mean - left) * M(k - 1, :) + (1 - mean) * M(k, :);
  end
end

% Torques as they were delay [s] ago, straight between samples; the first is held.
function out = delayed(t, M, delay)
  out = M;
  k = 1;
  last = numel(t);
  for n = 1:last
    at = t(n) - delay;
    while k < last && t(k + 1) <= at
      k = k + 1;
    end
    out(n, :) = M(k, :);
    if k < last && at > t(1)
      out(n, :) = M(k, :) + (at - t(k)) / (t(k + 1) - t(k)) * (M(k + 1, :) - M(k, :));
    end
  end
end

% The torques that act at every sample, from the recorded ones [N m].
function out = acting_torques(t, M)
  {{parameters}}
  out = zeros(numel(t), 2);
  for k = 1:numel(t)
    out(k, :) = drive(M(k, :));
  end
  out = delayed(t, lagged(t, out, {{lag}}), {{delay}});
  for k = 1:numel(t)
    out(k, :) = behind(out(k, :));
  end
end

function d = direction(j)
  all = [1 0; 0 1; 1 -1; 1 1];
  d = all(j, :);
end

function s = along(j, v)
  d = direction(j);
  s = d(1) * v(1) + d(2) * v(2);
end

% Solves (m11 m12; m12 m22) x = b.
function x = solve(mass, b)
  det = mass(1) * mass(3) - mass(2) * mass(2);
  x = [(mass(3) * b(1) - mass(2) * b(2)) / det, (mass(1) * b(2) - mass(2) * b(1)) / det];
end

% Sign of the friction in each direction, and whether the direction sticks.
function [s, stuck] = contact(t, y, acting)
  [mass, torque, level] = terms(t, y);
  b = [acting(1) - torque(1), acting(2) - torque(2)];
  s = zeros(1, 4); stuck = false(1, 4); resting = false(1, 4);
  for j = 1:4
    if level(j) > 0
      s(j) = sign(along(j, y(3:4)));
      resting(j) = s(j) == 0;
      b = b - direction(j) * level(j) * s(j);
    end
  end
  if ~any(resting)
    return
  end
  a = solve(mass, b);
  held = zeros(1, 4);
  for sweep = 1:200
    moved = false;
    for j = find(resting)
      g = solve(mass, direction(j));
      wanted = held(j) + along(j, a) / along(j, g);
      wanted = min(max(wanted, -level(j)), level(j));
      moved = moved || abs(wanted - held(j)) > 1e-14 * level(j);
      a = a - g * (wanted - held(j));
      held(j) = wanted;
    end
    if ~moved
      break
    end
  end
  for j = find(resting)
    stuck(j) = abs(along(j, a)) <= 1e-9;
    if ~stuck(j)
      s(j) = sign(along(j, a));
    end
  end
end

% Acceleration in a fixed state of contact [rad/s^2].
function a = constrained(t, y, acting, s, stuck)
  [mass, torque, level] = terms(t, y);
  b = [acting(1) - torque(1), acting(2) - torque(2)];
  for j = 1:4
    b = b - direction(j) * max(level(j), 0) * s(j);
  end
  if sum(stuck) == 0
    a = solve(mass, b);
  elseif sum(stuck) > 1
    a = [0, 0];
  else
    d = direction(find(stuck, 1));
    n = [-d(2), d(1)];
    inertia = mass(1) * n(1) * n(1) + 2 * mass(2) * n(1) * n(2) + mass(3) * n(2) * n(2);
    a = n * ((n(1) * b(1) + n(2) * b(2)) / inertia);
  end
end

% Rates of a state in a fixed state of contact.
function dy = moving(t, y, acting, s, stuck)
  dy = [y(3:4), constrained(t, y, acting, s, stuck), body_rates(t, y)];
end

% Rates of a state y; t [s], M as recorded.
function dy = rates(t, y, M)
  acting = behind(drive(M));
  [s, stuck] = contact(t, y, acting);
  dy = moving(t, y, acting, s, stuck);
end

% The state in which a simulation starts: a second body moves with the wheels.
function y = started(alpha, omega)
  y = [alpha(1), alpha(2), omega(1), omega(2), omega(1), omega(2), 0, 0];
  y = y(1:{{states}});
end

% Acceleration of the wheels [rad/s^2]; t [s], alpha [rad], omega [rad/s], M as recorded.
function a = acceleration(t, alpha, omega, M)
  dy = rates(t, started(alpha, omega), M);
  a = dy(3:4);
end

% One step in a fixed state of contact.
function new = runge_kutta(t, h, y, first, last, s, stuck)
  at = @(share, y) moving(t + share * h, y, first + share * (last - first), s, stuck);
  k1 = at(0, y);
  k2 = at(0.5, y + 0.5 * h * k1);
  k3 = at(0.5, y + 0.5 * h * k2);
  k4 = at(1, y + h * k3);
  new = y + h / 6 * (k1 + 2 * (k2 + k3) + k4);
end

% Sets the speed along direction j to zero; stuck directions stay so.
function y = rest(y, stuck, j)
  d = direction(j);
  if any(stuck)
    y(3:4) = 0;
  else
    n = [-d(2), d(1)];
    y(3:4) = n * ((n(1) * y(3) + n(2) * y(4)) / (n(1) * n(1) + n(2) * n(2)));
  end
end

% One step; where a direction reverses in it, the step is split there by a secant.
function y = advance(t, h, y, first, last)
  for piece = 1:8
    [s, stuck] = contact(t, y, first);
    new = runge_kutta(t, h, y, first, last, s, stuck);
    share = 1; crossed = 0;
    for j = 1:4
      before = along(j, y(3:4)); after = along(j, new(3:4));
      if s(j) * after < 0 && (crossed == 0 || before / (before - after) < share)
        share = before / (before - after); crossed = j;
      end
    end
    if crossed == 0
      y = new;
      return
    end
    split = first + share * (last - first);
    y = rest(runge_kutta(t, share * h, y, first, split, s, stuck), stuck, crossed);
    t = t + share * h; h = (1 - share) * h; first = split;
  end
end

% The motion from recorded torques M, one row per sample of t [s], and the first state.
function [alpha, omega] = simulate(t, M, alpha0, omega0)
  LINEAR = {{linear}};  % the torque runs straight between samples; otherwise it is held
  STEP = 1e-3;  % longest step of the integration [s]
  y = started(alpha0, omega0);
  states = zeros(numel(t), numel(y));
  acting = acting_torques(t, M);
  states(1, :) = y;
  for k = 2:numel(t)
    first = acting(k - 1, :);
    last = first;
    if LINEAR
      last = acting(k, :);
    end
    steps_a_second = max(1 / STEP, 2 * fastest_rate(t(k - 1) - t(1), y));
    pieces = max(1, ceil((t(k) - t(k - 1)) * steps_a_second - 1e-9));
    h = (t(k) - t(k - 1)) / pieces;
    for piece = 0:pieces - 1
      from = first + piece / pieces * (last - first);
      to = first + (piece + 1) / pieces * (last - first);
      y = advance(t(k - 1) - t(1) + piece * h, h, y, from, to);
    end
    states(k, :) = y;
  end
  alpha = states(:, 1:2);
  omega = states(:, 3:4);
end
