//! Has the page embedded anew when its files change.

fn main() {
    println!("cargo::rerun-if-changed=ui/dist");
}
