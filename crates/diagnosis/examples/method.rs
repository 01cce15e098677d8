//! Writes the tables of `docs/diagnosis.md` anew: priors of all mechanisms, and every numeric constant of this crate with its reason.
//!
//!     cargo run -p joulepath-diagnosis --example method

use std::{error::Error, fs};

#[path = "../tests/method/mod.rs"]
mod method;

fn main() -> Result<(), Box<dyn Error>> {
    let path = method::path();
    let page = method::filled(&fs::read_to_string(&path)?)?;
    fs::write(&path, page)?;
    let constants = method::constants()?;
    let numbers: usize = constants.iter().map(|one| one.values.len()).sum();
    println!("{}: {numbers} numeric constants", path.display());
    for constant in constants.iter().filter(|one| one.reason.is_empty()) {
        println!("{}: `{}` has no reason", constant.file, constant.values[0].0);
    }
    Ok(())
}
