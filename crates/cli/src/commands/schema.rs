//! `joulepath schema`.

use clap::Args;
use service::{SCHEMAS, schema};

use crate::{failure::BadInput, output};

#[derive(Args)]
pub(crate) struct Arguments {
    /// Which file: robot, map, recording-map or world; without it they are listed
    name: Option<String>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Some(name) = &arguments.name else {
        let width = SCHEMAS.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
        return SCHEMAS
            .iter()
            .try_for_each(|(name, what)| output::line(format_args!("{name:<width$}  {what}")));
    };
    let known = SCHEMAS.map(|(name, _)| name).join(", ");
    let document =
        schema(name).ok_or_else(|| BadInput(format!("there is no schema `{name}`; there are {known}")))?;
    output::line(serde_json::to_string_pretty(&document)?)
}
