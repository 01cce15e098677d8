//! ROS 1 bags of version 2.0, written by the format's description (<http://wiki.ros.org/Bags/Format/2.0>).

/// A record: its header's fields and its body, each behind its length.
fn record(fields: &[(&str, &[u8])], body: &[u8]) -> Vec<u8> {
    let counted = |bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes(), bytes].concat();
    let field = |(name, value): &(&str, &[u8])| counted(&[name.as_bytes(), b"=", value].concat());
    let header: Vec<u8> = fields.iter().flat_map(field).collect();
    [counted(&header), counted(body)].concat()
}

fn stamp(at_ns: u64) -> [u8; 8] {
    let (seconds, nanoseconds) = ((at_ns / 1_000_000_000) as u32, (at_ns % 1_000_000_000) as u32);
    [seconds.to_le_bytes(), nanoseconds.to_le_bytes()].concat().try_into().unwrap()
}

/// The header of a bag, with the place of its index: 0 of one that was not closed.
pub(crate) fn header(index_pos: u64) -> Vec<u8> {
    let fields: [(&str, &[u8]); 4] = [
        ("op", &[3]),
        ("index_pos", &index_pos.to_le_bytes()),
        ("conn_count", &[1, 0, 0, 0]),
        ("chunk_count", &[1, 0, 0, 0]),
    ];
    [b"#ROSBAG V2.0\n".to_vec(), record(&fields, &[b' '; 64])].concat()
}

/// A topic of a bag.
pub(crate) struct Topic<'a> {
    /// Its number in the bag.
    pub(crate) connection: u32,
    pub(crate) name: &'a str,
    pub(crate) type_name: &'a str,
    pub(crate) definition: &'a str,
}

/// A chunk with the connection of a topic and messages, and the index behind it.
pub(crate) struct Chunk {
    plain: Vec<u8>,
    index: Vec<u8>,
}

impl Chunk {
    pub(crate) fn new(topic: &Topic<'_>, messages: &[(u64, Vec<u8>)]) -> Chunk {
        let counted = |text: String| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
        let about = [
            counted(format!("topic={}", topic.name)),
            counted(format!("type={}", topic.type_name)),
            counted(format!("md5sum={}", "0".repeat(32))),
            counted(format!("message_definition={}", topic.definition)),
        ]
        .concat();
        let conn = topic.connection.to_le_bytes();
        let mut plain = record(&[("op", &[7]), ("conn", &conn), ("topic", topic.name.as_bytes())], &about);
        let mut entries = Vec::new();
        for (at_ns, message) in messages {
            entries.extend([&stamp(*at_ns)[..], &(plain.len() as u32).to_le_bytes()].concat());
            plain.extend(record(&[("op", &[2]), ("conn", &conn), ("time", &stamp(*at_ns))], message));
        }
        let count = (messages.len() as u32).to_le_bytes();
        let index: [(&str, &[u8]); 4] =
            [("op", &[4]), ("ver", &[1, 0, 0, 0]), ("conn", &conn), ("count", &count)];
        Chunk { plain, index: record(&index, &entries) }
    }

    /// The chunk as it is closed, with its index.
    pub(crate) fn closed(&self) -> Vec<u8> {
        let size = (self.plain.len() as u32).to_le_bytes();
        let chunk = record(&[("op", &[5]), ("compression", b"none"), ("size", &size)], &self.plain);
        [chunk, self.index.clone()].concat()
    }

    /// The chunk while it is written: its sizes are still 0.
    pub(crate) fn open(&self) -> Vec<u8> {
        let chunk = record(&[("op", &[5]), ("compression", b"none"), ("size", &[0; 4])], &[]);
        [chunk, self.plain.clone()].concat()
    }
}
