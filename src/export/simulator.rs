//! The identified robot for rigid-body simulators: MJCF (MuJoCo), URDF and SDF.

use std::fmt::Write as _;

use super::body::Body;
use super::document::Identified;
use super::mechanics::{LeftOut, Mechanics};

/// A robot in the format of a simulator.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulator {
    /// Files as name and text.
    pub files: Vec<(String, String)>,
    /// Effects that the format does not express.
    pub left_out: Vec<LeftOut>,
    /// Further remarks for the user.
    pub notes: Vec<String>,
}

/// Standard gravity [m/s^2].
const GRAVITY: f64 = 9.806_65;

/// Time constant \[s\] and damping ratio of contacts and dry friction: twice the step, the stiffest value
/// that MuJoCo allows. With its defaults wheels creep instead of sticking, by 0.03 rad/s RMS on the AmigoBot;
/// with these values by 0.002.
const STIFF: &str = "0.002 1";
/// Impedance of contacts and dry friction: close to that of hard constraints.
const CLOSE: &str = "0.99 0.999 0.001";

/// Difference between the point where the weight acts and the exported centre of mass, in half tracks, above
/// which it is mentioned (judgement): a twentieth of the driving torque of the weight.
const SAME_LEVER: f64 = 0.05;

/// `robot.xml`: MJCF with a chassis that slides and yaws, wheels that roll on the floor, and one motor per
/// wheel whose control is the recorded input.
///
/// Dry friction is `frictionloss` of the wheel joints, and of fixed tendons for turning and forward motion;
/// damping likewise; the inertia of wheels and rotors is `armature`; a lag is the filter of the actuators; an
/// inclined floor rotates gravity. Time-dependent effects are evaluated at `t` \[s\].
#[must_use]
pub fn mjcf(it: &Identified, t: f64) -> Simulator {
    let body = Body::new(&Mechanics::of(it.model, it.values, t), it.model.robot(), it.drive_unit);
    let m = &body.mechanics;
    let left_out = body.left_out(not_in_mjcf(&body));
    let mut out = String::from("<mujoco model=\"robot\">\n");
    out += &comment(it, &body, &left_out);
    out += &options(&body);
    out += "  <worldbody>\n    <geom name=\"floor\" type=\"plane\" size=\"50 50 1\" friction=\"3 0 0\" \
            condim=\"3\"/>\n";
    out += &chassis(&body);
    out += &wheels(&body);
    out += "    </body>\n  </worldbody>\n";
    out += &tendons(m);
    out += &actuators(&body);
    out += "</mujoco>\n";
    Simulator { files: vec![("robot.xml".into(), out)], left_out, notes: body.notes }
}

/// Relative rounding of a damping that is a difference of slopes.
const ROUNDING: f64 = 1e-9;

/// What MJCF cannot express of the mechanics.
fn not_in_mjcf(body: &Body) -> Vec<LeftOut> {
    let m = &body.mechanics;
    let mut left = Vec::new();
    // yaw damping alone has a wheel damping of zero but for rounding
    let between = (1.0 - ROUNDING) * m.damping[1].abs();
    if m.damping[0] < between || m.damping[2] < between {
        left.push(LeftOut { effect: "damping".into(), reason: "a negative damping of the wheels" });
    }
    if m.weight != [0.0; 2] && (m.lever - body.lever()).abs() > SAME_LEVER {
        left.push(LeftOut {
            effect: "turning by the weight".into(),
            reason: "the weight acts at the centre of mass given by the centrifugal constant, which differs from that of the slope",
        });
    }
    left
}

