//! What the EPSG registry says of a code: kind, unit, Mercator or not, heights or depths.
//!
//! The definitions come from `crs-definitions`; a table beside it has what is newer or what definitions of PROJ cannot hold.

mod newer;

use super::{Crs, LinearUnit, Mercator, Vertical, by_epsg_code, by_name, mercator, projection::Projection};

/// Codes of Web Mercator outside the EPSG registry (Google's first, OSGeo's, and two of Esri), and the registry's with heights, which
/// PROJ's definitions lack a word for.
const WEB_MERCATORS: [u32; 5] = [900_913, 41_001, 102_100, 102_113, 6871];
const WEB_MERCATOR: u32 = 3857;
/// Codes of Esri's World Mercator on the ellipsoid: the earlier and the present one.
const WORLD_MERCATORS: [u32; 2] = [54_004, 3395];
const WORLD_MERCATOR: u32 = 3395;

/// Codes of systems that count southings and westings, whose definitions lack the word for it (EPSG v11.022, axes by pyproj 3.7.2).
const SOUTH_WEST: [u32; 5] = [2065, 5513, 8044, 8045, 8352];

/// Projections of the world by Esri's codes.
const OF_ESRI: [(u32, &str); 10] = [
    (54_008, "+proj=sinu +datum=WGS84"),
    (54_009, "+proj=moll +datum=WGS84"),
    (54_010, "+proj=eck6 +datum=WGS84"),
    (54_012, "+proj=eck4 +datum=WGS84"),
    (54_016, "+proj=gall +datum=WGS84"),
    (54_029, "+proj=vandg +datum=WGS84"),
    (54_030, "+proj=robin +datum=WGS84"),
    (54_034, "+proj=cea +datum=WGS84"),
    (54_035, "+proj=eqearth +datum=WGS84"),
    (54_042, "+proj=wintri +datum=WGS84"),
];

/// Heights in other units than the metre: code of the system, code of its unit (EPSG v12).
const HEIGHTS: [(u32, u32); 10] = [
    (5702, 9003),
    (5754, 9095),
    (6130, 9002),
    (6131, 9002),
    (6132, 9002),
    (6360, 9003),
    (8050, 9002),
    (8052, 9003),
    (8228, 9002),
    (10_919, 9003),
];

/// Depths in other units than the metre.
const DEPTHS: [(u32, u32); 6] =
    [(5614, 9002), (6358, 9003), (6359, 9003), (8051, 9002), (8053, 9003), (8897, 9002)];

/// Depths in metres: first and last code (EPSG v12).
const METRE_DEPTHS: [(u32, u32); 23] = [
    (5336, 5336),
    (5612, 5612),
    (5706, 5706),
    (5715, 5715),
    (5734, 5734),
    (5739, 5739),
    (5789, 5789),
    (5831, 5831),
    (5861, 5867),
    (5873, 5873),
    (6357, 6357),
    (7976, 7976),
    (8358, 8358),
    (8378, 8378),
    (9287, 9288),
    (9672, 9672),
    (10_150, 10_151),
    (10_349, 10_349),
    (10_364, 10_364),
    (10_370, 10_379),
    (10_547, 10_552),
    (10_649, 10_650),
    (10_678, 10_678),
];

/// The projected or geographic system with a code.
pub(super) fn horizontal(code: u32) -> Crs {
    let text = Some(format!("EPSG:{code}"));
    if WEB_MERCATORS.contains(&code) {
        let mercator = Some(mercator::WEB);
        return Crs { text, unit: Some(LinearUnit::METRE), mercator, ..Crs::default() };
    }
    if WORLD_MERCATORS.contains(&code) {
        let mercator = Some(mercator::WORLD);
        return Crs { text, unit: Some(LinearUnit::METRE), mercator, ..Crs::default() };
    }
    if let Some((_, definition)) = OF_ESRI.iter().find(|(known, _)| *known == code) {
        return Crs { text, ..by_definition(definition) };
    }
    let Some(definition) = any_definition(code) else { return Crs { text, ..Crs::default() } };
    Crs { text, ..by_definition(&definition) }
}

