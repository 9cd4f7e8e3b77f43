//! Equations of motion of the second simulator: virtual power of frame and wheels in the coordinates of the
//! frame, with smoothed friction. No code is shared with the program's model.
//!
//! With v the speed of the middle A of the axle along the heading, b the turn rate, S the centre of
//! mass of the frame at (-d, -e) from A (behind, to the right), and ground speeds v + l b, v - l b of the wheels:
//!
//! ```text
//! acceleration of S   (v' + d b² + e b',  v b - d b' + e b²)
//! virtual power       m v' + n e b' + n d b²   = F1 + F2            n mass of the frame
//!                     n e v' + (J + n e²) b' - n d v b = l (F1 - F2)
//! m = n + 2 m_w,   J = I_frame + n d² + 2 (m_w l² + I_diameter)
//! wheel i             I s_i' = P_i - r_i F_i,   r_1 s_1 = v + l b,  r_2 s_2 = v - l b
//! ```
//! P is the motor torque less all resistance. With a spring or slip the motor and its gear are a second
//! body, J_g w' = M - resistance - P, and P is the torque passed to the wheel.

use super::hidden::Values;
use super::robots::Machine;

/// Below this share of the top speed a wheel creeps: friction is tanh(w/width). A wheel that breaks away has
/// crept at up to three times it, which must be below the noise of every sensor (0.15 % of the top speed): creep that a
/// sensor resolves is an effect, and a robot with it is not healthy.
const WIDTH: f64 = 1e-4;

/// Frame speed and turn rate, motor angles and speeds, twists of the springs, heading.
pub type State = [f64; 9];
/// Indices in the state: speed, turn rate, motor angle, motor speed, twist of wheel 1, heading.
const V: usize = 0;
const B: usize = 1;
/// Index of the first motor angle.
pub const ANGLE: usize = 2;
/// Index of the first motor speed.
pub const SPEED: usize = 4;
const TWIST: usize = 6;
const HEADING: usize = 8;

/// Spring, damper or slip between motor and wheel.
#[derive(Clone, Copy, Debug)]
struct Link {
    /// Inertia of motor and gear [kg m^2].
    gear: f64,
    /// Spring [N m/rad].
    spring: f64,
    /// Damper, or slip stiffness [N m s/rad].
    damper: f64,
    /// Largest torque [N m].
    most: f64,
}

/// Resistances of a motor beside the base friction, with the catalogue's symbols in brackets.
#[derive(Clone, Debug)]
struct Resistance {
    /// [b, b1, b2]
    viscous: [f64; 2],
    /// [ba1, ba2]
    uneven: [f64; 2],
    /// [o1, o2]
    offset: [f64; 2],
    /// Sine and cosine once a turn [es, ec].
    once: [[f64; 2]; 2],
    /// Sine and cosine n times per turn [rs, rc].
    ripple: [[f64; 2]; 2],
    /// [n]
    order: f64,
    /// [c]
    drag: f64,
    /// [fs]
    sticky: f64,
    /// [ws]
    slow: f64,
    /// [fse]
    exponent: f64,
    /// [fw]
    warm: f64,
    /// [tw]
    warming: f64,
    /// [cl]
    loaded: f64,
    /// [f_t]
    scrub: f64,
    /// [d_y]
    yaw: f64,
    /// [f_c]
    caster: f64,
    /// [g_c, g_s]
    slope: [f64; 2],
    /// [f_k, d_k]
    sliding: [f64; 2],
}

impl Resistance {
    fn new(values: &Values) -> Self {
        let of = |symbol: &str| values.iter().find(|(s, _)| *s == symbol).map_or(0.0, |(_, v)| *v);
        Self {
            viscous: [of("b") + of("b1"), of("b") + of("b2")],
            uneven: [of("ba1"), of("ba2")],
            offset: [of("o1"), of("o2")],
            once: [[of("es1"), of("ec1")], [of("es2"), of("ec2")]],
            ripple: [[of("rs1"), of("rc1")], [of("rs2"), of("rc2")]],
            order: of("n"),
            drag: of("c"),
            sticky: of("fs"),
            slow: of("ws"),
            exponent: of("fse"),
            warm: of("fw"),
            warming: of("tw"),
            loaded: of("cl"),
            scrub: of("f_t"),
            yaw: of("d_y"),
            caster: of("f_c"),
            slope: [of("g_c"), of("g_s")],
            sliding: [of("f_k"), of("d_k")],
        }
    }
}

