//! Writes the robot-scale yard of `maps/`.
//!
//!     cargo run -p joulepath-terrain --example yard -- 7 maps/yard.json

use std::error::Error;

use terrain::{io::json::JsonText, synthetic};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(seed), Some(path)) = (arguments.next(), arguments.next()) else {
        return Err("usage: yard SEED FILE.json".into());
    };
    let yard = synthetic::yard(seed.parse()?);
    let text: Vec<u8> = JsonText::of(&yard).flatten().chain([b'\n']).collect();
    std::fs::write(&path, text)?;
    println!("{path}: {} × {} cells, id {}", yard.grid.rows, yard.grid.columns, yard.content_id());
    Ok(())
}
