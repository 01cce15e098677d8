//! `joulepath open`: the page with the files that it is given, until an interrupt.

mod upload;

use std::{
    net::TcpListener,
    path::PathBuf,
    process::{Command, Stdio},
};

use anyhow::Context;
use clap::Args;
use service::{Engine, Limits, start};

use crate::{allocator::give_back_freed_memory, interrupt, output};
use upload::{Kind, Upload};

/// Where the page is, unless something else is there: the address that `serve` listens on.
const USUAL: &str = "127.0.0.1:8080";
/// Any free port, in its place.
const FREE: &str = "127.0.0.1:0";

#[derive(Args)]
pub(crate) struct Arguments {
    /// Maps, robots and recordings to open; what a file is, its ending and its fields say
    files: Vec<PathBuf>,
    /// Print the address alone, and open no browser
    #[arg(long)]
    no_browser: bool,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    give_back_freed_memory();
    let uploads: Vec<Upload> =
        arguments.files.iter().map(|path| Upload::of(path)).collect::<anyhow::Result<_>>()?;
    let interrupted = interrupt::awaited()?;
    let listener = TcpListener::bind(USUAL).or_else(|_| TcpListener::bind(FREE));
    let listener = listener.context("no free port on this machine")?;
    let service = start(listener, Engine::new(Limits::default(), None)?)?;
    let url = format!("http://{}", service.address);
    let mut page = Page::default();
    for upload in &uploads {
        let id = upload.send(&url)?;
        output::line(format_args!("{:<10} {}", upload.kind.word(), upload.path.display()))?;
        page.shows(upload.kind, id);
    }
    let address = page.address(&url);
    output::line(format_args!("page       {address}"))?;
    if !arguments.no_browser && browser(&address) {
        output::line("opened in the browser; Ctrl-C ends it")?;
    } else {
        output::line("open this address in a browser; Ctrl-C ends it")?;
    }
    // The sender lives as long as the process.
    let _ = interrupted.recv();
    drop(service);
    Ok(())
}

/// What the page shows first.
#[derive(Default)]
struct Page {
    map: Option<String>,
    robot: Option<String>,
    has_recordings: bool,
}

impl Page {
    fn shows(&mut self, kind: Kind, id: String) {
        match kind {
            Kind::Map => self.map = Some(id),
            Kind::Robot => self.robot = Some(id),
            Kind::Recording => self.has_recordings = true,
        }
    }

    /// The address of the tab that has most to do with the files, with what was chosen.
    fn address(&self, url: &str) -> String {
        let tab = if self.has_recordings && self.map.is_none() { "diagnose" } else { "plan" };
        let chosen = [("map", &self.map), ("robot", &self.robot)];
        let said: Vec<String> =
            chosen.iter().filter_map(|(name, id)| Some(format!("{name}={}", id.as_ref()?))).collect();
        let query = if said.is_empty() { String::new() } else { format!("?{}", said.join("&")) };
        format!("{url}/#{tab}{query}")
    }
}

/// Asks the desktop to open an address; false where there is none.
fn browser(address: &str) -> bool {
    let has_desktop = cfg!(target_os = "macos")
        || ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
    let program = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    has_desktop
        && Command::new(program)
            .arg(address)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_opens_where_the_files_belong() {
        let mut page = Page::default();
        assert_eq!(page.address("http://x"), "http://x/#plan");
        page.shows(Kind::Recording, "c".into());
        page.shows(Kind::Robot, "b".into());
        assert_eq!(page.address("http://x"), "http://x/#diagnose?robot=b");
        page.shows(Kind::Map, "a".into());
        assert_eq!(page.address("http://x"), "http://x/#plan?map=a&robot=b");
    }
}
