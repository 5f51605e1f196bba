//! `web MODULE NAME FOLDER`: writes the JavaScript and TypeScript through which a page calls a WebAssembly module. It
//! also writes the module without the sections that only this step needs.

use anyhow::{Context, Result, bail};
use std::env;
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [module, name, folder] = arguments.as_slice() else { bail!("usage: web MODULE NAME FOLDER") };
    let mut bindgen = Bindgen::new();
    bindgen.input_path(module).out_name(name).web(true)?.typescript(true);
    bindgen.remove_name_section(true).remove_producers_section(true);
    // leave out the path of the module, which the bundler determines
    bindgen.omit_default_module_path(true);
    bindgen.generate(folder).with_context(|| format!("the bindings of {module}"))
}
