//! MCAP files with damaged chunks: what is whole is read.

#![allow(clippy::unwrap_used)]

mod written;

use recording::{Channel, Error, Format, Map, Reading, read};
use written::{MAP, drive, mcap_of_two_chunks};

fn read_mcap(bytes: Vec<u8>) -> Result<Reading, Error> {
    read(bytes, Format::Mcap, "drive", Some(&Map::from_json(MAP).unwrap()))
}

#[test]
fn the_summary_says_what_messages_are_where_the_chunk_that_describes_them_is_damaged() {
    let (whole, first_chunk) = mcap_of_two_chunks(&drive(1000, 0..200));
    assert_eq!(read_mcap(whole.clone()).unwrap().recording.rows(), 200);
    for at in [first_chunk.start + 60, (first_chunk.start + first_chunk.end) / 2, first_chunk.end - 3] {
        let mut damaged = whole.clone();
        damaged[at] ^= 0x55;
        let Reading { recording, report } = read_mcap(damaged).unwrap();
        let power_w = recording.channel(Channel::Power).unwrap();
        assert_eq!((recording.rows(), power_w[0], power_w[99]), (100, 100.0, 199.0));
        let told = &report.repairs[0].what;
        assert!(told.contains("checksum") && told.contains("cost all messages of 9.900 s"), "{told}");
    }
}

#[test]
fn a_file_of_which_no_chunk_is_whole_is_refused_with_what_is_wrong_with_them() {
    let (mut damaged, first_chunk) = mcap_of_two_chunks(&drive(1000, 0..200));
    damaged[first_chunk.end - 3] ^= 0x01;
    damaged[first_chunk.end + 200] ^= 0x01;
    let refused = read_mcap(damaged).unwrap_err().to_string();
    assert!(refused.contains("checksum") && refused.contains("9.900 s"), "{refused}");
}

#[test]
fn a_damaged_summary_is_not_trusted() {
    let (whole, first_chunk) = mcap_of_two_chunks(&drive(1000, 0..200));
    for from_end in [60, 80, 120] {
        let mut damaged = whole.clone();
        damaged[first_chunk.end - 3] ^= 0x55;
        let at = damaged.len() - from_end;
        damaged[at] ^= 0x55;
        assert!(read_mcap(damaged).is_err());
    }
}
