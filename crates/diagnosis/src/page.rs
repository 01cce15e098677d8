//! The report as a page.
use crate::report::Diagnosis;
impl Diagnosis {
    /// page
    pub fn html(&self, _robot: &str) -> String {
        String::new()
    }
}
