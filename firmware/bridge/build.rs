//! Passes the linker scripts and the memory layout of the board to the linker.

fn main() {
    let here = std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets it");
    let chosen = |feature: &str| std::env::var_os(format!("CARGO_FEATURE_{feature}")).is_some();
    let stm32f4 = if chosen("UF2") { "stm32f4-uf2" } else { "stm32f4" };
    for (feature, bin, board, scripts) in [
        ("STM32F4", "stm32f4", stm32f4, ["link.x"].as_slice()),
        ("RP2040", "rp2040", "rp2040", &["link.x", "link-rp.x"]),
    ] {
        if chosen(feature) {
            println!("cargo:rustc-link-search={here}/boards/{board}");
            for script in scripts {
                println!("cargo:rustc-link-arg-bin={bin}=-T{script}");
            }
        }
    }
    println!("cargo:rerun-if-changed=boards");
}
