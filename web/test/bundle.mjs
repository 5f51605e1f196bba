// Loads a module of the page without a browser.
import { build } from "esbuild";

/** Bundles a module and returns its exports. `from` tells esbuild what to bundle. */
export async function bundled(from) {
  const { outputFiles } = await build({ ...from, bundle: true, format: "esm", write: false });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString("base64")}`);
}
