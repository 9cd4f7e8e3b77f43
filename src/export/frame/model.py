{{header}}
#
# import model
# a = model.acceleration(t, alpha, omega, M)           # [rad/s^2]
# alpha, omega = model.simulate(t, M, alpha0, omega0)  # lists of pairs, one per sample
# dy = model.rates(t, y, M)                            # of the state y = [alpha1, alpha2, omega1, omega2]

import math

{{parameters}}

LINEAR = {{linear}}  # the torque runs straight between samples; otherwise it is held
STATES = {{states}}  # numbers of a state
STEP = 1e-3  # longest step of the integration [s]
DIRECTIONS = ((1.0, 0.0), (0.0, 1.0), (1.0, -1.0), (1.0, 1.0))


def sgn(x):
    return float(x > 0.0) - float(x < 0.0)


def terms(t, y):
    """Mass matrix (m11, m12, m22), resisting torques, levels of dry friction."""
    alpha, omega, body = y[:2], y[2:4], y[4:]
    mass, torque, level = [0.0] * 3, [0.0] * 2, [0.0] * 4
    {{terms}}
    return mass, torque, level


def body_rates(t, y):
    """Rates of the state of a second body; none without one."""
    alpha, omega, body = y[:2], y[2:4], y[4:]
    rate = [0.0] * (STATES - 4)
    {{body}}
    return rate


def fastest_rate(t, y):
    """Fastest rate of a two-mass drivetrain [1/s]; zero without one."""
    alpha, omega, body = y[:2], y[2:4], y[4:]
    fastest = [0.0]
    {{fastest}}
    return fastest[0]


def drive(M):
    """Torques before lag and delay, from the recorded torques [N m]."""
    acting = [0.0] * 2
    {{drive}}
    return acting


def behind(M):
    """Acting torques, from those after lag and delay [N m]."""
    acting = [0.0] * 2
    {{behind}}
    return acting


def lagged(t, M, tau):
    """First-order lag of torques that run straight between samples; tau [s]."""
    out = [list(M[0])]
    for k in range(1, len(t)):
        h = t[k] - t[k - 1]
        left = math.exp(-h / tau) if 40.0 * tau > h else 0.0
        mean = (1.0 - left) * tau / h
        out.append([
            left * out[-1][i] + (mean - left) * M[k - 1][i] + (1.0 - mean) * M[k][i]
            for i in range(2)
        ])
    return out


def delayed(t, M, delay):
    """Torques as they were delay [s] ago, straight between samples; the first is held."""
    out, k, last = [], 0, len(t) - 1
    for now in t:
        at = now - delay
        while k < last and t[k + 1] <= at:
            k += 1
        share = 0.0 if k == last or at <= t[0] else (at - t[k]) / (t[k + 1] - t[k])
        end = M[min(k + 1, last)]
        out.append([M[k][i] + share * (end[i] - M[k][i]) for i in range(2)])
    return out


def along(j, v):
    return DIRECTIONS[j][0] * v[0] + DIRECTIONS[j][1] * v[1]


def solve(mass, b):
    """Solves (m11 m12; m12 m22) x = b."""
    m11, m12, m22 = mass
    det = m11 * m22 - m12 * m12
    return [(m22 * b[0] - m12 * b[1]) / det, (m11 * b[1] - m12 * b[0]) / det]


def contact(t, y, acting):
    """Sign of the friction in each direction, and whether the direction sticks."""
    mass, torque, level = terms(t, y)
    b = [acting[0] - torque[0], acting[1] - torque[1]]
    sign, stuck, resting = [0.0] * 4, [False] * 4, []
    for j, d in enumerate(DIRECTIONS):
        if level[j] <= 0.0:
            continue
        sign[j] = sgn(along(j, y[2:4]))
        if sign[j] == 0.0:
            resting.append(j)
        b = [b[i] - d[i] * level[j] * sign[j] for i in range(2)]
    a = solve(mass, b)
    held = [0.0] * 4
    for _ in range(200 if resting else 0):
        moved = False
        for j in resting:
            g = solve(mass, DIRECTIONS[j])
            wanted = held[j] + along(j, a) / along(j, g)
            wanted = min(max(wanted, -level[j]), level[j])
            moved = moved or abs(wanted - held[j]) > 1e-14 * level[j]
            a = [a[i] - g[i] * (wanted - held[j]) for i in range(2)]
            held[j] = wanted
        if not moved:
            break
    for j in resting:
        stuck[j] = abs(along(j, a)) <= 1e-9
        sign[j] = 0.0 if stuck[j] else sgn(along(j, a))
    return sign, stuck


