//! Message definitions of ROS 1 and ROS 2: `.msg` text with its dependencies behind lines of `=`, IDL, and a library of standard
//! packages for what a file leaves out.

pub(crate) mod idl;
mod standard;
mod token;

use std::collections::BTreeMap;

use crate::error::excerpt;

/// Most fields of one message; real ones stay below 300.
const MOST_FIELDS: usize = 4096;

/// A number type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Primitive {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Primitive {
    pub(crate) fn bytes(self) -> usize {
        match self {
            Primitive::I8 | Primitive::U8 => 1,
            Primitive::I16 | Primitive::U16 => 2,
            Primitive::I32 | Primitive::U32 | Primitive::F32 => 4,
            Primitive::I64 | Primitive::U64 | Primitive::F64 => 8,
        }
    }
}

/// What a field is made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Base {
    Number(Primitive),
    Text,
    /// A text of wide characters, whose width the bytes of a message have to tell.
    WideText,
    /// Two numbers of four bytes: seconds and nanoseconds.
    Time,
    /// Another message, by full name.
    Message(String),
}

/// How many of it there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Count {
    One,
    Fixed(usize),
    Sequence,
}

/// A field of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Field {
    pub(crate) name: String,
    pub(crate) base: Base,
    pub(crate) count: Count,
}

/// A message's fields, and those of all messages within it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Definition {
    root: String,
    messages: BTreeMap<String, Vec<Field>>,
}

impl Definition {
    /// One of a message without fields.
    fn empty(type_name: &str) -> Definition {
        let root = full_name(type_name, "");
        Definition { messages: BTreeMap::from([(root.clone(), Vec::new())]), root }
    }

    /// Begins the fields of a message. One may be defined once more behind a separator; the later text stands for itself.
    fn begin(&mut self, message: &str) {
        self.messages.insert(message.to_owned(), Vec::new());
    }

    /// Parses `.msg` text with its dependencies.
    pub(crate) fn parse(type_name: &str, text: &str) -> Result<Definition, String> {
        let mut definition = Definition::empty(type_name);
        let mut name = definition.root.clone();
        for line in text.lines() {
            let line = line.trim();
            if line.len() > 2 && line.bytes().all(|byte| byte == b'=') {
                continue;
            }
            if let Some(next) = line.strip_prefix("MSG:") {
                name = full_name(next.trim(), "");
                definition.begin(&name);
                continue;
            }
            if let Some(field) = field(line, &name)? {
                add(&mut definition, &name, field)?;
            }
        }
        Ok(definition)
    }

    /// The definition of a type that its file leaves out.
    pub(crate) fn standard(type_name: &str) -> Result<Definition, String> {
        if !type_name.contains('/') {
            return Err("the file does not say of what type its messages are".into());
        }
        let root = full_name(type_name, "");
        if standard::fields(&root).is_none() {
            return Err(format!(
                "the file holds no definition of {root}, which is of no standard package; MCAP files of `ros2 bag record` hold them, \
                 and so does what `ros2 bag convert` writes where the package is installed"
            ));
        }
        Ok(Definition { messages: BTreeMap::new(), root })
    }

    /// Full name of the message itself.
    pub(crate) fn name(&self) -> &str {
        &self.root
    }

    /// Fields of the message itself.
    pub(crate) fn root(&self) -> &[Field] {
        self.fields(&self.root).unwrap_or_default()
    }

    /// Fields of a message within it, or of one of a standard package.
    pub(crate) fn fields(&self, message: &str) -> Option<&[Field]> {
        self.messages.get(message).map(Vec::as_slice).or_else(|| standard::fields(message))
    }

    /// Whether the file itself defines a message.
    pub(crate) fn holds(&self, message: &str) -> bool {
        self.messages.contains_key(message)
    }
}

/// Adds a field to a message.
fn add(definition: &mut Definition, message: &str, field: Field) -> Result<(), String> {
    let fields = definition.messages.entry(message.to_owned()).or_default();
    if fields.iter().any(|other| other.name == field.name) {
        return Err(format!("its definition has two fields `{}` in {message}", excerpt(&field.name)));
    }
    if fields.len() == MOST_FIELDS {
        return Err(format!("its definition has more than {MOST_FIELDS} fields in {message}"));
    }
    fields.push(field);
    Ok(())
}

