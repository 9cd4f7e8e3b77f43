//! The macro by which one line registers a file.
//!
//! Every module that holds a list of like things (effects, identification methods,
//! report sections) keeps one file per item and one line here-style:
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