def constrained(t, y, acting, sign, stuck):
    """Acceleration in a fixed state of contact [rad/s^2]."""
    mass, torque, level = terms(t, y)
    b = [acting[0] - torque[0], acting[1] - torque[1]]
    for j, d in enumerate(DIRECTIONS):
        b = [b[i] - d[i] * max(level[j], 0.0) * sign[j] for i in range(2)]
    if sum(stuck) == 0:
        return solve(mass, b)
    if sum(stuck) > 1:
        return [0.0, 0.0]
    d = DIRECTIONS[stuck.index(True)]
    n = (-d[1], d[0])
    inertia = mass[0] * n[0] * n[0] + 2.0 * mass[1] * n[0] * n[1] + mass[2] * n[1] * n[1]
    q = (n[0] * b[0] + n[1] * b[1]) / inertia
    return [n[0] * q, n[1] * q]


def moving(t, y, acting, sign, stuck):
    """Rates of a state in a fixed state of contact."""
    return y[2:4] + constrained(t, y, acting, sign, stuck) + body_rates(t, y)


def rates(t, y, M):
    """Rates of a state y; t [s], M as recorded."""
    acting = behind(drive(M))
    return moving(t, y, acting, *contact(t, y, acting))


def started(alpha, omega):
    """The state in which a simulation starts: a second body moves with the wheels."""
    return [*alpha, *omega, *omega, 0.0, 0.0][:STATES]


def acceleration(t, alpha, omega, M):
    """Acceleration of the wheels [rad/s^2]; t [s], alpha [rad], omega [rad/s], M as recorded."""
    return rates(t, started(alpha, omega), M)[2:4]


def runge_kutta(t, h, y, start, end, sign, stuck):
    """One step in a fixed state of contact."""

    def at(share, y):
        acting = [start[i] + share * (end[i] - start[i]) for i in range(2)]
        return moving(t + share * h, y, acting, sign, stuck)

    def plus(c, k):
        return [y[i] + c * k[i] for i in range(STATES)]

    k1 = at(0.0, y)
    k2 = at(0.5, plus(0.5 * h, k1))
    k3 = at(0.5, plus(0.5 * h, k2))
    k4 = at(1.0, plus(h, k3))
    return [y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) for i in range(STATES)]


def rest(y, stuck, j):
    """Sets the speed along direction j to zero; stuck directions stay so."""
    d = DIRECTIONS[j]
    if any(stuck):
        return y[:2] + [0.0, 0.0] + y[4:]
    n = (-d[1], d[0])
    q = (n[0] * y[2] + n[1] * y[3]) / (n[0] * n[0] + n[1] * n[1])
    return y[:2] + [n[0] * q, n[1] * q] + y[4:]


def advance(t, h, y, start, end):
    """One step; where a direction reverses in it, the step is split there by a secant."""
    for _ in range(8):
        sign, stuck = contact(t, y, start)
        new = runge_kutta(t, h, y, start, end, sign, stuck)
        share, first = 1.0, -1
        for j in range(4):
            before, after = along(j, y[2:4]), along(j, new[2:4])
            if sign[j] * after < 0.0 and (first < 0 or before / (before - after) < share):
                share, first = before / (before - after), j
        if first < 0:
            return new
        split = [start[i] + share * (end[i] - start[i]) for i in range(2)]
        y = rest(runge_kutta(t, share * h, y, start, split, sign, stuck), stuck, first)
        t, h, start = t + share * h, (1.0 - share) * h, split
    return y


def simulate(t, M, alpha, omega):
    """The motion from recorded torques M, one pair per sample of t [s], and the first state."""
    y = started(alpha, omega)
    states = [y]
    passed = delayed(t, lagged(t, [drive(m) for m in M], {{lag}}), {{delay}})
    acting = [behind(m) for m in passed]
    for k in range(1, len(t)):
        start = acting[k - 1]
        end = acting[k] if LINEAR else start
        steps_a_second = max(1.0 / STEP, 2.0 * fastest_rate(t[k - 1] - t[0], y))
        pieces = max(1, math.ceil((t[k] - t[k - 1]) * steps_a_second - 1e-9))
        h = (t[k] - t[k - 1]) / pieces
        for piece in range(pieces):
            edge = [
                [start[i] + (piece + e) / pieces * (end[i] - start[i]) for i in range(2)]
                for e in range(2)
            ]
            y = advance(t[k - 1] - t[0] + piece * h, h, y, edge[0], edge[1])
        states.append(y)
    return [y[:2] for y in states], [y[2:4] for y in states]
