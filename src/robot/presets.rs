//! Presets of real robots, with the source of every figure.
//!
//! Geometry and mass are published for all of them. Inertias and friction are seldom published;
//! where they are estimated the preset states how. A preset provides initial values and
//! l1, r and l2; the identified parameters do not depend on the rest.

use super::Construction;

/// Standard acceleration of gravity [m/s²].
const GRAVITY: f64 = 9.806_65;

/// Friction arm over wheel radius if no measurement exists \[1\]: between a bare tyre (about 0.02) and the
/// geared wheel of the AmigoBot (0.2).
const FRICTION_ARM: f64 = 0.1;

/// A robot of the catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    /// Name in the experiment file.
    pub name: &'static str,
    /// Name in reports.
    pub title: &'static str,
    /// Source of the figures, and which of them are estimated.
    pub source: &'static str,
    /// The figures.
    pub construction: Construction,
}

/// All presets, the robot of the paper first.
#[must_use]
pub fn presets() -> Vec<Preset> {
    vec![
        amigobot(),
        pioneer_3dx(),
        turtlebot3_burger(),
        e_puck(),
        create_2(),
        regbot(),
        frc_tank_drive(),
    ]
}

/// The preset of a name; `None` if there is none.
///
/// # Examples
/// ```
/// use amigo_ident::robot::preset;
/// assert_eq!(preset("turtlebot3_burger").unwrap().construction.r_m, 0.033);
/// assert!(preset("unknown").is_none());
/// ```
#[must_use]
pub fn preset(name: &str) -> Option<Preset> {
    presets().into_iter().find(|p| p.name == name)
}

/// The AmigoBot of the paper.
///
/// All figures are published (Tables 1 and 2). The loads add up to 36.7 N, the masses to 38.7 N.
#[must_use]
pub fn amigobot() -> Preset {
    Preset {
        name: "amigobot",
        title: "AmigoBot",
        source: "Giergiel and Buratowski 2010, Tables 1 and 2: all figures published",
        construction: Construction::amigobot(),
    }
}

/// MobileRobots (Adept) Pioneer 3-DX, without payload.
///
/// | figure | from |
/// |---|---|
/// | mass 9 kg in all, wheel diameter 195 mm | data sheet, as in the Webots guide |
/// | body 6.73 kg, centre 60 mm behind the axle, body box 0.341 m x 0.261 m | Webots `Pioneer3dx.proto` |
/// | track 0.33 m | simulation models; the firmware's effective track is 0.357 m (2 mm / `DiffConvFactor` 0.0056) |
/// | wheels 1 kg each, caster 0.27 kg | estimated: what remains of the 9 kg |
/// | wheel inertias | estimated: uniform discs, rotors not counted |
/// | yaw inertia | estimated: uniform box of the body's size |
/// | caster 0.2 m behind the axle, friction | estimated |
#[must_use]
pub fn pioneer_3dx() -> Preset {
    let body = Body { mass: 6.73, behind: 0.06, yaw_inertia: box_inertia(6.73, 0.341, 0.261) };
    let wheels = Wheels { half_track: 0.165, radius: 0.0975, mass: 1.0 };
    let caster = Caster { mass: 0.27, behind: 0.2, radius: 0.0375 };
    Preset {
        name: "pioneer_3dx",
        title: "Pioneer 3-DX",
        source: "data sheet and Webots Pioneer3dx.proto: masses, wheel radius, track, centre of \
                 mass; estimated: inertias (discs, box), wheel masses, friction",
        construction: construction(&body, &wheels, &caster),
    }
}

