// Bundles the page into one self-contained file, assets/live_page/index.html: `npm ci && npm run build`.
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { mkdir, readdir, readFile, writeFile } from "node:fs/promises";

const here = new URL(".", import.meta.url).pathname;
const result = await build({
  entryPoints: [here + "page.js"], bundle: true, minify: true, format: "iife", target: "es2021",
  platform: "browser", write: false, legalComments: "inline", charset: "ascii",
  define: { "process.env.NODE_ENV": '"production"' },
});
// a classic script: brokers serve files without a content type, so modules would be refused
const script = result.outputFiles[0].text.replaceAll("</script", "<\\/script");
const style = (await readFile(here + "node_modules/uplot/dist/uPlot.min.css", "utf8")) +
  (await readFile(here + "page.css", "utf8"));
// the Content-Security-Policy lets this script and this style run, and no other
const hash = (text) => "sha256-" + createHash("sha256").update(text).digest("base64");
// tests/page/page_test.py compares it with the sources as they are
const sources = createHash("sha256");
for (const name of (await readdir(here)).filter((n) => /\.(js|css|html|mjs|json)$/.test(n)).sort()) sources.update(await readFile(here + name));
const page = (await readFile(here + "page.html", "utf8"))
  .replace("@STYLE_HASH@", hash(style)).replace("@SCRIPT_HASH@", hash(script))
  .replace("@SOURCES@", sources.digest("hex"))
  .replace("@STYLE@", () => style).replace("@SCRIPT@", () => script);
const out = here + "../../../assets/live_page/";
await mkdir(out, { recursive: true });
await writeFile(out + "index.html", page);
console.log(`assets/live_page/index.html: ${page.length} characters`);
