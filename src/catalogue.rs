//! Lists of like things: the macro by which one line registers a file, and the name that was meant.
//!
//! Every module that holds a list of like things (effects, identification methods,
//! report sections) keeps one file per item and one line per file:
//!
//! ```ignore
//! catalogue! { dyn Effect; inertia::Inertia, coulomb_friction::CoulombFriction }
//! ```
//!
//! which declares the modules and a function `all()` that returns the items in the order written.

/// Declares one module per line and a function `all()` that returns one boxed item of each.
///
/// The item type must implement `Default` and the trait named first.
#[macro_export]
macro_rules! catalogue {
    (dyn $trait:path; $($module:ident :: $item:ident),+ $(,)?) => {
        $(mod $module; pub use $module::$item;)+

        /// Every registered item, in the order of registration.
        #[must_use]
        pub fn all() -> Vec<Box<dyn $trait>> {
            vec![$(Box::new($item::default())),+]
        }
    };
}

/// Likeness (Jaro-Winkler) above which a known name may be what was meant (judgement).
const LIKE: f64 = 0.75;

/// The known name most like `name` in any case; `None` where none is like it.
///
/// ```
/// use amigo_ident::catalogue::nearest;
/// assert_eq!(nearest("Slop", ["stribeck", "slope"]), Some("slope"));
/// assert_eq!(nearest("xyz", ["stribeck", "slope"]), None);
/// ```
#[must_use]
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_lowercase();
    let rated = known.into_iter().map(|known| {
        let likeness = strsim::jaro_winkler(&known.to_lowercase(), &name);
        // of equally like names the one of its length, of these the first
        (likeness, -(known.len().abs_diff(name.len()) as f64), known)
    });
    let best =
        rated.reduce(|best, next| if (next.0, next.1) > (best.0, best.1) { next } else { best })?;
    (best.0 > LIKE).then_some(best.2)
}