/// Integrator, gravity, turned by an inclined floor, and the stiffness of contacts and dry friction.
fn options(body: &Body) -> String {
    let m = &body.mechanics;
    let mut out = String::new();
    let weight = [0, 1].map(|i| -2.0 * m.weight[i] / (body.r * body.mass));
    let vertical = -(GRAVITY * GRAVITY - weight[0].powi(2) - weight[1].powi(2)).max(0.0).sqrt();
    let _ = writeln!(
        out,
        "  <option timestep=\"0.001\" integrator=\"implicitfast\" cone=\"elliptic\" impratio=\"100\" \
         gravity=\"{} {} {vertical}\"/>",
        weight[0], weight[1]
    );
    let _ = writeln!(
        out,
        "  <default>\n    <joint solreffriction=\"{STIFF}\" solimpfriction=\"{CLOSE}\"/>\n    \
         <tendon solreffriction=\"{STIFF}\" solimpfriction=\"{CLOSE}\"/>\n    \
         <geom solref=\"{STIFF}\" solimp=\"{CLOSE}\"/>\n  </default>"
    );
    out
}

/// The opening tag of the chassis, with its joints, inertia and shape.
fn chassis(body: &Body) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "    <body name=\"chassis\" pos=\"0 0 {}\">", body.r);
    for (name, kind, axis) in [
        ("x", "slide", "1 0 0"),
        ("y", "slide", "0 1 0"),
        ("z", "slide", "0 0 1"),
        ("yaw", "hinge", "0 0 1"),
    ] {
        let _ = writeln!(out, "      <joint name=\"{name}\" type=\"{kind}\" axis=\"{axis}\"/>");
    }
    let _ = writeln!(
        out,
        "      <inertial pos=\"{} 0 0\" mass=\"{}\" diaginertia=\"{yaw} {yaw} {yaw}\"/>",
        -body.behind,
        body.chassis(),
        yaw = body.yaw
    );
    let _ = writeln!(
        out,
        "      <geom type=\"box\" size=\"{0} {0} {1}\" contype=\"0\" conaffinity=\"0\" mass=\"0\"/>",
        0.8 * body.l1,
        0.5 * body.r
    );
    out
}

/// The wheels with damping, dry friction and armature.
fn wheels(body: &Body) -> String {
    let m = &body.mechanics;
    let mut out = String::new();
    let tiny = 1e-4 * body.wheel[0].min(body.wheel[1]);
    for (i, name, side) in [(0, "right", -1.0), (1, "left", 1.0)] {
        let damping = (m.damping[2 * i] - m.damping[1].abs()).max(0.0);
        let _ = writeln!(
            out,
            "      <body name=\"{name}_wheel\" pos=\"0 {} 0\">\n        \
             <joint name=\"{name}\" type=\"hinge\" axis=\"0 1 0\" damping=\"{damping}\" frictionloss=\"{}\" \
             armature=\"{}\"/>\n        \
             <inertial pos=\"0 0 0\" mass=\"{}\" diaginertia=\"{tiny} {tiny} {tiny}\"/>\n        \
             <geom type=\"sphere\" size=\"{}\" friction=\"3 0 0\" condim=\"3\"/>\n      </body>",
            side * body.l1,
            m.friction[i],
            body.wheel[i] - tiny,
            body.wheel_mass,
            body.r
        );
    }
    out
}

/// Friction and damping of turning and forward motion: fixed tendons with the speeds w1 - w2 and w1 + w2.
fn tendons(m: &Mechanics) -> String {
    let mut out = String::new();
    let cross = m.damping[1];
    for (name, sign, friction, damping) in [
        ("turning", -1.0, m.friction[2], (-cross).max(0.0)),
        ("forward", 1.0, m.friction[3], cross.max(0.0)),
    ] {
        if friction != 0.0 || damping != 0.0 {
            let _ = writeln!(
                out,
                "    <fixed name=\"{name}\" frictionloss=\"{friction}\" damping=\"{damping}\">\n      \
                 <joint joint=\"right\" coef=\"1\"/>\n      <joint joint=\"left\" coef=\"{sign}\"/>\n    </fixed>"
            );
        }
    }
    if out.is_empty() { out } else { format!("  <tendon>\n{out}  </tendon>\n") }
}