/// A robot with its hidden effects.
#[derive(Clone, Debug)]
pub struct Mechanics {
    frame: f64,
    behind: f64,
    right: f64,
    wheel: f64,
    yaw: f64,
    /// Inertia of a wheel about its axle, behind the link where there is one.
    spin: f64,
    half_track: f64,
    radius: [f64; 2],
    level: [f64; 2],
    width: f64,
    link: Option<Link>,
    resistance: Resistance,
}

impl Mechanics {
    /// `machine` with effects of these values.
    pub fn new(machine: &Machine, values: &Values, torque: f64) -> Self {
        let c = &machine.truth;
        let value = |symbol: &str| values.iter().find(|(s, _)| *s == symbol).map(|(_, v)| *v);
        let mismatch = value("eps").unwrap_or(0.0);
        let gear = value("jw").or(value("jr"));
        let link = gear.map(|gear| Link {
            gear,
            spring: value("kt").unwrap_or(0.0),
            damper: value("dt").or(value("cs")).unwrap_or(0.0),
            // tyres slide at three times the ordinary torque, springs hold
            most: if value("cs").is_some() { 3.0 * torque } else { f64::INFINITY },
        });
        // m = m4 e r²/(2 l1)
        let lever = c.m4_kg * c.r_m * c.r_m / (2.0 * c.l1_m);
        Self {
            frame: c.m4_kg,
            behind: c.l2_m,
            right: value("m").unwrap_or(0.0) / lever,
            wheel: c.m1_kg,
            yaw: c.iz4_kg_m2 + 2.0 * c.ix1_kg_m2,
            spin: c.iz1_kg_m2,
            half_track: c.l1_m,
            radius: [c.r_m * (1.0 + mismatch), c.r_m * (1.0 - mismatch)],
            level: [c.n1_n * c.f1_m, c.n2_n * c.f2_m],
            width: WIDTH * machine.speed,
            link,
            resistance: Resistance::new(values),
        }
    }

    /// The state in which wheels roll without slip at these speeds [rad/s].
    pub fn rolling(&self, w: [f64; 2]) -> State {
        let rim = [0, 1].map(|i| self.radius[i] * w[i]);
        let mut y: State = [0.0; 9];
        (y[V], y[B]) = (0.5 * (rim[0] + rim[1]), 0.5 * (rim[0] - rim[1]) / self.half_track);
        (y[SPEED], y[SPEED + 1]) = (w[0], w[1]);
        y
    }

    /// The same robot with a larger frame and friction in proportion.
    pub fn loaded(&self, share: f64) -> Self {
        let more = 1.0 + share;
        let level = self.level.map(|f| f * more);
        Self { frame: self.frame * more, yaw: self.yaw * more, level, ..self.clone() }
    }

    /// The fastest rate of the equations [1/s]: friction near rest, or the link.
    pub fn rate(&self) -> f64 {
        let h = &self.resistance;
        let [slide, distance] = h.sliding;
        let shared = h.scrub + h.caster + slide * (1.0 + distance * distance);
        let level = self.level[0].max(self.level[1]) + h.sticky + h.warm + 2.0 * shared;
        let (r, l) = (self.radius[1], self.half_track);
        let turning = self.yaw + self.frame * self.behind.powi(2) + 2.0 * self.wheel * l * l;
        let straight = 0.5 * r * r * (self.frame + 2.0 * self.wheel);
        let rigid = straight.min(0.5 * turning * (r / l).powi(2)) + self.spin;
        let inertia = self.link.map_or(rigid, |link| link.gear.min(rigid));
        let passed = |l: Link| (l.spring / inertia).sqrt().max(2.0 * l.damper / inertia);
        (level / inertia / self.width).max(self.link.map_or(0.0, passed))
    }

    /// Torques that resist the motors [N m], at time t.
    fn resisting(&self, t: f64, y: &State) -> [f64; 2] {
        let h = &self.resistance;
        let w = [y[SPEED], y[SPEED + 1]];
        let dry = |w: f64| (w / self.width).tanh();
        let warm = if h.warm == 0.0 { 0.0 } else { h.warm * (-t / h.warming).exp() };
        let loaded = h.loaded * (w[0] * w[0] - w[1] * w[1]);
        let scrub = h.scrub * dry(w[0] - w[1]) + h.yaw * (w[0] - w[1]);
        let caster = h.caster * dry(w[0] + w[1]);
        [0, 1].map(|i| {
            let (w, angle, side) = (w[i], y[ANGLE + i], if i == 0 { 1.0 } else { -1.0 });
            let fall = |fs: f64| match fs {
                0.0 => 0.0,
                _ => fs * (-(w.abs() / h.slow).powf(h.exponent)).exp(),
            };
            let wave = |[sin, cos]: [f64; 2], n: f64| match (sin, cos) {
                (0.0, 0.0) => 0.0,
                _ => sin * (n * angle).sin() + cos * (n * angle).cos(),
            };
            (self.level[i] + fall(h.sticky) + warm + side * loaded) * dry(w)
                + (h.viscous[i] + h.drag * w.abs()) * w
                + h.uneven[i] * w.abs()
                + h.offset[i]
                + wave(h.once[i], 1.0)
                + wave(h.ripple[i], h.order)
                + side * scrub
                + caster
        })
    }

