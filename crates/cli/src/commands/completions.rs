//! `joulepath completions`.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use crate::output;

#[derive(Args)]
#[command(after_help = "\
bash  joulepath completions bash > ~/.local/share/bash-completion/completions/joulepath
zsh   joulepath completions zsh > a folder of $fpath, as _joulepath
fish  joulepath completions fish > ~/.config/fish/completions/joulepath.fish")]
pub(crate) struct Arguments {
    /// The shell
    shell: Shell,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut crate::Arguments::command(), "joulepath", &mut script);
    output::text(String::from_utf8(script)?)
}