/// ROBOTIS TurtleBot3 Burger.
///
/// | figure | from |
/// |---|---|
/// | wheel radius 0.033 m, wheels at +-0.08 m, caster at -0.081 m | `turtlebot3_burger.urdf` (ROBOTIS-GIT/turtlebot3) |
/// | base 0.82573504, wheel 0.02849894, scanner 0.114, caster 0.005 kg: 1.002 kg; data sheet 1 kg | same |
/// | wheel inertias 2.0712558e-5 (axle), 1.117558e-5 kg m² (diameter), base yaw inertia 2.0064271e-3 kg m² | same |
/// | centre of mass 4.29 mm behind the axle | worked out from the file's masses and positions |
/// | frame yaw inertia 2.21e-3 kg m² | base as published, with scanner (disc of 35 mm) and caster at the common centre |
/// | yaw inertias of scanner and caster | the file's 0.001 kg m² are placeholders and are not used |
/// | friction | estimated; rotors behind the gear (1:258) are not in the file and not counted |
#[must_use]
pub fn turtlebot3_burger() -> Preset {
    let (base, scanner, caster_mass) = (0.825_735_04, 0.114, 0.005_f64);
    let (scanner_behind, caster_behind) = (0.032_f64, 0.081_f64);
    let mass = base + scanner + caster_mass;
    let behind: f64 = (scanner * scanner_behind + caster_mass * caster_behind) / mass;
    let yaw_inertia = 2.006_427_1e-3
        + base * behind.powi(2)
        + 0.5 * scanner * 0.035_f64.powi(2)
        + scanner * (scanner_behind - behind).powi(2)
        + caster_mass * (caster_behind - behind).powi(2);
    let body = Body { mass, behind, yaw_inertia };
    let wheels = Wheels { half_track: 0.08, radius: 0.033, mass: 0.028_498_94 };
    // the caster is a fixed ball; its mass is counted in the frame
    let caster = Caster { mass: 0.0, behind: caster_behind, radius: 0.0 };
    Preset {
        name: "turtlebot3_burger",
        title: "TurtleBot3 Burger",
        source: "turtlebot3_burger.urdf of ROBOTIS: geometry, masses, inertias; estimated: \
                 scanner inertia, friction",
        construction: Construction {
            ix1_kg_m2: 1.117_558e-5,
            iz1_kg_m2: 2.071_255_8e-5,
            ..construction(&body, &wheels, &caster)
        },
    }
}

/// EPFL / GCtronic e-puck.
///
/// | figure | from |
/// |---|---|
/// | wheel radius 20.5 mm, track 53 mm | FARSA `phyepuck.cpp`, measured on a robot; the Webots guide has 20 and 52 mm |
/// | wheels 10 g, body 78 g, battery 42 g, two glides of 5 g at 22.5 mm | the same; the Webots guide has 150 g in all |
/// | yaw inertia | estimated: disc of 35 mm (body) and box of 43 mm x 55 mm (battery) of that file |
/// | wheel inertias | estimated: uniform discs; the rotor behind the 50:1 gear is not counted |
/// | centre of mass on the axle, friction | estimated; glides before and behind, so S is close to A |
#[must_use]
pub fn e_puck() -> Preset {
    let yaw_inertia = 0.5 * 0.078 * 0.035_f64.powi(2) + box_inertia(0.042, 0.043, 0.055);
    let body = Body { mass: 0.078 + 0.042, behind: 0.0, yaw_inertia };
    let wheels = Wheels { half_track: 0.0265, radius: 0.0205, mass: 0.010 };
    let caster = Caster { mass: 0.010, behind: 0.0225, radius: 0.005 };
    Preset {
        name: "e_puck",
        title: "e-puck",
        source: "FARSA phyepuck.cpp (measured on a robot): geometry, masses; estimated: inertias \
                 (disc, box), centre of mass on the axle, friction",
        construction: construction(&body, &wheels, &caster),
    }
}

/// iRobot Create 2.
///
/// | figure | from |
/// |---|---|
/// | wheel radius 36 mm, track 0.235 m, diameter 0.3485 m | `create_2.urdf.xacro` (AutonomyLab/create_robot) |
/// | mass 3.5 kg, caster 0.13 m ahead | `create_base.urdf.xacro` of it |
/// | wheels 0.2 kg each, caster 0.1 kg | estimated |
/// | yaw inertia | estimated: uniform disc; the 0.5 kg m² of that file is a placeholder |
/// | wheel inertias | estimated: uniform discs; the file's 0.001 kg m² at 0.01 kg are placeholders |
/// | centre of mass 20 mm AHEAD of the axle (l2 negative), friction | estimated: the caster is ahead and must carry load |
#[must_use]
pub fn create_2() -> Preset {
    let mass = 3.5 - 2.0 * 0.2 - 0.1;
    let yaw_inertia = 0.5 * mass * (0.3485_f64 / 2.0).powi(2);
    let body = Body { mass, behind: -0.02, yaw_inertia };
    let wheels = Wheels { half_track: 0.1175, radius: 0.036, mass: 0.2 };
    let caster = Caster { mass: 0.1, behind: -0.13, radius: 0.018 };
    Preset {
        name: "create_2",
        title: "iRobot Create 2",
        source: "create_description of AutonomyLab/create_robot: geometry, mass; estimated: \
                 inertias (discs), wheel masses, centre of mass, friction",
        construction: construction(&body, &wheels, &caster),
    }
}

