//! Projected systems of the EPSG registry that are newer than the definitions, which hold some 6200.

/// A code and its definition for PROJ a line, in the order of codes; made by `tests/newer_systems.py`. Of systems that PROJ has no definition
/// for it has the method's name and the unit. Datums are left to their ellipsoid: they say nothing of places on WGS 84.
const DEFINITIONS: &str = include_str!("newer.txt");

/// The definition of a projected system that is newer than the definitions; `None` for all other codes.
pub(super) fn definition(code: u32) -> Option<String> {
    let line = DEFINITIONS.lines().find_map(|line| {
        let (known, definition) = line.split_once(' ')?;
        (known.parse() == Ok(code)).then_some(definition)
    })?;
    Some(line.replace("+k_0=", "+k="))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::epsg;

    #[test]
    fn every_line_is_a_system_that_the_other_table_lacks_and_has_a_unit() {
        let codes: Vec<u32> =
            DEFINITIONS.lines().map(|line| line.split(' ').next().unwrap().parse().unwrap()).collect();
        assert!(codes.is_sorted() && codes.len() > 600, "{}", codes.len());
        for code in codes {
            assert_eq!(epsg::definition(code), None, "EPSG:{code}");
            let crs = epsg::horizontal(code);
            assert!(crs.unit.is_some() && crs.projection.is_some(), "EPSG:{code}");
        }
    }
}