    /// Force along the heading [N] and torque about A [N m] of the weight on an inclined floor.
    fn weight(&self, heading: f64) -> [f64; 2] {
        let [c, s] = self.resistance.slope;
        if c == 0.0 && s == 0.0 {
            return [0.0; 2];
        }
        // G = m g sin(inclination) r/2; the uphill heading is atan2(g_s, g_c)
        let mass = self.frame + 2.0 * self.wheel;
        let pull = 2.0 * c.hypot(s) / (mass * self.radius[0]);
        let away = heading - s.atan2(c);
        [-pull * mass * away.cos(), -pull * self.frame * self.behind * away.sin()]
    }

    /// Force along the heading [N] and torque about A [N m] of a caster that slides behind the axle, against its
    /// velocity.
    fn slide(&self, v: f64, b: f64) -> [f64; 2] {
        let [level, share] = self.resistance.sliding;
        if level == 0.0 {
            return [0.0; 2];
        }
        // f_k = F r/2; the contact moves at (v, -distance b)
        let (force, distance) = (2.0 * level / self.radius[0], share * self.half_track);
        let across = distance * b;
        let speed = v.hypot(across).hypot(self.width * self.radius[0]);
        [-force * v / speed, -force * distance * across / speed]
    }

    /// Rates of the state under motor torques [N m].
    pub fn rates(&self, t: f64, y: &State, motor: [f64; 2]) -> State {
        let (v, b, l) = (y[V], y[B], self.half_track);
        let resisting = self.resisting(t, y);
        let net = [0, 1].map(|i| motor[i] - resisting[i]);
        let ground = [(v + l * b) / self.radius[0], (v - l * b) / self.radius[1]];
        let slip = [0, 1].map(|i| y[SPEED + i] - ground[i]);
        let passed = match self.link {
            None => net,
            Some(link) => [0, 1].map(|i| {
                let torque = link.spring * y[TWIST + i] + link.damper * slip[i];
                if link.most.is_finite() { link.most * (torque / link.most).tanh() } else { torque }
            }),
        };
        let spin = self.link.map_or(self.spin, |link| self.spin - link.gear);
        let [rolling, turning] = self.frame_rates(v, b, y[HEADING], passed, spin);
        let spun =
            [(rolling + l * turning) / self.radius[0], (rolling - l * turning) / self.radius[1]];
        let motors = match self.link {
            None => spun,
            Some(link) => [0, 1].map(|i| (net[i] - passed[i]) / link.gear),
        };
        [rolling, turning, y[SPEED], y[SPEED + 1], motors[0], motors[1], slip[0], slip[1], b]
    }

    /// Accelerations of the frame under torques that reach the wheels, whose inertias are `spin`.
    fn frame_rates(&self, v: f64, b: f64, heading: f64, passed: [f64; 2], spin: f64) -> [f64; 2] {
        let (n, d, e, l) = (self.frame, self.behind, self.right, self.half_track);
        let [r1, r2] = self.radius;
        let (i1, i2) = (spin / (r1 * r1), spin / (r2 * r2));
        let ([pull, twist], [drag, back]) = (self.weight(heading), self.slide(v, b));
        let [f1, f2] = [passed[0] / r1, passed[1] / r2];
        let along = f1 + f2 + pull + drag - n * d * b * b;
        let about = l * (f1 - f2) + twist + back + n * d * v * b;
        let m = n + 2.0 * self.wheel + i1 + i2;
        let cross = n * e + l * (i1 - i2);
        let j = self.yaw + n * (d * d + e * e) + l * l * (2.0 * self.wheel + i1 + i2);
        let determinant = m * j - cross * cross;
        [(j * along - cross * about) / determinant, (m * about - cross * along) / determinant]
    }
}