/// DTU REGBOT, a teaching robot.
///
/// | figure | from |
/// |---|---|
/// | wheel radius 0.03 m, track 0.155 m | course model `regbot_1mg.m` |
/// | wheel inertia 1.07e-4 kg m² | identified with the wheels off the floor; rotor 1.3e-6 kg m² behind 9.69:1: 1.22e-4 |
/// | frame mass 0.744 kg | from a1 + a2 = 4.87e-4 kg m² identified on the floor: 0.84 kg in all |
/// | the same in the course model | motors 0.193, frame 0.32, top 0.27 kg: 0.78 kg |
/// | yaw inertia 1.56e-3 kg m² | from a1 - a2 = 2.93e-4 kg m² identified on the floor |
/// | centre of mass 20 mm AHEAD of the axle (l2 negative) | estimated; that it lies ahead is measured (a3 negative) |
/// | wheels 50 g, support 80 mm ahead, friction | estimated |
#[must_use]
pub fn regbot() -> Preset {
    let body = Body { mass: 0.744, behind: -0.02, yaw_inertia: 1.56e-3 };
    let wheels = Wheels { half_track: 0.0775, radius: 0.03, mass: 0.05 };
    let caster = Caster { mass: 0.0, behind: -0.08, radius: 0.0 };
    Preset {
        name: "regbot",
        title: "DTU REGBOT",
        source: "course model regbot_1mg.m: geometry; identified from recordings of 2016: inertias, \
                 mass; estimated: wheel mass, centre of mass, friction",
        construction: Construction { iz1_kg_m2: 1.07e-4, ..construction(&body, &wheels, &caster) },
    }
}

/// A tank drive of the FIRST Robotics Competition (team 7028, 2022).
///
/// | figure | from |
/// |---|---|
/// | wheel circumference 0.478778 m, track 0.6608 m | code of the team, STMARobotics/frc-7028-2022 |
/// | friction: kS / kA = 0.70 V / 0.37 V s²/m = 1.89 m/s² of the robot's mass | same, both sides together |
/// | mass 57.5 kg | rule limit and batteries: 55 to 60 kg |
/// | wheels 2 kg a side, discs; frame a uniform box of 0.8 m x 0.7 m; centre on the axle | estimated |
///
/// The wheels of a side are one wheel here; turning scrubs, which the base model lacks.
#[must_use]
pub fn frc_tank_drive() -> Preset {
    let wheels =
        Wheels { half_track: 0.6608 / 2.0, radius: 0.478_778 / std::f64::consts::TAU, mass: 2.0 };
    let mass = 57.5 - 2.0 * wheels.mass;
    let body = Body { mass, behind: 0.0, yaw_inertia: box_inertia(mass, 0.8, 0.7) };
    let none = Caster { mass: 0.0, behind: 0.0, radius: 0.0 };
    let deceleration = 0.70 / 0.37;
    let friction_arm = deceleration / GRAVITY * wheels.radius;
    Preset {
        name: "frc_tank_drive",
        title: "FRC tank drive",
        source: "code of STMARobotics/frc-7028-2022: geometry, friction; estimated: mass (55 to 60 \
                 kg), inertias (discs, box), centre of mass",
        construction: Construction {
            f1_m: friction_arm,
            f2_m: friction_arm,
            ..construction(&body, &wheels, &none)
        },
    }
}

struct Body {
    mass: f64,
    behind: f64,
    yaw_inertia: f64,
}

struct Wheels {
    half_track: f64,
    radius: f64,
    mass: f64,
}

struct Caster {
    mass: f64,
    behind: f64,
    radius: f64,
}

/// Yaw inertia of a uniform box [kg m²].
fn box_inertia(mass: f64, length: f64, width: f64) -> f64 {
    mass * (length * length + width * width) / 12.0
}

