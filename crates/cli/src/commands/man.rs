//! `joulepath man`.

use std::{fs, path::PathBuf};

use anyhow::Context;
use clap::{Args, CommandFactory};
use clap_mangen::Man;

use crate::output;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Write a page for every command into this folder; it is made if need be [default: the first page is printed]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let command = crate::Arguments::command();
    let Some(folder) = &arguments.out else {
        let mut page = Vec::new();
        Man::new(command).render(&mut page)?;
        return output::text(String::from_utf8(page)?);
    };
    let named = || format!("cannot write pages to {}", folder.display());
    fs::create_dir_all(folder).with_context(named)?;
    clap_mangen::generate_to(command, folder).with_context(named)
}
