// node build.mjs [FOLDER]: builds the page from its sources and from gen/, the modules that `cargo xtask web` makes.
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { copyFileSync, existsSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";

const out = process.argv[2] ?? "dist";
rmSync(out, { recursive: true, force: true });
mkdirSync(out, { recursive: true });

/** Large modules that most visitors never need. They are cached when they are first used. */
const LATER = /^zerorate_(log|replay).*\.wasm$/;

const common = {
  bundle: true,
  format: "esm",
  outdir: out,
  minify: true,
  target: ["es2022"],
  legalComments: "none",
};
const entryPoints = { main: "src/main.ts", live: "src/worker/live.ts", log: "src/worker/log.ts" };
await build({ ...common, entryPoints, splitting: true, chunkNames: "part-[hash]" });

for (const file of existsSync("gen") ? readdirSync("gen") : []) {
  if (file.endsWith(".wasm")) copyFileSync(`gen/${file}`, `${out}/${file}`);
}
for (const file of ["index.html", "icon.svg", "manifest.webmanifest"]) copyFileSync(file, `${out}/${file}`);
copyFileSync("node_modules/uplot/LICENSE", `${out}/uplot-licence.txt`);
writeFileSync(`${out}/home.json`, `${JSON.stringify({ home: "static" })}\n`);

// The cache is named by the hash of all files, so that a page is never made of two versions.
const files = readdirSync(out).sort();
const sha256 = (file) => createHash("sha256").update(readFileSync(`${out}/${file}`)).digest("hex");
const hashes = Object.fromEntries(files.map((file) => [file, sha256(file)]));
const later = Object.fromEntries(Object.entries(hashes).filter(([file]) => LATER.test(file)));
const define = {
  FILES: JSON.stringify(["./", ...files.filter((file) => !(file in later))]),
  LATER: JSON.stringify(later),
  VERSION: JSON.stringify(createHash("sha256").update(JSON.stringify(hashes)).digest("hex").slice(0, 16)),
};
await build({ ...common, entryPoints: { sw: "src/sw.ts" }, define });