impl Base {
    /// A message, or the time that it is.
    fn of_message(name: String) -> Base {
        match name.as_str() {
            "builtin_interfaces/Time" | "builtin_interfaces/Duration" => Base::Time,
            _ => Base::Message(name),
        }
    }
}

/// `package/Name` of `package/msg/Name`, and of a bare `Name` within a package.
fn full_name(name: &str, within: &str) -> String {
    let package = |full: &str| full.split_once('/').map_or(String::new(), |(package, _)| package.to_owned());
    match name.split_once('/') {
        Some((package, rest)) => format!("{package}/{}", rest.rsplit('/').next().unwrap_or(rest)),
        // The one type that ROS 1 lets stand without its package from anywhere.
        None if name == "Header" => "std_msgs/Header".into(),
        None => format!("{}/{name}", package(within)),
    }
}

/// The field of a line; `None` for an empty line, a comment or a constant.
fn field(line: &str, within: &str) -> Result<Option<Field>, String> {
    let line = line.split('#').next().unwrap_or_default().trim();
    let Some((kind, rest)) = line.split_once(char::is_whitespace) else {
        return if line.is_empty() { Ok(None) } else { Err(format!("`{line}` is no field of a message")) };
    };
    let rest = rest.trim();
    let name_end = rest.find(|c: char| c.is_whitespace() || c == '=').unwrap_or(rest.len());
    let (name, behind) = rest.split_at(name_end);
    if behind.trim_start().starts_with('=') {
        return Ok(None);
    }
    let (base, count) = match kind.split_once('[') {
        None => (kind, Count::One),
        Some((base, inside)) => match inside.strip_suffix(']') {
            Some("") => (base, Count::Sequence),
            Some(bound) if bound.starts_with("<=") => (base, Count::Sequence),
            Some(fixed) => {
                let count = fixed.parse().map_err(|_| format!("`{kind}` is no array"))?;
                (base, Count::Fixed(count))
            }
            None => return Err(format!("`{kind}` is no array")),
        },
    };
    Ok(Some(Field { name: name.to_owned(), base: parse_base(base, within)?, count }))
}

fn parse_base(name: &str, within: &str) -> Result<Base, String> {
    // A bound of a text, as in `string<=10`, does not show in its bytes.
    let plain = name.split('<').next().unwrap_or(name);
    Ok(match plain {
        "bool" | "uint8" | "char" => Base::Number(Primitive::U8),
        // `byte` is signed in ROS 1 and unsigned in ROS 2; nothing measured comes in it.
        "int8" | "byte" => Base::Number(Primitive::I8),
        "int16" => Base::Number(Primitive::I16),
        "uint16" => Base::Number(Primitive::U16),
        "int32" => Base::Number(Primitive::I32),
        "uint32" => Base::Number(Primitive::U32),
        "int64" => Base::Number(Primitive::I64),
        "uint64" => Base::Number(Primitive::U64),
        "float32" => Base::Number(Primitive::F32),
        "float64" => Base::Number(Primitive::F64),
        "string" => Base::Text,
        "wstring" => Base::WideText,
        "time" | "duration" => Base::Time,
        _ => Base::of_message(full_name(plain, within)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_constants_arrays_and_dependencies_are_told_apart() {
        let text = "# a comment\nHeader header\nuint8 FULL=3\nstring<=9 name \"a=b\"\nfloat64[9] covariance\n\
                    Part[<=4] parts\n================\nMSG: my_msgs/Part\nfloat32 value  # in A\n\
                    ================\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
        let definition = Definition::parse("my_msgs/msg/Whole", text).unwrap();
        let names: Vec<&str> = definition.root().iter().map(|field| field.name.as_str()).collect();
        assert_eq!(names, ["header", "name", "covariance", "parts"]);
        assert_eq!(definition.root()[2].count, Count::Fixed(9));
        assert_eq!(definition.root()[3].base, Base::Message("my_msgs/Part".into()));
        assert_eq!(definition.fields("my_msgs/Part").unwrap()[0].base, Base::Number(Primitive::F32));
        assert_eq!(definition.fields("std_msgs/Header").unwrap()[1].base, Base::Time);
    }

    #[test]
    fn nonsense_is_refused_with_its_text() {
        assert!(Definition::parse("a/B", "float64[x] y").unwrap_err().contains("float64[x]"));
        assert!(Definition::parse("a/B", "lonely").unwrap_err().contains("lonely"));
    }
}
