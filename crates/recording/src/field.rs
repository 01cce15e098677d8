//! Field paths of a map, as `velocity[name=front_left_wheel]` or `pose.pose.orientation.heading`.

use crate::definition::{Base, Count, Definition, Field};

/// A name of a path, with the element that is picked where it is an array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Segment {
    pub(crate) name: String,
    pub(crate) pick: Option<Pick>,
}

/// Which element of an array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Pick {
    /// By place.
    At(usize),
    /// The one whose place in a text array beside it holds a text.
    Named { array: String, text: String },
}

/// An angle of a quaternion, in this program's signs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Angle {
    Roll,
    Pitch,
    Heading,
}

impl Angle {
    /// The angle of x, y, z, w; NaN for what is no rotation.
    ///
    /// The rotation takes the body's axes (x forward, y left, z up; REP 103) to the world's. Its roll and yaw have this
    /// program's signs; its pitch is positive nose-down there, so it is turned round here.
    pub(crate) fn of(self, [x, y, z, w]: [f64; 4]) -> f64 {
        let norm2 = x * x + y * y + z * z + w * w;
        // Drivers that know no orientation leave zeros. What is off by more than single precision is no rotation.
        if norm2.is_nan() || (norm2 - 1.0).abs() > 1e-2 {
            return f64::NAN;
        }
        match self {
            Angle::Roll => (2.0 * (w * x + y * z)).atan2(norm2 - 2.0 * (x * x + y * y)),
            Angle::Pitch => -(2.0 * (w * y - z * x) / norm2).clamp(-1.0, 1.0).asin(),
            Angle::Heading => (2.0 * (w * z + x * y)).atan2(norm2 - 2.0 * (y * y + z * z)),
        }
    }
}

/// A path that exists in a definition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Resolved {
    /// It leads to a number.
    Number(Vec<Segment>),
    /// It leads to a quaternion, of which an angle is wanted.
    Angle(Vec<Segment>, Angle),
}

/// Parses a path.
pub(crate) fn parse(path: &str) -> Result<Vec<Segment>, String> {
    // Texts in brackets may hold dots.
    let (mut segments, mut depth, mut start) = (Vec::new(), 0i32, 0);
    for (at, character) in path.char_indices().chain([(path.len(), '.')]) {
        match character {
            '[' => depth += 1,
            ']' => depth -= 1,
            '.' if depth == 0 || at == path.len() => {
                segments.push(segment(path.get(start..at).unwrap_or_default())?);
                start = at + 1;
            }
            _ => {}
        }
    }
    Ok(segments)
}

fn segment(text: &str) -> Result<Segment, String> {
    let wrong = || format!("`{text}` is no part of a field path, as `name`, `name[2]` or `name[names=text]`");
    let (name, pick) = match text.split_once('[') {
        None => (text, None),
        Some((name, inside)) => {
            let inside = inside.strip_suffix(']').ok_or_else(wrong)?;
            let pick = match inside.split_once('=') {
                Some((array, text)) => Pick::Named { array: array.trim().into(), text: text.trim().into() },
                None => Pick::At(inside.parse().map_err(|_| wrong())?),
            };
            (name, Some(pick))
        }
    };
    if name.is_empty() { Err(wrong()) } else { Ok(Segment { name: name.to_owned(), pick }) }
}

/// Follows a path through a definition.
pub(crate) fn resolve(definition: &Definition, path: &str) -> Result<Resolved, String> {
    let mut segments = parse(path)?;
    let angle = match segments.last().map(|last| last.name.as_str()) {
        Some("roll") => Some(Angle::Roll),
        Some("pitch") => Some(Angle::Pitch),
        Some("heading") => Some(Angle::Heading),
        _ => None,
    };
    let mut fields = definition.root();
    let last = segments.len().saturating_sub(1);
    for (depth, segment) in segments.iter().enumerate() {
        let field = find(fields, segment)?;
        match &field.base {
            Base::Number(_) if depth == last => return Ok(Resolved::Number(segments)),
            Base::Message(name) if depth < last => {
                let unknown = || format!("its type {name} is not in the definition");
                fields = definition.fields(name).ok_or_else(unknown)?;
                if let (Some(angle), true) = (angle, depth + 1 == last && name.ends_with("/Quaternion")) {
                    segments.pop();
                    return Ok(Resolved::Angle(segments, angle));
                }
            }
            Base::Message(name) => return Err(format!("`{}` is a {name}, not a number", segment.name)),
            _ => return Err(format!("`{}` is no number", segment.name)),
        }
    }
    Err("the path is empty".into())
}

fn find<'a>(fields: &'a [Field], segment: &Segment) -> Result<&'a Field, String> {
    let names = || fields.iter().map(|field| field.name.as_str()).collect::<Vec<_>>().join(", ");
    let missing = |name: &str| format!("there is no field `{name}`; there are {}", names());
    let at = |name: &str| fields.iter().position(|field| field.name == name).ok_or_else(|| missing(name));
    let place = at(&segment.name)?;
    let field = &fields[place];
    match (&segment.pick, field.count) {
        (None, Count::One) => {}
        (None, _) => return Err(format!("`{}` is an array: pick an element, as in `[0]`", field.name)),
        (Some(_), Count::One) => return Err(format!("`{}` is no array", field.name)),
        (Some(Pick::At(_)), _) => {}
        (Some(Pick::Named { array, .. }), _) => {
            let names = at(array)?;
            if fields[names].base != Base::Text || fields[names].count == Count::One || names > place {
                return Err(format!("`{array}` is no text array before `{}`", field.name));
            }
        }
    }
    Ok(field)
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn angles_have_the_signs_of_this_program() {
        // A turn by 0.2 rad about each axis of the body in turn: left side up, nose down in REP 103, left.
        let (s, c) = 0.1f64.sin_cos();
        assert_relative_eq!(Angle::Roll.of([s, 0.0, 0.0, c]), 0.2, epsilon = 1e-12);
        assert_relative_eq!(Angle::Pitch.of([0.0, s, 0.0, c]), -0.2, epsilon = 1e-12);
        assert_relative_eq!(Angle::Heading.of([0.0, 0.0, s, c]), 0.2, epsilon = 1e-12);
        assert!(Angle::Heading.of([0.0; 4]).is_nan());
    }

    #[test]
    fn paths_are_followed_or_refused_with_what_is_there() {
        let text = "string[] name\nfloat64[] velocity\ngeometry_msgs/Quaternion q\n===\n\
                    MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";
        let definition = Definition::parse("a/B", text).unwrap();
        assert!(matches!(resolve(&definition, "velocity[name=front.left]"), Ok(Resolved::Number(_))));
        assert!(matches!(resolve(&definition, "q.pitch"), Ok(Resolved::Angle(_, Angle::Pitch))));
        for (path, said) in [
            ("velocity", "pick an element"),
            ("speed", "there are name, velocity, q"),
            ("velocity[names=x]", "no field `names`"),
            ("q", "not a number"),
            ("q.v", "there are x, y, z, w"),
            ("velocity[", "no part"),
            ("", "no part"),
        ] {
            let message = resolve(&definition, path).unwrap_err();
            assert!(message.contains(said), "{path}: {message}");
        }
    }
}
