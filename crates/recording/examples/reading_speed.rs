//! How fast a million rows are read from each format, beside reading the bytes alone.
//!
//!     cargo run --release -p joulepath-recording --example reading_speed -- [ROWS]

#![allow(clippy::unwrap_used)]

use std::{fs, fs::File, io::Write, path::Path, sync::Arc, time::Instant};

use parquet::{
    data_type::DoubleType,
    file::{properties::WriterProperties, writer::SerializedFileWriter},
    schema::parser::parse_message_type,
};
use recording::{Map, read_path};

const CHANNELS: [&str; 8] = [
    "t_s",
    "v_left_mps",
    "v_right_mps",
    "yaw_rate_radps",
    "pitch_rad",
    "roll_rad",
    "motor_current_left_a",
    "motor_current_right_a",
];

fn row(index: usize) -> [f64; 8] {
    let t = index as f64 * 0.02;
    // Rounded as logs are: more digits would be slower to parse than real files.
    let digits = |value: f64| (value * 1e4).round() / 1e4;
    [t, 0.5 + 0.4 * t.sin(), 0.5 - 0.3 * t.sin(), -0.8 * t.sin(), 0.1 * t.cos(), 0.05, 9.0 + t.cos(), 8.0]
        .map(digits)
}

fn write_csv(path: &Path, rows: usize) {
    let mut file = std::io::BufWriter::new(File::create(path).unwrap());
    writeln!(file, "run,{},surface", CHANNELS.join(",")).unwrap();
    for index in 0..rows {
        let cells = row(index).map(|value| value.to_string());
        writeln!(file, "drive-{:02},{},asphalt", index * 10 / rows, cells.join(",")).unwrap();
    }
}

fn write_parquet(path: &Path, rows: usize) {
    let fields: String = CHANNELS.iter().map(|name| format!("required double {name};")).collect();
    let schema = Arc::new(parse_message_type(&format!("message drive {{ {fields} }}")).unwrap());
    let compression = parquet::basic::Compression::SNAPPY;
    let properties = Arc::new(WriterProperties::builder().set_compression(compression).build());
    let mut writer = SerializedFileWriter::new(File::create(path).unwrap(), schema, properties).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for channel in 0..CHANNELS.len() {
        let values: Vec<f64> = (0..rows).map(|index| row(index)[channel]).collect();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(&values, None, None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
}

/// The drive as one topic of a message of the channels' names, in chunks of about a megabyte.
fn write_mcap(path: &Path, rows: usize, compression: &str) {
    let text = |text: &str| [&u32::try_from(text.len()).unwrap().to_le_bytes()[..], text.as_bytes()].concat();
    let record = |opcode: u8, body: &[u8]| [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat();
    let fields: String = CHANNELS.iter().map(|name| format!("float64 {name}\n")).collect();
    let definition = format!(
        "std_msgs/Header header\n{fields}===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    );
    let schema =
        [&1u16.to_le_bytes()[..], &text("lab_msgs/msg/Drive"), &text("ros2msg"), &text(&definition)].concat();
    let channel =
        [&1u16.to_le_bytes()[..], &1u16.to_le_bytes(), &text("/drive"), &text("cdr"), &text("")].concat();
    let mut file = std::io::BufWriter::new(File::create(path).unwrap());
    file.write_all(b"\x89MCAP0\r\n").unwrap();
    file.write_all(&record(1, &[text("ros2"), text("")].concat())).unwrap();
    let mut plain = [record(3, &schema), record(4, &channel)].concat();
    for index in 0..rows {
        let ns = 1_700_000_000_000_000_000 + index as u64 * 20_000_000;
        let mut message =
            [&1u16.to_le_bytes()[..], &0u32.to_le_bytes(), &ns.to_le_bytes(), &ns.to_le_bytes()].concat();
        message.extend([0, 1, 0, 0]);
        message.extend(((ns / 1_000_000_000) as u32).to_le_bytes());
        message.extend(((ns % 1_000_000_000) as u32).to_le_bytes());
        // "odom" with its closing zero ends at byte 17; the numbers begin at 24.
        message.extend([5, 0, 0, 0, b'o', b'd', b'o', b'm', 0, 0, 0, 0, 0, 0, 0, 0]);
        row(index).iter().for_each(|value| message.extend(value.to_le_bytes()));
        plain.extend(record(5, &message));
        if plain.len() > 1 << 20 || index + 1 == rows {
            let packed =
                if compression == "zstd" { zstd::bulk::compress(&plain, 1).unwrap() } else { plain.clone() };
            let mut chunk =
                [&0u64.to_le_bytes()[..], &0u64.to_le_bytes(), &(plain.len() as u64).to_le_bytes()].concat();
            chunk.extend(crc32fast::hash(&plain).to_le_bytes());
            chunk.extend(text(compression));
            chunk.extend((packed.len() as u64).to_le_bytes());
            chunk.extend(&packed);
            file.write_all(&record(6, &chunk)).unwrap();
            plain.clear();
        }
    }
    file.write_all(&record(0x0F, &0u32.to_le_bytes())).unwrap();
    file.write_all(b"\x89MCAP0\r\n").unwrap();
}

fn main() {
    let rows = std::env::args().nth(1).map_or(1_000_000, |rows| rows.parse().unwrap());
    let sources: Vec<String> = CHANNELS[1..]
        .iter()
        .map(|name| format!(r#"{{"channel": "{name}", "topic": "/drive", "fields": ["{name}"]}}"#))
        .collect();
    let map = Map::from_json(&format!(r#"{{"name": "lab", "sources": [{}]}}"#, sources.join(","))).unwrap();
    let folder = tempfile::tempdir().unwrap();
    println!("{rows} rows of {} channels, best of 5\n", CHANNELS.len());
    println!("{:14} {:>8} {:>10} {:>10} {:>20}", "file", "MB", "s", "MB/s", "times the bytes alone");
    for name in ["drive.csv", "drive.parquet", "plain.mcap", "zstd.mcap"] {
        let path = folder.path().join(name);
        match name {
            "drive.csv" => write_csv(&path, rows),
            "drive.parquet" => write_parquet(&path, rows),
            _ => write_mcap(&path, rows, name.strip_suffix(".mcap").filter(|c| *c == "zstd").unwrap_or("")),
        }
        let map = name.ends_with("mcap").then_some(&map);
        let megabytes = fs::metadata(&path).unwrap().len() as f64 / 1e6;
        let best = |work: &dyn Fn()| {
            let time = |_| {
                let start = Instant::now();
                work();
                start.elapsed().as_secs_f64()
            };
            (0..5).map(time).fold(f64::INFINITY, f64::min)
        };
        let bytes_s = best(&|| drop(fs::read(&path).unwrap()));
        let read_s = best(&|| assert_eq!(read_path(&path, map).unwrap().recording.rows(), rows));
        let speed = megabytes / read_s;
        println!("{name:14} {megabytes:8.1} {read_s:10.3} {speed:10.0} {:20.1}", read_s / bytes_s);
    }
}
