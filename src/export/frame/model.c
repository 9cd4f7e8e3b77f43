{{header}}
//
// void model_acceleration(t, alpha, omega, M, a);                         a in rad/s^2
// void model_simulate(n, t, M, alpha0, omega0, alpha, omega);             n samples
// void model_rates(t, y, M, dy);                      of the state y = {alpha1, alpha2, omega1, omega2}
// C99; compile together with your own sources and link with -lm.

#include <math.h>

{{parameters}}

enum { STATES = {{states}} };              // numbers of a state
static const int linear = {{linear}};      // the torque runs straight between samples, else held
static const double longest_step = 1e-3;   // of the integration [s]
static const double direction[4][2] = {{1.0, 0.0}, {0.0, 1.0}, {1.0, -1.0}, {1.0, 1.0}};

void model_terms(double t, const double y[], double mass[3], double torque[2], double level[4]);
void model_drive(const double M[2], double acting[2]);
void model_behind(const double M[2], double acting[2]);
void model_rates(double t, const double y[], const double M[2], double rate[]);
void model_acceleration(double t, const double alpha[2], const double omega[2],
                        const double M[2], double a[2]);
void model_simulate(int n, const double t[], double M[][2], const double alpha0[2],
                    const double omega0[2], double alpha[][2], double omega[][2]);

static double sgn(double x) { return (x > 0.0) - (x < 0.0); }

// Mass matrix (m11, m12, m22), resisting torques, levels of dry friction.
void model_terms(double t, const double y[], double mass[3], double torque[2], double level[4]) {
    const double *alpha = y, *omega = y + 2, *body = y + 4;
    (void)t, (void)alpha, (void)omega, (void)body;
    {{terms}}
}

// Rates of the state of a second body; none without one.
static void body_rates(double t, const double y[], double rate[]) {
    const double *alpha = y, *omega = y + 2, *body = y + 4;
    (void)t, (void)alpha, (void)omega, (void)body, (void)rate;
    {{body}}
}

// Fastest rate of a two-mass drivetrain [1/s]; zero without one.
static double fastest_rate(double t, const double y[]) {
    const double *alpha = y, *omega = y + 2, *body = y + 4;
    double fastest[1];
    (void)t, (void)alpha, (void)omega, (void)body;
    {{fastest}}
    return fastest[0];
}

// Torques before lag and delay, from the recorded torques [N m].
void model_drive(const double M[2], double acting[2]) {
    {{drive}}
}

// Acting torques, from those after lag and delay [N m].
void model_behind(const double M[2], double acting[2]) {
    {{behind}}
}

// First-order lag of torques that run straight between samples, in place; tau [s].
static void lag(int n, const double t[], double acting[][2], double tau) {
    double before[2];
    if (n > 0) before[0] = acting[0][0], before[1] = acting[0][1];
    for (int k = 1; k < n; k++) {
        const double h = t[k] - t[k - 1];
        const double left = 40.0 * tau > h ? exp(-h / tau) : 0.0;
        const double mean = (1.0 - left) * tau / h;
        for (int i = 0; i < 2; i++) {
            const double now = acting[k][i];
            acting[k][i] =
                left * acting[k - 1][i] + (mean - left) * before[i] + (1.0 - mean) * now;
            before[i] = now;
        }
    }
}

// Torques as they were time [s] ago, straight between samples, in place; the first is held.
static void postpone(int n, const double t[], double acting[][2], double time) {
    int k = n - 1;
    for (int row = n - 1; row >= 0; row--) {
        const double at = t[row] - time;
        while (k > 0 && t[k] > at) k--;
        for (int i = 0; i < 2; i++) {
            double torque = acting[k][i];
            if (k < n - 1 && at > t[0])
                torque += (at - t[k]) / (t[k + 1] - t[k]) * (acting[k + 1][i] - acting[k][i]);
            acting[row][i] = torque;
        }
    }
}

static double along(int j, const double v[2]) {
    return direction[j][0] * v[0] + direction[j][1] * v[1];
}

// Solves (m11 m12; m12 m22) x = b.
static void solve(const double mass[3], const double b[2], double x[2]) {
    const double det = mass[0] * mass[2] - mass[1] * mass[1];
    x[0] = (mass[2] * b[0] - mass[1] * b[1]) / det;
    x[1] = (mass[0] * b[1] - mass[1] * b[0]) / det;
}

