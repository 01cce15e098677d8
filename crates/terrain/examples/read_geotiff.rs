//! Reads a GeoTIFF and prints what it is, how long reading took and how much memory was needed at most.
//!
//!     cargo run --release --example read_geotiff -- MAP

use std::{path::PathBuf, time::Instant};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = PathBuf::from(std::env::args().nth(1).ok_or("usage: read_geotiff MAP")?);
    let resident_kb = || -> Option<u64> {
        let status = std::fs::read_to_string("/proc/self/status").ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
        line.split_ascii_whitespace().next()?.parse().ok()
    };
    // Time of this process on all processors, in the system's ticks of a hundredth of a second.
    let cpu_ms = || -> Option<f64> {
        let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
        let fields: Vec<&str> = stat.rsplit(')').next()?.split_ascii_whitespace().collect();
        Some(10.0 * (fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?))
    };
    let before_kb = resident_kb().unwrap_or(0);
    let start = Instant::now();
    let terrain = terrain::io::geotiff::read(&std::fs::read(&path)?, terrain::Terrain::MAX_CELLS)?;
    let ms = start.elapsed().as_secs_f64() * 1e3;
    let peak_kb = resident_kb().unwrap_or(0) - before_kb;
    let said: Vec<&str> = terrain.warnings().iter().map(|warning| warning.detail.as_str()).collect();
    let answer = serde_json::json!({
        "ms": ms, "cpu_ms": cpu_ms(), "cells": terrain.grid.cells(), "peak_kb": peak_kb, "cell_size_m": terrain.grid.cell_size_m,
        "origin_m": terrain.grid.origin_m, "lowest_m": terrain.base_m(), "crs": terrain.crs, "warnings": said,
    });
    println!("{answer}");
    Ok(())
}
