//! Has the page and the guide embedded anew when their files change.

fn main() {
    println!("cargo::rerun-if-changed=ui/dist");
    println!("cargo::rerun-if-changed=../../docs");
}