/// One motor per wheel: gain, bias, limit and lag of the recorded input.
fn actuators(body: &Body) -> String {
    let m = &body.mechanics;
    let mut out = String::from("  <actuator>\n");
    for (i, name) in [(0, "right"), (1, "left")] {
        let gain = body.scale * m.gain[i];
        let lag = if m.lag_s > 0.0 {
            format!(" dyntype=\"filterexact\" dynprm=\"{}\"", m.lag_s)
        } else {
            String::new()
        };
        let limit = body.scale * m.limit;
        let limit = if limit.is_finite() {
            // the limit is that of the input, before the offset
            format!(
                " forcelimited=\"true\" forcerange=\"{} {}\"",
                -limit - m.offset[i],
                limit - m.offset[i]
            )
        } else {
            String::new()
        };
        let _ = writeln!(
            out,
            "    <general name=\"{name}\" joint=\"{name}\" gaintype=\"fixed\" gainprm=\"{gain}\" \
             biastype=\"affine\" biasprm=\"{} 0 0\"{lag}{limit}/>",
            -m.offset[i]
        );
    }
    out + "  </actuator>\n"
}

/// `robot.urdf` and `robot.sdf`: links with masses and inertias, wheels with damping and friction.
///
/// Neither format has an armature, so rotor inertias are included in the inertia of the wheels; friction of
/// turning and forward motion, lags, gains and limits are not supported.
#[must_use]
pub fn urdf_sdf(it: &Identified, t: f64) -> Simulator {
    let body = Body::new(&Mechanics::of(it.model, it.values, t), it.model.robot(), it.drive_unit);
    let m = &body.mechanics;
    let mut left = Vec::new();
    let mut lacks = |is: bool, what: &str, reason: &'static str| {
        if is {
            left.push(LeftOut { effect: what.into(), reason });
        }
    };
    lacks(m.friction[2] != 0.0, "friction of turning", "joints support only their own friction");
    lacks(
        m.friction[3] != 0.0,
        "friction of driving forward",
        "joints support only their own friction",
    );
    lacks(
        m.damping[1] != 0.0,
        "damping between the wheels",
        "joints support only their own damping",
    );
    lacks(m.offset != [0.0; 2], "torque offset", "the format has no bias of actuators");
    lacks(m.weight != [0.0; 2], "inclined floor", "it belongs to the world and not to the robot");
    lacks(m.gain != [1.0; 2], "torque gain", "the format has no gain of actuators");
    lacks(m.limit.is_finite(), "torque limit", "it is that of the input; see the effect");
    lacks(m.lag_s > 0.0, "actuator lag", "the format has no dynamics of actuators");
    let left_out = body.left_out(left);
    let files = vec![
        ("robot.urdf".to_owned(), urdf(it, &body, &left_out)),
        ("robot.sdf".to_owned(), sdf(it, &body, &left_out)),
    ];
    Simulator { files, left_out, notes: body.notes }
}

/// Yaw inertia of chassis and wheels: that of the wheels, half of their axial inertia (a flat disc), is
/// subtracted from the chassis if it is large enough.
fn split_yaw(body: &Body) -> (f64, [f64; 2]) {
    let share = (0.45 * body.yaw / (body.wheel[0] + body.wheel[1])).min(0.5);
    // a diametral inertia below half the axial one is not physical, and physics engines refuse it
    let across = body.wheel.map(|w| 0.5 * w);
    (body.yaw - share * (body.wheel[0] + body.wheel[1]), across)
}

