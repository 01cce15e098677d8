//! Units of length: names that files use, and codes of the EPSG registry.

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearUnit {
    /// Its name in EPSG's spelling.
    pub name: &'static str,
    /// Length of one [m].
    pub metres: f64,
}

impl LinearUnit {
    /// The metre.
    pub const METRE: LinearUnit = LinearUnit { name: "metre", metres: 1.0 };
    /// The international foot.
    pub const FOOT: LinearUnit = LinearUnit { name: "foot", metres: 0.3048 };
    /// The US survey foot.
    pub const US_SURVEY_FOOT: LinearUnit = LinearUnit { name: "US survey foot", metres: 1200.0 / 3937.0 };

    /// Whether the unit is a metre, to what coordinates of 5e7 m can tell.
    pub fn is_metre(&self) -> bool {
        (self.metres - 1.0).abs() < 1e-10
    }

    /// Whether two units are one.
    pub fn is(&self, other: &LinearUnit) -> bool {
        (self.metres / other.metres - 1.0).abs() < 1e-10
    }

    /// A unit of so many metres.
    pub fn of_metres(metres: f64) -> Self {
        let named = UNITS.iter().find(|(_, _, known)| (known / metres - 1.0).abs() < 1e-9);
        LinearUnit { name: named.map_or("unit of the file's own", |(_, name, _)| name), metres }
    }
}

/// EPSG's units of length: code, name, metres (EPSG dataset, table Unit of Measure).
const UNITS: [(u32, &str, f64); 47] = [
    (9001, "metre", 1.0),
    (9002, "foot", 0.3048),
    (9003, "US survey foot", 1200.0 / 3937.0),
    (1025, "millimetre", 0.001),
    (1033, "centimetre", 0.01),
    (9036, "kilometre", 1000.0),
    (9005, "Clarke's foot", 0.304_797_265_4),
    (9014, "fathom", 1.8288),
    (9030, "nautical mile", 1852.0),
    (9031, "German legal metre", 1.000_013_596_5),
    (9033, "US survey chain", 66.0 * 1200.0 / 3937.0),
    (9034, "US survey link", 0.66 * 1200.0 / 3937.0),
    (9035, "US survey mile", 5280.0 * 1200.0 / 3937.0),
    (9037, "Clarke's yard", 0.914_391_796_2),
    (9038, "Clarke's chain", 20.116_619_516_4),
    (9039, "Clarke's link", 0.201_166_195_164),
    (9040, "British yard (Sears 1922)", 0.914_398_414_616_029),
    (9041, "British foot (Sears 1922)", 0.304_799_471_538_676),
    (9042, "British chain (Sears 1922)", 20.116_765_121_552_6),
    (9043, "British link (Sears 1922)", 0.201_167_651_215_526),
    (9050, "British yard (Benoit 1895 A)", 0.914_399_2),
    (9051, "British foot (Benoit 1895 A)", 0.304_799_733_333_333),
    (9052, "British chain (Benoit 1895 A)", 20.116_782_4),
    (9053, "British link (Benoit 1895 A)", 0.201_167_824),
    (9060, "British yard (Benoit 1895 B)", 0.914_399_204_289_812),
    (9061, "British foot (Benoit 1895 B)", 0.304_799_734_763_271),
    (9062, "British chain (Benoit 1895 B)", 20.116_782_494_375_9),
    (9063, "British link (Benoit 1895 B)", 0.201_167_824_943_759),
    (9070, "British foot (1865)", 0.304_800_833_333_333),
    (9080, "Indian foot", 0.304_799_510_248_147),
    (9081, "Indian foot (1937)", 0.304_798_41),
    (9082, "Indian foot (1962)", 0.304_799_6),
    (9083, "Indian foot (1975)", 0.304_799_5),
    (9084, "Indian yard", 0.914_398_530_744_441),
    (9085, "Indian yard (1937)", 0.914_395_23),
    (9086, "Indian yard (1962)", 0.914_398_8),
    (9087, "Indian yard (1975)", 0.914_398_5),
    (9093, "Statute mile", 1609.344),
    (9094, "Gold Coast foot", 0.304_799_710_181_509),
    (9095, "British foot (1936)", 0.304_800_749_1),
    (9096, "yard", 0.9144),
    (9097, "chain", 20.1168),
    (9098, "link", 0.201_168),
    (9099, "British yard (Sears 1922 truncated)", 0.914_398),
    (9300, "British foot (Sears 1922 truncated)", 0.304_799_333_333_333),
    (9301, "British chain (Sears 1922 truncated)", 20.116_756),
    (9302, "British link (Sears 1922 truncated)", 0.201_167_56),
];

/// The unit with an EPSG code.
pub fn by_epsg_code(code: u32) -> Option<LinearUnit> {
    UNITS.iter().find(|(known, _, _)| *known == code).map(|&(_, name, metres)| LinearUnit { name, metres })
}

/// The unit that a file spells so: names and abbreviations of GDAL, PROJ, Esri and EPSG, whatever their case.
///
/// ```
/// use terrain::crs::by_name;
/// assert_eq!(by_name("Foot_US").unwrap().name, "US survey foot");
/// assert_eq!(by_name(" m ").unwrap().metres, 1.0);
/// assert!(by_name("furlong").is_none());
/// ```
pub fn by_name(spelling: &str) -> Option<LinearUnit> {
    let plain: String = spelling.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
    let of = |name: &str| UNITS.iter().find(|(_, known, _)| *known == name);
    let named = match plain.as_str() {
        "m" | "metre" | "meter" | "metres" | "meters" | "metro" | "metros" | "mètre" | "mètres" => {
            of("metre")
        }
        "ft" | "foot" | "feet" | "internationalfoot" | "internationalfeet" | "footinternational"
        | "footintl" | "feetintl" | "ftint" | "intlfoot" | "intlfeet" => of("foot"),
        "usft" | "ftus" | "footus" | "feetus" | "ussurveyfoot" | "ussurveyfeet" | "surveyfoot"
        | "surveyfeet" | "ussurveyft" | "usfoot" | "usfeet" | "sft" | "footussurvey" | "feetussurvey" => {
            of("US survey foot")
        }
        "mm" | "millimetre" | "millimeter" | "millimetres" | "millimeters" => of("millimetre"),
        "cm" | "centimetre" | "centimeter" | "centimetres" | "centimeters" => of("centimetre"),
        "km" | "kilometre" | "kilometer" | "kilometres" | "kilometers" => of("kilometre"),
        "yd" | "yard" | "yards" => of("yard"),
        "fathom" | "fathoms" | "fath" => of("fathom"),
        "dm" | "decimetre" | "decimeter" | "decimetres" | "decimeters" => {
            return Some(LinearUnit { name: "decimetre", metres: 0.1 });
        }
        _ => UNITS.iter().find(|(_, known, _)| {
            let known = known.to_lowercase();
            known.chars().filter(|c| c.is_alphanumeric()).eq(plain.chars())
        }),
    };
    named.map(|&(_, name, metres)| LinearUnit { name, metres })
}
