//! Writes results of measurements into the pages of `docs/`, and measures anew.
//!
//!     cargo run -p joulepath-tests --example publish                    # pages from docs/results
//!     cargo run -p joulepath-tests --example publish -- measure         # lists what can be measured
//!     cargo run -p joulepath-tests --example publish -- measure NAME... # runs the commands, then writes the pages
//!
//! A page shows a result between `<!-- result NAME -->` and `<!-- end -->`.

use std::{error::Error, fs};

use joulepath_tests::{
    file,
    published::{Measured, result_file, with_results},
};

/// What can be measured within minutes, each with its command.
const MEASUREMENTS: [(&str, &str); 3] = [
    ("savings", "cargo run --profile ci -p joulepath-tests --example savings_by_ground -- 20 7"),
    ("paper-tables", "cargo run --profile ci -p joulepath-model --example paper_tables"),
    ("range", "cargo run --profile ci -p joulepath-tests --example range_coverage -- score 300"),
];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.split_first() {
        None => {}
        Some((verb, names)) if verb == "measure" && !names.is_empty() => {
            for name in names {
                let (_, command) = MEASUREMENTS
                    .iter()
                    .find(|(known, _)| known == name)
                    .ok_or_else(|| format!("`{name}` is no measurement; there are {}", known()))?;
                let measured = Measured::by(command)?;
                fs::create_dir_all(file("docs/results"))?;
                fs::write(result_file(name), serde_json::to_string_pretty(&measured)? + "\n")?;
            }
        }
        Some(_) => return Err(format!("`measure` wants names: {}", known()).into()),
    }
    for entry in fs::read_dir(file("docs"))? {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == "md") {
            let page = fs::read_to_string(&path)?;
            let renewed = with_results(&page)?;
            if renewed != page {
                fs::write(&path, renewed)?;
                println!("{} renewed", path.display());
            }
        }
    }
    Ok(())
}

fn known() -> String {
    MEASUREMENTS.map(|(name, _)| name).join(", ")
}
