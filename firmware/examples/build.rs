//! Passes the linker scripts and the memory layout of the chip to the linker, like the build script of the bridge.

fn main() {
    let here = std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets it");
    let chosen = |feature: &str| std::env::var_os(format!("CARGO_FEATURE_{feature}")).is_some();
    for (feature, board, scripts) in
        [("STM32F4", "stm32f4", ["link.x"].as_slice()), ("RP2040", "rp2040", &["link.x", "link-rp.x"])]
    {
        if chosen(feature) {
            println!("cargo:rustc-link-search={here}/../bridge/boards/{board}");
            for script in scripts {
                println!("cargo:rustc-link-arg-bins=-T{script}");
            }
        }
    }
    println!("cargo:rerun-if-changed=../bridge/boards");
}
