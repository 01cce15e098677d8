//! Well-known text: of the tree that it writes, kind, unit, code and projection.

use super::{
    Crs, Described, LinearUnit, Mercator, Projection, Spacing, Vertical, by_name, epsg, geographic, mercator,
    multiplied, prj,
};

/// Deepest nesting that is read; texts of the EPSG registry have 8.
const DEEPEST: usize = 32;

/// Systems made of others: of a horizontal one and a vertical one, or of one and its transformation.
const COMPOUND: [&str; 4] = ["COMPD_CS", "COMPOUNDCRS", "BOUNDCRS", "SOURCECRS"];

/// Keywords of systems of longitude and latitude, in WKT 1 and 2.
const GEOGRAPHIC: [&str; 5] = ["GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS"];

/// A keyword with what stands in its brackets.
#[derive(Debug, Default)]
struct Node<'a> {
    keyword: &'a str,
    words: Vec<&'a str>,
    nodes: Vec<Node<'a>>,
}

/// What a text says; `None` if it is no WKT and no `.prj`.
pub(super) fn parse(text: &str) -> Option<Crs> {
    let Some((node, rest)) = Node::read(text, 0) else { return prj::parse_words(text) };
    let mut crs = node.crs()?;
    if let Some(multiplied) = multiplied::read(text) {
        crs.projection = Some(multiplied.projection());
    }
    // Esri writes the vertical system behind the horizontal one, without a compound system around them.
    let beside = rest.trim_start().strip_prefix(',').and_then(|rest| Node::read(rest, 0));
    crs.vertical = crs.vertical.or_else(|| beside?.0.vertical());
    crs.text = Some(text.split_whitespace().collect::<Vec<_>>().join(" "));
    if let Some(code) = node.horizontal().epsg_code() {
        let of_code = Crs::from_epsg(code);
        // The registry knows its projection by more than a name.
        crs.mercator = crs.mercator.or(of_code.mercator);
        crs.projection = of_code.projection.or(crs.projection).filter(|_| crs.mercator.is_none());
        crs.text = of_code.text;
    } else if let Some(code) = node.horizontal().geographic_code() {
        crs.text = Some(format!("EPSG:{code}"));
    }
    Some(crs)
}

impl<'a> Node<'a> {
    /// Reads a node and returns what follows it.
    fn read(text: &'a str, depth: usize) -> Option<(Self, &'a str)> {
        let text = text.trim_start();
        let end = text.find(|c: char| !c.is_ascii_alphanumeric() && c != '_')?;
        let (keyword, rest) = text.split_at(end);
        let mut rest = rest.trim_start().strip_prefix(['[', '('])?;
        if keyword.is_empty() || depth == DEEPEST {
            return None;
        }
        let mut node = Node { keyword, ..Node::default() };
        loop {
            rest = rest.trim_start();
            if let Some(quoted) = rest.strip_prefix('"') {
                let (word, after) = quoted.split_once('"')?;
                node.words.push(word);
                rest = after;
            } else if let Some((child, after)) = Node::read(rest, depth + 1) {
                node.nodes.push(child);
                rest = after;
            } else {
                let end = rest.find([',', ']', ')'])?;
                let (word, after) = rest.split_at(end);
                if !word.trim().is_empty() {
                    node.words.push(word.trim());
                }
                rest = after;
            }
            rest = rest.trim_start();
            if let Some(after) = rest.strip_prefix([']', ')']) {
                return Some((node, after));
            }
            rest = rest.strip_prefix(',')?;
        }
    }

    fn is(&self, keywords: &[&str]) -> bool {
        keywords.iter().any(|keyword| self.keyword.eq_ignore_ascii_case(keyword))
    }