// Sign of the friction in each direction, and whether the direction sticks.
static void contact(double t, const double y[], const double acting[2], double sign[4],
                    int stuck[4]) {
    double mass[3], torque[2], level[4], a[2], held[4] = {0.0};
    int resting[4] = {0}, any = 0;
    model_terms(t, y, mass, torque, level);
    double b[2] = {acting[0] - torque[0], acting[1] - torque[1]};
    for (int j = 0; j < 4; j++) {
        sign[j] = 0.0;
        stuck[j] = 0;
        if (level[j] <= 0.0) continue;
        sign[j] = sgn(along(j, y + 2));
        resting[j] = sign[j] == 0.0;
        any |= resting[j];
        for (int i = 0; i < 2; i++) b[i] -= direction[j][i] * level[j] * sign[j];
    }
    if (!any) return;
    solve(mass, b, a);
    for (int sweep = 0, moved = 1; moved && sweep < 200; sweep++) {
        moved = 0;
        for (int j = 0; j < 4; j++) {
            if (!resting[j]) continue;
            double g[2];
            solve(mass, direction[j], g);
            double wanted = held[j] + along(j, a) / along(j, g);
            wanted = fmin(fmax(wanted, -level[j]), level[j]);
            moved |= fabs(wanted - held[j]) > 1e-14 * level[j];
            for (int i = 0; i < 2; i++) a[i] -= g[i] * (wanted - held[j]);
            held[j] = wanted;
        }
    }
    for (int j = 0; j < 4; j++) {
        if (!resting[j]) continue;
        stuck[j] = fabs(along(j, a)) <= 1e-9;
        sign[j] = stuck[j] ? 0.0 : sgn(along(j, a));
    }
}

// Acceleration in a fixed state of contact [rad/s^2].
static void constrained(double t, const double y[], const double acting[2],
                        const double sign[4], const int stuck[4], double a[2]) {
    double mass[3], torque[2], level[4];
    model_terms(t, y, mass, torque, level);
    double b[2] = {acting[0] - torque[0], acting[1] - torque[1]};
    int count = 0, last = 0;
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 2; i++) b[i] -= direction[j][i] * fmax(level[j], 0.0) * sign[j];
        if (stuck[j]) count++, last = j;
    }
    if (count == 0) {
        solve(mass, b, a);
    } else if (count > 1) {
        a[0] = a[1] = 0.0;
    } else {
        const double n[2] = {-direction[last][1], direction[last][0]};
        const double inertia =
            mass[0] * n[0] * n[0] + 2.0 * mass[1] * n[0] * n[1] + mass[2] * n[1] * n[1];
        const double q = (n[0] * b[0] + n[1] * b[1]) / inertia;
        a[0] = n[0] * q;
        a[1] = n[1] * q;
    }
}

// Rates of a state in a fixed state of contact.
static void moving(double t, const double y[], const double acting[2], const double sign[4],
                   const int stuck[4], double rate[]) {
    rate[0] = y[2];
    rate[1] = y[3];
    constrained(t, y, acting, sign, stuck, rate + 2);
    body_rates(t, y, rate + 4);
}

// Rates of a state y; t [s], M as recorded.
void model_rates(double t, const double y[], const double M[2], double rate[]) {
    double entering[2], acting[2], sign[4];
    int stuck[4];
    model_drive(M, entering);
    model_behind(entering, acting);
    contact(t, y, acting, sign, stuck);
    moving(t, y, acting, sign, stuck, rate);
}

// The state in which a simulation starts: a second body moves with the wheels.
static void started(const double alpha[2], const double omega[2], double y[STATES]) {
    const double all[8] = {alpha[0], alpha[1], omega[0], omega[1], omega[0], omega[1], 0.0, 0.0};
    for (int i = 0; i < STATES; i++) y[i] = all[i];
}

// Acceleration of the wheels [rad/s^2]; t [s], alpha [rad], omega [rad/s], M as recorded.
void model_acceleration(double t, const double alpha[2], const double omega[2],
                        const double M[2], double a[2]) {
    double y[STATES], rate[STATES];
    started(alpha, omega, y);
    model_rates(t, y, M, rate);
    a[0] = rate[2];
    a[1] = rate[3];
}

