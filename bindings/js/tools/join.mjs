// Joins ES modules into one text, for CommonJS and for pages of one file. Our modules import only by name, at the
// beginning of a line, and declare no name twice; what is otherwise is refused.
import { readFileSync } from "node:fs";
import { dirname, resolve } from "node:path";

const importLine = /^import (?:\{([^}]*)\} from )?"([^"]+)";$/gm;
const exportFrom = /^export (?:\*|\{[^}]*\}) from "([^"]+)";$/gm;
const declared = /^(export )?(?:async )?(?:const|let|class|function) +([\w$]+)/gm;

// Returns { text, exported, packages }; packages: Map of a package's name to the names that are imported from it.
export function join(entry) {
  const seen = new Set(), texts = [], exported = new Set(), packages = new Map(), names = new Map();
  const visit = (file, isPublic) => {
    const source = readFileSync(file, "utf8");
    for (const [, , from] of source.matchAll(importLine)) if (from.startsWith(".")) visit(resolve(dirname(file), from), false);
    for (const [line, from] of source.matchAll(exportFrom)) {
      const inner = resolve(dirname(file), from);
      visit(inner, line.includes("*"));
      if (!line.includes("*")) line.match(/\{(.*)\}/)[1].split(",").forEach((name) => exported.add(name.trim()));
    }
    for (const [, isExported, name] of isPublic ? source.matchAll(declared) : []) if (isExported) exported.add(name);
    if (seen.has(file)) return;
    seen.add(file);
    for (const [, , name] of source.matchAll(declared)) {
      if (names.has(name)) throw new Error(`${name} is declared in ${names.get(name)} and in ${file}`);
      names.set(name, file);
    }
    for (const [, list, from] of source.matchAll(importLine)) {
      if (from.startsWith(".")) continue;
      packages.set(from, [...(packages.get(from) ?? []), ...list.split(",").map((name) => name.trim())]);
    }
    const text = source.replace(importLine, "").replace(exportFrom, "").replace(/^export (?=async |const |let |class |function )/gm, "");
    const odd = text.match(/^(import|export)\b.*/m);
    if (odd) throw new Error(`${file}: cannot join "${odd[0]}"`);
    texts.push(text.trim());
  };
  visit(resolve(entry), true);
  return { text: texts.join("\n\n"), exported: [...exported], packages };
}

export function commonJs(entry) {
  const { text, exported, packages } = join(entry);
  const required = [...packages].map(([from, names]) => `const { ${[...new Set(names)].join(", ").replace(/ as /g, ": ")} } = require("${from}");\n`);
  const body = text.replaceAll("import.meta.url", 'require("node:url").pathToFileURL(__filename).href');
  return `"use strict";\n${required.join("")}\n${body}\n\nmodule.exports = { ${exported.join(", ")} };\n`;
}