/// The definition of a code, though nothing be known of its datum.
pub(super) fn any_definition(code: u32) -> Option<String> {
    let definition = definition(code).or_else(|| newer::definition(code))?;
    let axes = if SOUTH_WEST.contains(&code) { " +axis=swu" } else { "" };
    Some(definition + axes)
}

/// The registry's code of the same projection, for codes of others.
pub(super) fn registered(code: u32) -> u32 {
    match code {
        code if WEB_MERCATORS.contains(&code) => WEB_MERCATOR,
        code if WORLD_MERCATORS.contains(&code) => WORLD_MERCATOR,
        code => code,
    }
}

/// What the registry says of a code as PROJ writes it, with the scale under the name that `proj4rs` reads for every projection.
pub(super) fn definition(code: u32) -> Option<String> {
    let definition = u16::try_from(code).ok().and_then(crs_definitions::from_code)?;
    // Of some codes the table has an empty one.
    Some(definition.proj4).filter(|words| words.contains("+proj=")).map(|words| words.replace("+k_0=", "+k="))
}

/// What a PROJ definition says of axes, unit, heights and projection.
pub(super) fn by_definition(definition: &str) -> Crs {
    let value = |key: &str| {
        let mut words = definition.split_ascii_whitespace();
        words.find_map(|word| word.strip_prefix('+')?.strip_prefix(key)?.strip_prefix('='))
    };
    let unit = |length: &str, name: &str| match value(length).map(|metres| metres.parse::<f64>()) {
        Some(Ok(metres)) if metres > 0.0 && metres.is_finite() => Some(LinearUnit::of_metres(metres)),
        Some(_) => None,
        None => value(name).map_or(Some(LinearUnit::METRE), by_proj_name),
    };
    let says_vertical = value("vto_meter").or(value("vunits")).is_some();
    let vertical_unit = unit("vto_meter", "vunits").filter(|_| says_vertical);
    let vertical = vertical_unit.map(|unit| Vertical { unit, is_depth: false });
    if matches!(value("proj"), Some("longlat" | "latlong")) {
        return Crs { is_geographic: true, vertical, ..Crs::default() };
    }
    if matches!(value("proj"), Some("geocent" | "cart")) {
        return Crs::default();
    }
    let unit = unit("to_meter", "units");
    let mercator = Mercator::from_proj(value);
    let projection = mercator.is_none().then(|| Projection::of(definition));
    Crs { unit, mercator, projection, vertical, ..Crs::default() }
}

/// The unit that PROJ names so.
fn by_proj_name(name: &str) -> Option<LinearUnit> {
    match name {
        "us-ch" => by_epsg_code(9033),
        "us-mi" => by_epsg_code(9035),
        "ch" => by_epsg_code(9097),
        "link" => by_epsg_code(9098),
        "kmi" => by_epsg_code(9030),
        "mi" => by_epsg_code(9093),
        "ind-ft" => by_epsg_code(9081),
        "ind-yd" => by_epsg_code(9085),
        other => by_name(other),
    }
}

/// The vertical system with a code; one that is not listed counts heights in metres, as all others of the registry do.
pub fn vertical(code: u32) -> Option<Vertical> {
    let unit = |listed: &[(u32, u32)]| {
        listed.iter().find(|(known, _)| *known == code).and_then(|(_, unit)| by_epsg_code(*unit))
    };
    if let Some(unit) = unit(&HEIGHTS) {
        return Some(Vertical { unit, is_depth: false });
    }
    if let Some(unit) = unit(&DEPTHS) {
        return Some(Vertical { unit, is_depth: true });
    }
    let is_depth = METRE_DEPTHS.iter().any(|(first, last)| (first..=last).contains(&&code));
    Some(Vertical { unit: LinearUnit::METRE, is_depth })
}
