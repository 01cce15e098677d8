//! Projections that a file describes by a method's name and its parameters, as PROJ defines them.

use super::projection::Projection;

/// What a file says of a projection.
pub(crate) struct Described<'a> {
    /// Name of the method, in letters and digits of lower case alone.
    pub(crate) method: &'a str,
    /// A parameter by the first of some names that the file has, in the same letters; lengths in the system's unit.
    pub(crate) number: &'a dyn Fn(&[&str]) -> Option<f64>,
    /// Its datum as PROJ defines it, where that is set equal to WGS 84.
    pub(crate) datum: Option<String>,
    /// Semi-major axis [m] and inverse flattening of the ellipsoid, if the file says them.
    pub(crate) ellipsoid: Option<[f64; 2]>,
    /// Length of the system's unit [m].
    pub(crate) unit_m: f64,
}

/// PROJ's names of methods, and those that WKT of GDAL, Esri and EPSG have.
const METHODS: [(&str, &[&str]); 30] = [
    ("tmerc", &["transversemercator", "gausskruger", "gaussboaga", "transversemercatorcomplex"]),
    ("tmerc_south", &["transversemercatorsouthorientated", "transversemercatorsouthoriented"]),
    (
        "lcc",
        &[
            "lambertconformalconic",
            "lambertconformalconic1sp",
            "lambertconformalconic2sp",
            "lambertconicconformal1sp",
            "lambertconicconformal2sp",
        ],
    ),
    ("aea", &["albers", "albersconicequalarea", "albersequalarea"]),
    ("laea", &["lambertazimuthalequalarea", "lambertazimuthalequalareaspherical"]),
    (
        "cea",
        &[
            "cylindricalequalarea",
            "lambertcylindricalequalarea",
            "lambertcylindricalequalareaspherical",
            "behrmann",
        ],
    ),
    ("moll", &["mollweide"]),
    ("mill", &["millercylindrical"]),
    (
        "stere",
        &[
            "polarstereographic",
            "polarstereographicvarianta",
            "polarstereographicvariantb",
            "stereographicnorthpole",
            "stereographicsouthpole",
        ],
    ),
    ("sterea", &["obliquestereographic", "doublestereographic"]),
    ("aeqd", &["azimuthalequidistant", "modifiedazimuthalequidistant"]),
    ("eqdc", &["equidistantconic"]),
    ("poly", &["polyconic", "americanpolyconic"]),
    (
        "omerc",
        &[
            "hotineobliquemercator",
            "hotineobliquemercatorvarianta",
            "hotineobliquemercatorvariantb",
            "hotineobliquemercatorazimuthcenter",
            "hotineobliquemercatorazimuthnaturalorigin",
            "hotineobliquemercatortwopointnaturalorigin",
            "obliquemercator",
            "rectifiedskeworthomorphiccenter",
            "rectifiedskeworthomorphicnaturalorigin",
        ],
    ),
    ("somerc", &["swissobliquecylindrical", "swissobliquemercator"]),
    ("cass", &["cassini", "cassinisoldner"]),
    ("krovak", &["krovak", "krovaknorthorientated"]),
    ("nzmg", &["newzealandmapgrid"]),
    ("labrd", &["labordeobliquemercator"]),
    ("eqearth", &["equalearth"]),
    ("sinu", &["sinusoidal"]),
    ("robin", &["robinson"]),
    ("wintri", &["winkeltripel"]),
    ("vandg", &["vandergrinten", "vandergrinteni"]),
    ("gall", &["gallstereographic"]),
    ("eck4", &["eckertiv"]),
    ("eck6", &["eckertvi"]),
    ("natearth", &["naturalearth"]),
    ("igh", &["goodehomolosine", "interruptedgoodehomolosine"]),
    ("bonne", &["bonne"]),
];

