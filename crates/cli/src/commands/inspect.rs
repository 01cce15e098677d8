//! `joulepath inspect`.

use std::path::PathBuf;

use clap::Args;
use recording::inspect::{InspectedField, inspect};

use crate::{failure::BadInput, files, output};

#[derive(Args)]
pub(crate) struct Arguments {
    /// The log: .csv, .parquet, .mcap, .db3, .bag or .ulg, or a folder of `ros2 bag record`
    log: PathBuf,
    /// Where to write the proposed map, to look at, change, and give as `--columns`
    #[arg(long, value_name = "FILE")]
    write_map: Option<PathBuf>,
    /// Print the answer as a JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let found = inspect(&arguments.log).map_err(|error| BadInput(error.to_string()))?;
    if let Some(path) = &arguments.write_map {
        if found.map.is_null() {
            let why = found.notes.join("; ");
            return Err(
                BadInput(format!("{}: no map can be proposed: {why}", arguments.log.display())).into()
            );
        }
        files::write(path, serde_json::to_string_pretty(&found.map)? + "\n")?;
    }
    if arguments.json {
        return output::json(&found);
    }
    output::line(format_args!("{:<44} {:>9} {:>10} {:>24}  as", "name", "samples", "rate", "range"))?;
    for field in &found.fields {
        output::line(line(field))?;
    }
    for note in &found.notes {
        output::line(format_args!("note: {note}"))?;
    }
    Ok(())
}

fn line(field: &InspectedField) -> String {
    let rate = field.rate_hz.map_or("-".to_owned(), |hz| format!("{hz:.1} Hz"));
    let range = field.range.map_or("-".to_owned(), |[low, high]| format!("{low:.4} to {high:.4}"));
    let unit = field.unit.as_ref().map_or(String::new(), |unit| format!(" [{unit}]"));
    let channel = field.channel.as_deref().unwrap_or("-");
    format!(
        "{:<44} {:>9} {rate:>10} {range:>24}  {channel}{unit}: {}",
        field.name, field.samples, field.reason
    )
}