fn urdf(it: &Identified, body: &Body, left_out: &[LeftOut]) -> String {
    let (yaw, across) = split_yaw(body);
    let mut out = String::from("<?xml version=\"1.0\"?>\n<robot name=\"robot\">\n");
    out += &comment(it, body, left_out);
    let _ = writeln!(
        out,
        "  <link name=\"base_link\">\n    <inertial>\n      <origin xyz=\"{} 0 0\"/>\n      <mass value=\"{}\"/>\n      \
         <inertia ixx=\"{yaw}\" ixy=\"0\" ixz=\"0\" iyy=\"{yaw}\" iyz=\"0\" izz=\"{yaw}\"/>\n    </inertial>\n  </link>",
        -body.behind,
        body.chassis()
    );
    for (i, name, side) in [(0, "right", -1.0), (1, "left", 1.0)] {
        let m = &body.mechanics;
        let _ = writeln!(
            out,
            "  <link name=\"{name}_wheel\">\n    <inertial>\n      <mass value=\"{}\"/>\n      \
             <inertia ixx=\"{a}\" ixy=\"0\" ixz=\"0\" iyy=\"{}\" iyz=\"0\" izz=\"{a}\"/>\n    </inertial>\n    \
             <collision>\n      <geometry><sphere radius=\"{}\"/></geometry>\n    </collision>\n  </link>\n  \
             <joint name=\"{name}\" type=\"continuous\">\n    <parent link=\"base_link\"/>\n    \
             <child link=\"{name}_wheel\"/>\n    <origin xyz=\"0 {} 0\"/>\n    <axis xyz=\"0 1 0\"/>\n    \
             <dynamics damping=\"{}\" friction=\"{}\"/>\n  </joint>",
            body.wheel_mass,
            body.wheel[i],
            body.r,
            side * body.l1,
            m.damping[2 * i].max(0.0),
            m.friction[i],
            a = across[i]
        );
    }
    out + "</robot>\n"
}

fn sdf(it: &Identified, body: &Body, left_out: &[LeftOut]) -> String {
    let (yaw, across) = split_yaw(body);
    let mut out = String::from("<?xml version=\"1.0\"?>\n<sdf version=\"1.8\">\n");
    out += &comment(it, body, left_out);
    let _ = writeln!(
        out,
        "  <model name=\"robot\">\n    <link name=\"base_link\">\n      <pose>0 0 {r} 0 0 0</pose>\n      \
         <inertial>\n        <pose>{} 0 0 0 0 0</pose>\n        <mass>{}</mass>\n        \
         <inertia><ixx>{yaw}</ixx><iyy>{yaw}</iyy><izz>{yaw}</izz></inertia>\n      </inertial>\n    </link>",
        -body.behind,
        body.chassis(),
        r = body.r
    );
    for (i, name, side) in [(0, "right", -1.0), (1, "left", 1.0)] {
        let m = &body.mechanics;
        let _ = writeln!(
            out,
            "    <link name=\"{name}_wheel\">\n      <pose>0 {} {r} 0 0 0</pose>\n      <inertial>\n        \
             <mass>{}</mass>\n        <inertia><ixx>{a}</ixx><iyy>{}</iyy><izz>{a}</izz></inertia>\n      \
             </inertial>\n      <collision name=\"tyre\"><geometry><sphere><radius>{r}</radius></sphere></geometry>\
             </collision>\n    </link>\n    <joint name=\"{name}\" type=\"revolute\">\n      \
             <parent>base_link</parent>\n      <child>{name}_wheel</child>\n      <axis>\n        <xyz>0 1 0</xyz>\n        \
             <dynamics><damping>{}</damping><friction>{}</friction></dynamics>\n      </axis>\n    </joint>",
            side * body.l1,
            body.wheel_mass,
            body.wheel[i],
            m.damping[2 * i].max(0.0),
            m.friction[i],
            a = across[i],
            r = body.r
        );
    }
    out + "  </model>\n</sdf>\n"
}

/// The remarks as a comment.
fn comment(it: &Identified, body: &Body, left_out: &[LeftOut]) -> String {
    let mut lines = vec![
        format!("Identified robot \"{}\": experiment {}, {}.", it.model.robot().name, it.experiment, it.method),
        format!("Written by {} {}.", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION")),
        "x forward, y to the left; joint right is wheel 1. Inertias along x and y do not matter on a plane."
            .to_owned(),
    ];
    lines.extend(body.notes.iter().map(|note| format!("Note: {note}.")));
    lines.extend(left_out.iter().map(|l| format!("Not expressed: {}: {}.", l.effect, l.reason)));
    // XML comments must not contain two hyphens
    let text = lines.join("\n    ").replace("--", "- -");
    format!("  <!-- {text} -->\n")
}
