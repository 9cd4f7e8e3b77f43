//! Writes `docs/effects`: one page with one picture for every effect of the catalogue, and an index.
//!
//! ```text
//! cargo run --release --example effect_pages [-- --only EFFECT]
//! ```
//! Each effect is hidden in simulated recordings, the model without it is fitted to them, and the page
//! shows the torque that this model misses and what adding the effect does to the error. All
//! numbers are seeded: the same program writes the same pages.

mod cases;
mod page;
mod picture;
mod work;

use std::path::Path;

use amigo_ident::effects;
use rayon::prelude::*;

type Failure = Box<dyn std::error::Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    let folder = Path::new("docs/effects");
    std::fs::create_dir_all(folder)?;
    let only = std::env::args().skip_while(|a| a != "--only").nth(1);
    let asked = |id: &str| only.as_deref().is_none_or(|only| only == id);
    let ids: Vec<String> = effects::all().iter().map(|effect| effect.id()).collect();
    ids.par_iter().filter(|id| asked(id)).try_for_each(|id| write(folder, id))?;
    std::fs::write(folder.join("README.md"), page::index())?;
    Ok(())
}

/// Makes the recordings of one effect and writes its page and picture.
fn write(folder: &Path, id: &str) -> Result<(), Failure> {
    let case = cases::find(id).ok_or_else(|| format!("no case for the effect `{id}`"))?;
    let outcome = work::run(case).map_err(|e| format!("{id}: {e}"))?;
    std::fs::write(folder.join(format!("{id}.png")), picture::draw(case, &outcome)?)?;
    std::fs::write(folder.join(format!("{id}.md")), page::page(case, &outcome)?)?;
    Ok(())
}