/// Construction data of a robot whose wheels are uniform discs and whose loads are those at rest.
fn construction(body: &Body, wheels: &Wheels, caster: &Caster) -> Construction {
    let square = wheels.radius * wheels.radius;
    // torques about the axle: the caster carries what the frame's weight tips onto it
    let tipped = if caster.behind == 0.0 { 0.0 } else { body.mass * body.behind / caster.behind };
    let on_a_wheel = (body.mass - tipped) / 2.0 + wheels.mass;
    Construction {
        l1_m: wheels.half_track,
        l2_m: body.behind,
        l3_m: 0.0,
        l4_m: 0.0,
        l5_m: caster.behind,
        r_m: wheels.radius,
        r3_m: caster.radius,
        m1_kg: wheels.mass,
        m2_kg: wheels.mass,
        m3_kg: caster.mass,
        m4_kg: body.mass,
        ix1_kg_m2: 0.25 * wheels.mass * square,
        ix3_kg_m2: 0.0,
        iz1_kg_m2: 0.5 * wheels.mass * square,
        iz3_kg_m2: 0.5 * caster.mass * caster.radius * caster.radius,
        iz4_kg_m2: body.yaw_inertia,
        n1_n: on_a_wheel * GRAVITY,
        n2_n: on_a_wheel * GRAVITY,
        n3_n: (tipped + caster.mass) * GRAVITY,
        f1_m: FRICTION_ARM * wheels.radius,
        f2_m: FRICTION_ARM * wheels.radius,
        f3_m: 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mass(c: &Construction) -> f64 {
        c.m1_kg + c.m2_kg + c.m3_kg + c.m4_kg
    }

    #[test]
    fn every_preset_has_valid_data_and_a_physical_model() {
        for p in presets() {
            assert_eq!(p.construction.check(), Ok(()), "{}", p.name);
            let a = p.construction.parameters();
            assert!(a.has_positive_mass() && a.a4 >= 0.0 && a.a5 >= 0.0, "{}", p.name);
            assert!(!p.source.is_empty() && !p.title.is_empty());
        }
    }

    #[test]
    fn every_preset_is_found_by_its_own_name() {
        for p in presets() {
            assert_eq!(preset(p.name).unwrap(), p);
        }
        assert_eq!(presets()[0].construction, Construction::amigobot());
    }

    #[test]
    fn the_loads_carry_the_weight() {
        for p in presets() {
            let c = &p.construction;
            let weight = mass(c) * GRAVITY;
            let loads = c.n1_n + c.n2_n + c.n3_n;
            // the paper's own table is off by 5 %; the rest is statics, to rounding
            let tolerance = if p.name == "amigobot" { 0.06 } else { 1e-14 };
            assert!((loads - weight).abs() <= tolerance * weight, "{}: {loads} {weight}", p.name);
        }
    }

    #[test]
    fn the_total_masses_are_the_published_ones() {
        // published masses in kg and the digits they are given with
        for (name, published, digits) in [
            ("pioneer_3dx", 9.0, 1e-12),
            ("turtlebot3_burger", 1.0, 0.005),
            ("e_puck", 0.150, 1e-12),
            ("create_2", 3.5, 1e-12),
            ("frc_tank_drive", 57.5, 1e-12),
        ] {
            let found = mass(&preset(name).unwrap().construction);
            assert!((found - published).abs() <= digits, "{name}: {found}");
        }
    }

    #[test]
    fn the_turtlebot_has_the_centre_of_mass_of_the_simulators_own_lumping() {
        // a simulator that lumps the fixed links of the same file prints -0.00429 m
        let c = turtlebot3_burger().construction;
        assert!((c.l2_m - 0.00429).abs() < 5e-6, "{}", c.l2_m);
        assert!((c.iz4_kg_m2 - 2.21e-3).abs() < 5e-6, "{}", c.iz4_kg_m2);
    }

    #[test]
    fn the_regbot_has_the_inertias_identified_on_the_floor() {
        let a = regbot().construction.parameters();
        // identified a1 3.9e-4, a2 0.97e-4 kg m²: two digits, so one per cent
        assert!((a.a1 / 3.9e-4 - 1.0).abs() < 0.01, "{}", a.a1);
        assert!((a.a2 / 0.97e-4 - 1.0).abs() < 0.01, "{}", a.a2);
        assert!(a.a3 < 0.0);
    }

    #[test]
    fn the_tank_drive_coasts_down_by_its_friction_voltage() {
        let c = frc_tank_drive().construction;
        let a = c.parameters();
        // deceleration of the coasting robot; the wheels' own inertia makes it slower than
        // kS/kA = 1.892 m/s² by the ratio of the masses, Iz1/r² = 1 kg a side on 57.5 kg
        let deceleration = a.a4 / (a.a1 + a.a2) * c.r_m;
        let expected = 0.70 / 0.37 * 57.5 / 59.5;
        assert!((deceleration - expected).abs() < 1e-12, "{deceleration} {expected}");
    }
}