// One step in a fixed state of contact.
static void runge_kutta(double t, double h, const double y[STATES], const double start[2],
                        const double end[2], const double sign[4], const int stuck[4],
                        double out[STATES]) {
    static const double node[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    double k[STATES] = {0.0}, sum[STATES] = {0.0};
    for (int stage = 0; stage < 4; stage++) {
        const double c = node[stage];
        double at[STATES], acting[2];
        for (int i = 0; i < STATES; i++) at[i] = y[i] + c * h * k[i];
        for (int i = 0; i < 2; i++) acting[i] = start[i] + c * (end[i] - start[i]);
        moving(t + c * h, at, acting, sign, stuck, k);
        for (int i = 0; i < STATES; i++) sum[i] += weight[stage] * k[i];
    }
    for (int i = 0; i < STATES; i++) out[i] = y[i] + h / 6.0 * sum[i];
}

// Sets the speed along direction j to zero; stuck directions stay so.
static void rest(double y[STATES], const int stuck[4], int j) {
    const double n[2] = {-direction[j][1], direction[j][0]};
    double q = (n[0] * y[2] + n[1] * y[3]) / (n[0] * n[0] + n[1] * n[1]);
    if (stuck[0] || stuck[1] || stuck[2] || stuck[3]) q = 0.0;
    y[2] = n[0] * q;
    y[3] = n[1] * q;
}

// One step; where a direction reverses in it, the step is split there by a secant.
static void advance(double t, double h, double y[STATES], const double from[2],
                    const double end[2]) {
    double start[2] = {from[0], from[1]};
    for (int piece = 0; piece < 8; piece++) {
        double sign[4], new[STATES], split[2], share = 1.0;
        int stuck[4], first = -1;
        contact(t, y, start, sign, stuck);
        runge_kutta(t, h, y, start, end, sign, stuck, new);
        for (int j = 0; j < 4; j++) {
            const double before = along(j, y + 2), after = along(j, new + 2);
            if (sign[j] * after < 0.0 && (first < 0 || before / (before - after) < share)) {
                share = before / (before - after);
                first = j;
            }
        }
        if (first >= 0) {
            for (int i = 0; i < 2; i++) split[i] = start[i] + share * (end[i] - start[i]);
            runge_kutta(t, share * h, y, start, split, sign, stuck, new);
            rest(new, stuck, first);
        }
        for (int i = 0; i < STATES; i++) y[i] = new[i];
        if (first < 0) return;
        t += share * h;
        h *= 1.0 - share;
        start[0] = split[0];
        start[1] = split[1];
    }
}

// The motion from recorded torques M, one row per sample of t [s], and the first state. Until a row is done its
// alpha holds the torques that lag and delay pass on.
void model_simulate(int n, const double t[], double M[][2], const double alpha0[2],
                    const double omega0[2], double alpha[][2], double omega[][2]) {
    double y[STATES], last[2] = {0.0, 0.0};
    started(alpha0, omega0, y);
    for (int k = 0; k < n; k++) model_drive(M[k], alpha[k]);
    lag(n, t, alpha, {{lag}});
    postpone(n, t, alpha, {{delay}});
    for (int k = 0; k < n; k++) {
        double now[2];
        model_behind(alpha[k], now);
        if (k > 0) {
            double start[2] = {last[0], last[1]}, end[2] = {last[0], last[1]}, from[2], to[2];
            if (linear) end[0] = now[0], end[1] = now[1];
            const double a_second =
                fmax(1.0 / longest_step, 2.0 * fastest_rate(t[k - 1] - t[0], y));
            const int wanted = (int)ceil((t[k] - t[k - 1]) * a_second - 1e-9);
            const int pieces = wanted > 1 ? wanted : 1;
            const double h = (t[k] - t[k - 1]) / pieces;
            for (int piece = 0; piece < pieces; piece++) {
                for (int i = 0; i < 2; i++) {
                    from[i] = start[i] + (double)piece / pieces * (end[i] - start[i]);
                    to[i] = start[i] + (piece + 1.0) / pieces * (end[i] - start[i]);
                }
                advance(t[k - 1] - t[0] + piece * h, h, y, from, to);
            }
        }
        for (int i = 0; i < 2; i++) {
            last[i] = now[i];
            alpha[k][i] = y[i];
            omega[k][i] = y[2 + i];
        }
    }
}