    fn child(&self, keywords: &[&str]) -> Option<&Node<'a>> {
        self.nodes.iter().find(|node| node.is(keywords))
    }

    /// The horizontal part of a compound system, or the system itself.
    fn horizontal(&self) -> &Node<'a> {
        let part = self.is(&COMPOUND).then(|| self.nodes.iter().find(|node| node.crs().is_some())).flatten();
        part.map_or(self, Node::horizontal)
    }

    fn crs(&self) -> Option<Crs> {
        if self.is(&COMPOUND) {
            let mut parts = self.nodes.iter();
            let mut crs = parts.find_map(Node::crs)?;
            crs.vertical = crs.vertical.or_else(|| parts.find_map(Node::vertical));
            return Some(crs);
        }
        if self.is(&GEOGRAPHIC) {
            return Some(Crs { is_geographic: true, vertical: self.third_axis(), ..Crs::default() });
        }
        if self.is(&["LOCAL_CS", "ENGCRS", "ENGINEERINGCRS"]) {
            return Some(Crs { unit: self.unit(), ..Crs::default() });
        }
        if !self.is(&["PROJCS", "PROJCRS", "PROJECTEDCRS"]) {
            return None;
        }
        let (vertical, mercator) = (self.third_axis(), self.mercator());
        let projection = if mercator.is_none() { self.projection() } else { None };
        Some(Crs { unit: self.unit(), mercator, projection, vertical, ..Crs::default() })
    }

    fn vertical(&self) -> Option<Vertical> {
        if !self.is(&["VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS"]) {
            return None;
        }
        let of_code = self.epsg_code().and_then(epsg::vertical);
        let is_depth = self.nodes.iter().any(Node::counts_down) || of_code.is_some_and(|code| code.is_depth);
        let unit = self.unit().or(of_code.map(|code| code.unit))?;
        Some(Vertical { unit, is_depth })
    }

    /// Whether an axis, or the parameter by which Esri says so, points down.
    fn counts_down(&self) -> bool {
        let number = || self.words.get(1).and_then(|word| word.parse::<f64>().ok());
        let is_direction = self.words.first().is_some_and(|word| word.eq_ignore_ascii_case("Direction"));
        self.is(&["AXIS"]) && self.words.iter().any(|word| word.eq_ignore_ascii_case("down"))
            || self.is(&["PARAMETER"]) && is_direction && number().is_some_and(|number| number < 0.0)
    }

    /// Unit of the ellipsoidal heights of a system of three axes, if it says one.
    fn third_axis(&self) -> Option<Vertical> {
        let is_up = |node: &&Node<'_>| node.words.iter().any(|word| word.eq_ignore_ascii_case("up"));
        let axis = self.nodes.iter().filter(|node| node.is(&["AXIS"])).find(is_up)?;
        axis.unit().map(|unit| Vertical { unit, is_depth: false })
    }

    /// The unit of a system's own axes: its `UNIT`, or that of its first axis.
    fn unit(&self) -> Option<LinearUnit> {
        let keywords = ["UNIT", "LENGTHUNIT"];
        let axis = || self.child(&["AXIS"]).and_then(|axis| axis.child(&keywords));
        let unit = self.nodes.iter().rev().find(|node| node.is(&keywords)).or_else(axis)?;
        let metres = unit.words.get(1).and_then(|word| word.parse::<f64>().ok());
        match metres.filter(|metres| metres.is_finite() && *metres > 0.0) {
            Some(metres) => Some(LinearUnit::of_metres(metres)),
            None => unit.words.first().and_then(|name| by_name(name)),
        }
    }

    /// The system's own code in the EPSG registry.
    fn epsg_code(&self) -> Option<u32> {
        let authority = self.nodes.iter().rev().find(|node| node.is(&["AUTHORITY", "ID"]))?;
        let [name, code, ..] = authority.words.as_slice() else { return None };
        if name.eq_ignore_ascii_case("EPSG") { code.parse().ok() } else { None }
    }

    /// The code of a geographic system without one, by the name of its datum, if it counts degrees from Greenwich.
    fn geographic_code(&self) -> Option<u32> {
        /// Relative difference that a degree written with ten digits has.
        const WRITTEN_DIGITS: f64 = 1e-9;
        if !self.is(&GEOGRAPHIC) {
            return None;
        }
        let named = self.child(&["DATUM", "ENSEMBLE", "TRF", "GEODETICDATUM"]).unwrap_or(self);
        let number = |node: &Node<'_>| node.words.get(1)?.parse::<f64>().ok();
        let units = ["UNIT", "ANGLEUNIT"];
        let axis = || self.child(&["AXIS"]).and_then(|axis| axis.child(&units));
        let radians = number(self.child(&units).or_else(axis)?)?;
        let is_degree = (radians / 1f64.to_radians() - 1.0).abs() < WRITTEN_DIGITS;
        let is_greenwich =
            self.child(&["PRIMEM", "PRIMEMERIDIAN"]).is_none_or(|meridian| number(meridian) == Some(0.0));
        (is_degree && is_greenwich).then(|| geographic::code_by_name(named.words.first()?)).flatten()
    }

    /// A parameter of a conversion by one of its names, in letters and digits of lower case.
    fn parameter(&self, names: &[&str]) -> Option<f64> {
        let parameters = || self.nodes.iter().filter(|node| node.is(&["PARAMETER"]));
        names.iter().find_map(|name| {
            let named = |node: &&Node<'_>| node.words.first().is_some_and(|word| plain(word) == *name);
            parameters().find(named)?.words.get(1)?.parse::<f64>().ok()
        })
    }

    /// Semi-major axis [m] and inverse flattening of the ellipsoid that a projected system is on.
    fn ellipsoid(&self) -> Option<[f64; 2]> {
        let datum = self.child(&BASE)?.child(&["DATUM", "ENSEMBLE"])?;
        let words = &datum.child(&["SPHEROID", "ELLIPSOID"])?.words;
        Some([words.get(1)?.parse().ok()?, words.get(2)?.parse().ok()?])
    }

    /// The datum of a projected system as PROJ defines it, if its degrees are those of WGS 84; `None` for all others.
    fn earth_centred_datum(&self) -> Option<String> {
        let base = self.child(&BASE)?;
        let datum = base.child(&["DATUM", "ENSEMBLE", "TRF", "GEODETICDATUM"]).unwrap_or(base);
        let named =
            || [datum, base].into_iter().find_map(|node| geographic::code_by_name(node.words.first()?));
        let number = |node: &Node<'_>| node.words.get(1)?.parse::<f64>().ok();
        let is_greenwich =
            base.child(&["PRIMEM", "PRIMEMERIDIAN"]).is_none_or(|meridian| number(meridian) == Some(0.0));
        let code = base.epsg_code().or_else(named).filter(|_| is_greenwich)?;
        geographic::earth_centred_datum(code, self.ellipsoid())
    }

    /// The projection by its method and parameters; `None` without a method.
    fn projection(&self) -> Option<Projection> {
        let conversion = self.child(&["CONVERSION"]).unwrap_or(self);
        let method = plain(conversion.child(&["PROJECTION", "METHOD"])?.words.first()?);
        let (ellipsoid, datum) = (self.ellipsoid(), self.earth_centred_datum());
        let unit_m = self.unit().map_or(1.0, |unit| unit.metres);
        let number = |names: &[&str]| conversion.parameter(names);
        Some(Described { method: &method, number: &number, datum, ellipsoid, unit_m }.projection())
    }

    fn mercator(&self) -> Option<Mercator> {
        let conversion = self.child(&["CONVERSION"]).unwrap_or(self);
        let method = conversion.child(&["PROJECTION", "METHOD"])?.words.first()?.to_lowercase();
        let variant = ["transverse", "oblique", "gauss", "space"].iter().any(|kind| method.contains(kind));
        let is_even = method.contains("equidistant") && method.contains("cylindrical")
            || ["equirectangular", "plate"].iter().any(|kind| method.contains(kind));
        if !(method.contains("mercator") || is_even) || variant {
            return None;
        }
        let number = |names: &[&str]| conversion.parameter(names);
        let metres = self.unit().map_or(1.0, |unit| unit.metres);
        let spherical = ["auxiliary", "pseudo", "visualisation", "web"];
        let words = |node: &Node<'_>| node.words.iter().any(|word| word.contains("+b=6378137"));
        let is_spherical = spherical.iter().any(|kind| method.contains(kind))
            || self.child(&["EXTENSION"]).is_some_and(words);
        if self.ellipsoid().is_some_and(|[semi_major_m, _]| !mercator::is_of_earth(semi_major_m)) {
            return None;
        }
        Some(Mercator::of(&mercator::Parameters {
            is_on_wgs84: self.earth_centred_datum().is_some(),
            spacing: match () {
                () if is_even => Spacing::Even,
                () if is_spherical => Spacing::Spherical,
                () => Spacing::Conformal,
            },
            true_scale_deg: number(&["standardparallel1", "latitudeof1ststandardparallel"]).unwrap_or(0.0),
            origin_latitude_deg: number(&["latitudeoforigin", "latitudeofnaturalorigin", "latitudeofcenter"])
                .unwrap_or(0.0),
            scale: number(&["scalefactor", "scalefactoratnaturalorigin"]),
            central_meridian_deg: number(&["centralmeridian", "longitudeofnaturalorigin"]).unwrap_or(0.0),
            false_origin_m: [
                number(&["falseeasting"]).unwrap_or(0.0) * metres,
                number(&["falsenorthing"]).unwrap_or(0.0) * metres,
            ],
        }))
    }
}

