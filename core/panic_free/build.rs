//! A static program with its own entry point: what is not called is not in it.

fn main() {
    for argument in ["-static", "-nostartfiles"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
}
