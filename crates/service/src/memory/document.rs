//! Memory of a JSON document once it is parsed, told from its text.

/// A number or a literal where it is kept: an element of a list, of which `serde_json::Value` has the largest, 32 bytes. Lists
/// grow by doubling, so that half of one may be empty.
const SCALAR_BYTES: u64 = 2 * 32;
/// The same of a string, whose characters have an allocation of 16 bytes more than they need.
const STRING_BYTES: u64 = SCALAR_BYTES + 16;
/// An element that is a list, and the room for four elements that its first one makes.
const LIST_BYTES: u64 = SCALAR_BYTES + 4 * 32 + 16;
/// An element that is an object, and the first node of its tree, which has room for eleven names and values.
const OBJECT_BYTES: u64 = SCALAR_BYTES + 11 * (24 + 32) + 32;

/// Upper bound of what a parsed document takes beside its text [bytes], whatever types it is read into.
pub(crate) fn document_bytes(text: &[u8]) -> u64 {
    let mut bytes = SCALAR_BYTES;
    let mut at = 0;
    while let Some(byte) = text.get(at) {
        at += 1;
        bytes += match byte {
            // A comma brings one more scalar; what else it may be brings its own.
            b',' | b':' => SCALAR_BYTES,
            b'[' => LIST_BYTES,
            b'{' => OBJECT_BYTES,
            b'"' => {
                let length = string_length(&text[at..]);
                at += length + 1;
                STRING_BYTES + length as u64
            }
            _ => 0,
        };
    }
    bytes
}

/// Length of a string whose opening quote has been read, up to its closing quote or the end of the text [bytes].
fn string_length(text: &[u8]) -> usize {
    let mut at = 0;
    while let Some(byte) = text.get(at) {
        match byte {
            b'"' => return at,
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;

    /// What a value takes at least, by its sizes and without what its allocator adds [bytes].
    fn least_bytes(value: &Value) -> u64 {
        let own = size_of::<Value>() as u64;
        own + match value {
            Value::String(text) => text.capacity() as u64,
            Value::Array(list) => {
                (list.capacity() - list.len()) as u64 * own + list.iter().map(least_bytes).sum::<u64>()
            }
            Value::Object(members) => {
                members.iter().map(|(name, value)| 24 + name.capacity() as u64 + least_bytes(value)).sum()
            }
            _ => 0,
        }
    }

    #[test]
    fn no_document_takes_more_than_the_bound() {
        let many = |element: &str| format!("[{}{element}]", format!("{element},").repeat(10_000));
        for element in [
            "[]",
            "{}",
            "1",
            "\"\"",
            "\"ab\\\"c\"",
            "[[]]",
            "[1]",
            "{\"\":1}",
            "[1,2,3,4,5]",
            "[1,2,3,4,5,6,7,8,9]",
            "null",
            "{\"a\":[]}",
        ] {
            let text = many(element);
            let value: Value = serde_json::from_str(&text).unwrap();
            let (least, bound) = (least_bytes(&value), document_bytes(text.as_bytes()));
            assert!(least <= bound, "{element}: {least} bytes, but {bound} were reserved");
        }
    }

    #[test]
    fn a_map_of_ordinary_numbers_is_not_overrated() {
        let row = format!("[{}]", vec!["123.456"; 1000].join(","));
        let text = format!("[{}]", vec![row; 100].join(","));
        assert!(document_bytes(text.as_bytes()) < 10 * text.len() as u64);
    }

    #[test]
    fn any_text_has_a_bound() {
        for text in ["", "\"", "\"\\", "[[[", "}{", "\"a\\\"", ",,,"] {
            assert!(document_bytes(text.as_bytes()) >= SCALAR_BYTES, "{text}");
        }
    }
}