/// Keywords of the geographic system that a projected one is on.
const BASE: [&str; 3] = ["GEOGCS", "BASEGEOGCRS", "BASEGEODCRS"];

/// A name in letters and digits of lower case alone.
fn plain(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FEET: &str = r#"PROJCS["NAD_1983_StatePlane_New_York_Long_Island_FIPS_3104_Feet",GEOGCS["GCS_North_American_1983",
        DATUM["D_North_American_1983",SPHEROID["GRS_1980",6378137.0,298.257222101]],PRIMEM["Greenwich",0.0],
        UNIT["Degree",0.0174532925199433]],PROJECTION["Lambert_Conformal_Conic"],PARAMETER["False_Easting",984250.0],
        UNIT["Foot_US",0.3048006096012192]]"#;

    #[test]
    fn the_unit_is_that_of_the_system_and_not_of_its_geographic_base() {
        let crs = parse(FEET).unwrap();
        assert_eq!(crs.unit.unwrap().name, "US survey foot");
        assert!(!crs.is_geographic && crs.mercator.is_none());
        assert!(crs.text.unwrap().starts_with("PROJCS["));
    }

    #[test]
    fn a_code_names_the_system_and_heights_have_units_of_their_own() {
        let text = r#"COMPD_CS["NAD83 / UTM zone 15N + NAVD88 height (ftUS)",PROJCS["NAD83 / UTM zone 15N",
            GEOGCS["NAD83",DATUM["D",SPHEROID["GRS 1980",6378137,298.257222101]],UNIT["degree",0.0174532925199433]],
            PROJECTION["Transverse_Mercator"],UNIT["metre",1],AUTHORITY["EPSG","26915"]],
            VERT_CS["NAVD88 height (ftUS)",VERT_DATUM["NAVD88",2005],UNIT["US survey foot",0.304800609601219],AXIS["Up",UP]]]"#;
        let crs = parse(text).unwrap();
        assert!(crs.unit.unwrap().is_metre());
        assert_eq!(crs.text.as_deref(), Some("EPSG:26915"));
        let vertical = crs.vertical.unwrap();
        assert_eq!((vertical.unit.name, vertical.is_depth), ("US survey foot", false));
    }

    #[test]
    fn projections_of_other_bodies_are_not_brought_to_the_ground_of_this_one() {
        let of = |radius_m: f64| {
            let text = format!(
                "PROJCS[\"eqc\",GEOGCS[\"body\",DATUM[\"body\",SPHEROID[\"body\",{radius_m},0]]],PROJECTION[\"Equirectangular\"],UNIT[\"metre\",1]]"
            );
            parse(&text).unwrap().mercator
        };
        assert!(of(6_371_000.0 * 1.0011).is_some() && of(6_378_137.0).is_some());
        assert_eq!(of(3_396_190.0), None, "Mars");
        assert_eq!(of(1_737_400.0), None, "the moon");
    }

    #[test]
    fn mercators_are_told_from_their_transverse_namesakes() {
        let mercator = |projection: &str| {
            let text = format!(
                r#"PROJCS["x",GEOGCS["y"],PROJECTION["{projection}"],PARAMETER["scale_factor",0.5],UNIT["m",1]]"#
            );
            parse(&text).unwrap().mercator
        };
        assert_eq!(mercator("Transverse_Mercator"), None);
        assert_eq!(mercator("Mercator_1SP").unwrap().spacing, Spacing::Conformal);
        assert_eq!(mercator("Plate_Carree").unwrap().spacing, Spacing::Even);
        let web = mercator("Mercator_Auxiliary_Sphere").unwrap();
        assert_eq!((web.spacing, web.equator_scale), (Spacing::Spherical, 0.5));
    }

    #[test]
    fn text_that_is_no_system_is_none() {
        let deep = "A[".repeat(10_000);
        for text in ["", "hello", "PROJCS[", "PROJCS[\"x\"", &deep, "\u{e4}[1]", "VERT_CS[\"x\"]"] {
            assert_eq!(parse(text), None, "{}", &text.chars().take(20).collect::<String>());
        }
    }
}