impl Described<'_> {
    /// The projection; of a method that is not known its name alone.
    pub(crate) fn projection(&self) -> Projection {
        let name = METHODS.iter().find(|(_, names)| names.contains(&self.method)).map(|(name, _)| *name);
        let Some(name) = name else { return Projection::of(format!("+proj={}", self.method)) };
        let angles = match name {
            "tmerc_south" => {
                return Projection::of(format!("+proj=tmerc {} +axis=wsu", self.frame(LATITUDE)));
            }
            "stere" => return Projection::of(format!("+proj=stere {}", self.polar())),
            "lcc" | "aea" => self.words(&[("lat_1", FIRST_PARALLEL), ("lat_2", SECOND_PARALLEL)]),
            "cea" => self.words(&[("lat_ts", FIRST_PARALLEL)]),
            _ => String::new(),
        };
        // A cone of one parallel has it where its coordinates begin.
        let one_parallel = name == "lcc" && (self.number)(FIRST_PARALLEL).is_none();
        let parallel = if one_parallel { self.words(&[("lat_1", LATITUDE)]) } else { String::new() };
        Projection::of(format!("+proj={name} {angles}{parallel}{}", self.frame(LATITUDE)))
    }

    /// What a polar stereographic projection is true to scale on, and where it lies.
    fn polar(&self) -> String {
        let parallel = (self.number)(&[
            "latitudeofstandardparallel",
            "standardparallel1",
            "latitudeoforigin",
            "latitudeofnaturalorigin",
        ]);
        let pole = if parallel.is_some_and(|latitude| latitude < 0.0) { -90 } else { 90 };
        let parallel = parallel.unwrap_or(90.0);
        format!("+lat_0={pole} +lat_ts={parallel} {}", self.frame(&[]))
    }

    /// Origin, scale and ellipsoid.
    fn frame(&self, latitude: &[&str]) -> String {
        let angles = self.words(&[("lat_0", latitude), ("lon_0", LONGITUDE), ("k", SCALE)]);
        let length = |key: &str, names: &[&str]| {
            let length_m = (self.number)(names).unwrap_or(0.0) * self.unit_m;
            format!("+{key}={length_m} ")
        };
        let ellipsoid = match self.ellipsoid {
            _ if self.datum.is_some() => self.datum.clone().unwrap_or_default(),
            // WKT writes a sphere with an inverse flattening of 0.
            Some([major_m, 0.0]) => format!("+a={major_m} +b={major_m}"),
            Some([major_m, inverse_flattening]) => format!("+a={major_m} +rf={inverse_flattening}"),
            // Without a word for the datum, which nothing says.
            None => "+a=6378137 +rf=298.257223563".into(),
        };
        format!("{angles}{}{}{ellipsoid}", length("x_0", EASTING), length("y_0", NORTHING))
    }

    /// Words of a definition for those parameters that the file has.
    fn words(&self, keys: &[(&str, &[&str])]) -> String {
        let word = |(key, names): &(&str, &[&str])| Some(format!("+{key}={} ", (self.number)(names)?));
        keys.iter().filter_map(word).collect()
    }
}

const LATITUDE: &[&str] = &[
    "latitudeoforigin",
    "latitudeofnaturalorigin",
    "latitudeoffalseorigin",
    "latitudeofcenter",
    "latitudeofprojectioncentre",
];
const LONGITUDE: &[&str] = &[
    "centralmeridian",
    "longitudeofnaturalorigin",
    "longitudeoffalseorigin",
    "longitudeoforigin",
    "longitudeofcenter",
    "longitudeofprojectioncentre",
    "straightverticallongitudefrompole",
];
const FIRST_PARALLEL: &[&str] = &["standardparallel1", "latitudeof1ststandardparallel"];
const SECOND_PARALLEL: &[&str] = &["standardparallel2", "latitudeof2ndstandardparallel"];
const SCALE: &[&str] = &["scalefactor", "scalefactoratnaturalorigin", "scalefactoratprojectioncentre"];
const EASTING: &[&str] = &["falseeasting", "eastingatfalseorigin", "eastingatprojectioncentre"];
const NORTHING: &[&str] = &["falsenorthing", "northingatfalseorigin", "northingatprojectioncentre"];

#[cfg(test)]
mod tests {
    use super::*;

    fn definition(method: &str, parameters: &[(&str, f64)]) -> String {
        let number = |names: &[&str]| {
            names.iter().find_map(|name| parameters.iter().find(|(known, _)| known == name)).map(|(_, v)| *v)
        };
        let ellipsoid = Some([6_378_137.0, 298.257_223_563]);
        Described { method, number: &number, datum: None, ellipsoid, unit_m: 1.0 }.projection().definition
    }

    #[test]
    fn methods_become_definitions_of_proj() {
        let end = "+x_0=0 +y_0=0 +a=6378137 +rf=298.257223563";
        for (method, parameters, expected) in [
            ("mollweide", &[("centralmeridian", 0.0)][..], format!("+proj=moll +lon_0=0 {end}")),
            (
                "lambertconformalconic1sp",
                &[("latitudeoforigin", 44.0), ("scalefactor", 1.0001)],
                format!("+proj=lcc +lat_1=44 +lat_0=44 +k=1.0001 {end}"),
            ),
            (
                "stereographicsouthpole",
                &[("standardparallel1", -71.0), ("centralmeridian", 10.0)],
                format!("+proj=stere +lat_0=-90 +lat_ts=-71 +lon_0=10 {end}"),
            ),
            ("behrmann", &[("standardparallel1", 30.0)], format!("+proj=cea +lat_ts=30 {end}")),
            ("somethingelse", &[], "+proj=somethingelse".to_owned()),
        ] {
            assert_eq!(definition(method, parameters), expected);
        }
    }
}
