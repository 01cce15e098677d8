//! How a CSV file is written, by its first lines: where the header stands, and what separates its cells.

/// Marks of a line that is a remark.
const REMARKS: [&[u8]; 3] = [b"#", b"%", b"//"];

/// Separators of cells, the likelier last.
const SEPARATORS: [u8; 4] = [b'|', b'\t', b';', b','];

/// The way a file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Dialect {
    /// What separates cells.
    pub(crate) separator: Separator,
    /// Bytes before the header.
    pub(crate) header_at: usize,
    /// Lines before that of the header.
    pub(crate) lines_before: u64,
    /// Remarks before the header.
    pub(crate) remarks: usize,
    /// A later line, from 1, that names the time as a header does, where the header does not.
    pub(crate) later_header: Option<u64>,
}

/// Name of the time in a header.
const TIME: &[u8] = b"t_s";

/// Lines in which a header is looked for.
const LINES_LOOKED_AT: usize = 100;

/// What separates cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Separator {
    /// One byte; two of them hold an empty cell between them.
    Byte(u8),
    /// Spaces, however many.
    Spaces,
}

impl Separator {
    /// The byte at which the parser cuts.
    pub(crate) fn byte(self) -> u8 {
        match self {
            Separator::Byte(byte) => byte,
            Separator::Spaces => b' ',
        }
    }

    /// The separator that a header has most of; the comma where it has none.
    fn of(header: &[u8]) -> Separator {
        let count = |separator: u8| header.iter().filter(|byte| **byte == separator).count();
        let most = SEPARATORS.into_iter().max_by_key(|separator| count(*separator)).unwrap_or(b',');
        match count(most) {
            0 if header.trim_ascii().contains(&b' ') => Separator::Spaces,
            0 => Separator::Byte(b','),
            _ => Separator::Byte(most),
        }
    }

    /// Whether two lines have as many cells.
    fn alike(self, one: &[u8], other: &[u8]) -> bool {
        let cells = |line: &[u8]| match self {
            Separator::Byte(byte) => line.split(|b| *b == byte).count(),
            Separator::Spaces => line.split(u8::is_ascii_whitespace).filter(|cell| !cell.is_empty()).count(),
        };
        cells(one) == cells(other)
    }
}

/// The text of a remark behind its mark; `None` where a line is none.
pub(crate) fn remark(line: &[u8]) -> Option<&[u8]> {
    REMARKS.iter().find_map(|mark| line.trim_ascii_start().strip_prefix(*mark))
}

impl Dialect {
    /// The dialect of a file by its beginning. Blank lines, remarks and Excel's `sep=;` may stand before the header; where numbers
    /// follow remarks at once, the last remark is the header, as NumPy writes it.
    pub(crate) fn of(beginning: &[u8]) -> Dialect {
        let dialect = Dialect::by_header(beginning);
        let names_time = |line: &&[u8]| {
            line.split(|byte| !byte.is_ascii_alphanumeric() && *byte != b'_').any(|word| word == TIME)
        };
        let later = beginning[dialect.header_at..].split(|byte| *byte == b'\n').take(LINES_LOOKED_AT);
        let at =
            later.zip(1u64..).find(|(line, _)| names_time(line)).map(|(_, line)| dialect.lines_before + line);
        Dialect { later_header: at.filter(|line| *line > dialect.lines_before + 1), ..dialect }
    }

    fn by_header(beginning: &[u8]) -> Dialect {
        let (mut at, mut lines_before, mut remarks) = (0, 0, 0);
        let mut given = None;
        let mut last_remark: Option<(Dialect, &[u8])> = None;
        for line in beginning.split_inclusive(|byte| *byte == b'\n') {
            let text = line.trim_ascii();
            if let Some(header) = remark(line) {
                let header_at = at + line.len() - header.len();
                let separator = given.unwrap_or_else(|| Separator::of(header));
                last_remark = Some((
                    Dialect { separator, header_at, lines_before, remarks, later_header: None },
                    header,
                ));
                remarks += 1;
            } else if let (true, Some(separator)) = (lines_before == 0, excel_separator(line)) {
                given = Some(separator);
            } else if !text.is_empty() {
                if let Some((dialect, header)) = last_remark
                    && is_numeric(dialect.separator, text)
                    && dialect.separator.alike(header.trim_ascii(), text)
                {
                    return dialect;
                }
                let separator = given.unwrap_or_else(|| Separator::of(text));
                return Dialect { separator, header_at: at, lines_before, remarks, later_header: None };
            }
            at += line.len();
            lines_before += 1;
        }
        Dialect {
            separator: Separator::Byte(b','),
            header_at: 0,
            lines_before: 0,
            remarks: 0,
            later_header: None,
        }
    }
}

/// The separator that Excel's first line names.
fn excel_separator(line: &[u8]) -> Option<Separator> {
    let line = line.strip_suffix(b"\n").unwrap_or(line);
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    let line = line.strip_prefix(b"\"").and_then(|line| line.strip_suffix(b"\"")).unwrap_or(line);
    let (name, separator) = line.split_at_checked(4)?;
    match separator {
        [byte] if name.eq_ignore_ascii_case(b"sep=") => Some(Separator::Byte(*byte)),
        _ => None,
    }
}

/// Whether the first cell of a line is a number, which no name of a column is.
fn is_numeric(separator: Separator, line: &[u8]) -> bool {
    let first = line.split(|byte| *byte == separator.byte()).next().unwrap_or_default();
    let first = std::str::from_utf8(first.trim_ascii()).unwrap_or_default().replace(',', ".");
    first.parse::<f64>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_is_found_behind_remarks_blank_lines_and_excels_first_line() {
        let comma = Separator::Byte(b',');
        for (text, separator, header, lines_before) in [
            ("a,b\n1,2\n", comma, "a,b\n1,2\n", 0),
            ("# run 3\n\n% at noon; in rain\n// x\na,b\n1,2\n", comma, "a,b\n1,2\n", 4),
            ("sep=;\r\na;b\r\n1;2\r\n", Separator::Byte(b';'), "a;b\r\n1;2\r\n", 1),
            ("\"SEP=,\"\na,b\n1,2\n", comma, "a,b\n1,2\n", 1),
            ("# a b\n# t_s v\n0.1 2\n", Separator::Spaces, " t_s v\n0.1 2\n", 1),
            ("%time,v\n0,2\n", comma, "time,v\n0,2\n", 0),
            ("  a   b\n 1   2\n", Separator::Spaces, "  a   b\n 1   2\n", 0),
            ("a\tb c\n", Separator::Byte(b'\t'), "a\tb c\n", 0),
            ("a|b\n", Separator::Byte(b'|'), "a|b\n", 0),
            ("a, b\n", comma, "a, b\n", 0),
            ("a\n", comma, "a\n", 0),
        ] {
            let dialect = Dialect::of(text.as_bytes());
            assert_eq!(dialect.separator, separator, "{text}");
            assert_eq!((&text[dialect.header_at..], dialect.lines_before), (header, lines_before), "{text}");
        }
    }
}
