//! Text of the catalogue for `experiment effects`.

use std::fmt::Write;

use super::{Description, Effect, Energy, ParameterKind, ParameterSpec, all, find};

/// A table of all registered effects: id, title, equation.
///
/// # Examples
/// ```
/// let text = amigo_ident::effects::overview();
/// assert!(text.contains("viscous_friction"));
/// ```
#[must_use]
pub fn overview() -> String {
    let rows: Vec<Description> = all().iter().map(|effect| effect.description()).collect();
    let widest =
        |text: fn(&Description) -> &str| rows.iter().map(|row| text(row).len()).max().unwrap_or(0);
    let (ids, titles) = (widest(|row| &row.id), widest(|row| &row.title));
    rows.iter().fold(String::new(), |mut out, Description { id, title, equation, .. }| {
        let _ = writeln!(out, "{id:<ids$}  {title:<titles$}  {equation}");
        out
    })
}

/// The description of one registered effect; `None` if the id is unknown.
///
/// # Examples
/// ```
/// let text = amigo_ident::effects::details("stribeck").unwrap();
/// assert!(text.contains("fs") && text.contains("rad/s"));
/// assert!(amigo_ident::effects::details("phlogiston").is_none());
/// ```
#[must_use]
pub fn details(id: &str) -> Option<String> {
    find(id).map(|effect| details_of(effect.as_ref()))
}

/// The description of an effect, registered or custom.
#[must_use]
fn details_of(effect: &dyn Effect) -> String {
    let d = effect.description();
    let mut out = format!("{} ({})\n\n", d.title, d.id);
    let mut line = |name: &str, text: &str| {
        let _ = writeln!(out, "{name:<11} {text}");
    };
    line("equation", &d.equation);
    line("cause", &d.cause);
    line("in data", &d.signature);
    line("excitation", &d.excitation);
    line("energy", energy(effect.energy()));
    if effect.acts_on_input() {
        line("acts on", "the recorded torque, before the equation of motion");
    }
    if !d.equivalent.is_empty() {
        line("same as", &format!("{} (in recordings of the wheels)", d.equivalent.join(", ")));
    }
    out + "\nparameters\n" + &parameters(&effect.parameters())
}

const fn energy(role: Energy) -> &'static str {
    match role {
        Energy::Stores => "stored and returned",
        Energy::DoesNoWork => "no work is done",
        Energy::Dissipates => "dissipated",
        Energy::Supplies => "may be supplied",
    }
}

fn parameters(specs: &[ParameterSpec]) -> String {
    let rows: Vec<[String; 5]> = specs
        .iter()
        .map(|spec| {
            let unit = if spec.unit.is_empty() { "1" } else { &spec.unit };
            let kind = match spec.kind {
                ParameterKind::Linear => "linear",
                ParameterKind::Shape => "shape",
            };
            let range = format!("{} to {}, typical {}", spec.range.0, spec.range.1, spec.typical);
            [spec.symbol.clone(), format!("[{unit}]"), kind.into(), range, spec.meaning.clone()]
        })
        .collect();
    let width = |k: usize| rows.iter().map(|row| row[k].len()).max().unwrap_or(0);
    let (symbols, units, ranges) = (width(0), width(1), width(3));
    rows.iter().fold(String::new(), |mut out, [symbol, unit, kind, range, meaning]| {
        let _ = writeln!(
            out,
            "  {symbol:<symbols$}  {unit:<units$}  {kind:<6}  {range:<ranges$}  {meaning}"
        );
        out
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_overview_has_one_line_an_effect_with_aligned_columns() {
        let text = overview();
        assert_eq!(text.lines().count(), all().len());
        let titles: Vec<usize> = all()
            .iter()
            .zip(text.lines())
            .map(|(effect, line)| line.find(&effect.description().title).unwrap())
            .collect();
        assert!(titles.iter().all(|&column| column == titles[0]));
    }

    #[test]
    fn the_details_name_every_parameter_with_unit_and_range() {
        for effect in all() {
            let text = details(&effect.id()).unwrap();
            for spec in effect.parameters() {
                for part in [&spec.symbol, &spec.unit, &spec.meaning] {
                    assert!(text.contains(part.as_str()), "{}: {part}", effect.id());
                }
                assert!(text.contains(&format!("{} to {}", spec.range.0, spec.range.1)));
            }
        }
        let expected = "\
Back-EMF (back_emf)

equation    k_e w1 on wheel 1, k_e w2 on wheel 2
cause       the torque was recorded as if proportional to the motor voltage
in data     as viscous friction: residual torque in proportion to wheel speed
excitation  different steady speeds; only a measured motor current distinguishes it from viscous friction
energy      dissipated
same as     viscous_friction (in recordings of the wheels)

parameters
  k_e  [N m s/rad]  linear  0 to 1000, typical 0.003  back-EMF constant
";
        assert_eq!(details("back_emf").unwrap(), expected);
    }
}
