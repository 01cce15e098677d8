//! Printed against documented output: text to the letter but for spaces, numbers within a tolerance.

/// Relative difference that numbers may have: machines round, and searches end, a little differently.
const NUMBER_TOLERANCE: f64 = 0.02;

/// A line that stands for any number of lines.
const ANY_LINES: &str = "...";

/// What stands for anything within a line.
const ANYTHING: &str = "[..]";

#[derive(Debug, Clone, PartialEq)]
enum Piece {
    Text(String),
    /// A number and the size of its last digit; 0 for a count, which has to be right.
    Number(f64, f64),
    Anything,
}

/// Whether the printed output is the documented one. `...` on a line of its own leaves out any number of lines, `[..]` any part of a line.
pub(crate) fn agrees(documented: &str, printed: &str) -> bool {
    let lines = |text: &str| -> Vec<String> {
        text.trim_end().lines().map(|line| line.trim_end().to_owned()).skip_while(String::is_empty).collect()
    };
    lines_agree(&lines(documented), &lines(printed))
}

fn lines_agree(documented: &[String], printed: &[String]) -> bool {
    match documented.split_first() {
        None => printed.is_empty(),
        Some((line, rest)) if line.trim() == ANY_LINES => {
            (0..=printed.len()).any(|skipped| lines_agree(rest, &printed[skipped..]))
        }
        Some((line, rest)) => printed.split_first().is_some_and(|(first, others)| {
            pieces_agree(&pieces(line), &pieces(first)) && lines_agree(rest, others)
        }),
    }
}

fn pieces_agree(documented: &[Piece], printed: &[Piece]) -> bool {
    match (documented.split_first(), printed.split_first()) {
        (None, None) => true,
        (Some((Piece::Anything, rest)), _) => {
            (0..=printed.len()).any(|skipped| pieces_agree(rest, &printed[skipped..]))
        }
        (Some((a, rest)), Some((b, others))) => {
            (piece_agrees(a, b) || is_elapsed(a, rest) && is_elapsed(b, others)) && pieces_agree(rest, others)
        }
        _ => false,
    }
}

/// Whether a number counts milliseconds: these are the machine's, and no claim of the page.
fn is_elapsed(piece: &Piece, rest: &[Piece]) -> bool {
    let unit = matches!(rest.first(), Some(Piece::Text(unit)) if unit.trim_end_matches([',', '.']) == "ms");
    unit && matches!(piece, Piece::Number(..))
}

fn piece_agrees(a: &Piece, b: &Piece) -> bool {
    match (a, b) {
        (Piece::Number(a, digit), Piece::Number(b, other)) => {
            (a - b).abs() <= NUMBER_TOLERANCE * a.abs().max(b.abs()) + 1.001 * digit.max(*other)
        }
        (a, b) => a == b,
    }
}

/// Words and numbers of a line; spaces only part them.
fn pieces(line: &str) -> Vec<Piece> {
    let mut found = Vec::new();
    for word in line.split_whitespace() {
        let mut parts = word.split(ANYTHING).peekable();
        while let Some(part) = parts.next() {
            split_numbers(part, &mut found);
            if parts.peek().is_some() {
                found.push(Piece::Anything);
            }
        }
    }
    found
}

/// Cuts a word where digits begin and end.
fn split_numbers(mut word: &str, found: &mut Vec<Piece>) {
    while !word.is_empty() {
        let text = word.find(|c: char| c.is_ascii_digit()).unwrap_or(word.len());
        if text > 0 {
            found.push(Piece::Text(word[..text].to_owned()));
        }
        word = &word[text..];
        let whole = word.find(|c: char| !c.is_ascii_digit()).unwrap_or(word.len());
        let decimals = word[whole..]
            .strip_prefix('.')
            .map_or(0, |rest| rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len()));
        let end = if decimals > 0 { whole + 1 + decimals } else { whole };
        if let Ok(number) = word[..end].parse() {
            let digit = if decimals > 0 { 0.1_f64.powi(decimals as i32) } else { 0.0 };
            found.push(Piece::Number(number, digit));
        }
        word = &word[end..];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_may_differ_by_two_per_cent_and_text_not_at_all() {
        assert!(agrees("energy 50.83 kJ\n", "energy   50.90 kJ\n"));
        assert!(!agrees("energy 50.83 kJ\n", "energy 53.00 kJ\n"));
        assert!(!agrees("energy 50.83 kJ\n", "power 50.83 kJ\n"));
        assert!(!agrees("drift -3.0 W\n", "drift 3.0 W\n"));
        assert!(agrees("0.19 m\n", "0.20 m\n"), "a last digit may differ by one");
        assert!(!agrees("3 stops\n", "4 stops\n"), "counts are right");
        assert!(agrees("in 421 ms, done\n", "in 17 ms, done\n"), "how long it took is the machine's");
    }

    #[test]
    fn lines_and_parts_of_lines_may_be_left_out_where_the_page_says_so() {
        assert!(agrees("a\n...\nd\n", "a\nb\nc\nd\n"));
        assert!(!agrees("a\nd\n", "a\nb\nd\n"));
        assert!(agrees("id [..] of 3\n", "id 9f3e of 3\n"));
        assert!(!agrees("id [..] of 3\n", "id 9f3e of 4\n"));
        assert!(!agrees("a\n", ""));
        assert!(!agrees("", "a\n"));
    }
}
