// The page: opens files, unwraps them in a worker whenever an option changes, and shows the result.
import { compile } from "../lib/compile.js";
import { fans, readObj } from "./obj.js";
import { portOf } from "../lib/web-port.js";
import { WorkerLibrary } from "../lib/worker-library.js";
import { fileOfMesh, primitivesOf, readGlb, withResults } from "./glb.js";
import { sampleMesh } from "./sample.js";
import { Viewer } from "./viewer.js";

const byId = (id) => document.getElementById(id);
const state = { file: null, primitives: [], name: "", result: null, running: null };
const viewers = [new Viewer(byId("mesh"), false), new Viewer(byId("page"), true)];

async function inlinedWasm() {
  const bytes = Uint8Array.from(atob(byId("wasm").textContent), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

// Pages from disk may start workers only from their own text.
function startWorker() {
  const address = URL.createObjectURL(new Blob([byId("worker").textContent], { type: "text/javascript" }));
  const worker = new Worker(address);
  URL.revokeObjectURL(address);
  return portOf(worker);
}

const library = inlinedWasm().then(compile).then((module) => new WorkerLibrary(startWorker, module));

// Of the nodes that show it, so that texels are of one size.
function densityOf(matrices) {
  const scale = Math.max(...matrices.map((m) => Math.max(...[0, 4, 8].map((k) => Math.hypot(m[k], m[k + 1], m[k + 2])))));
  return scale > 0 && Number.isFinite(scale) ? scale : 1;
}

function optionsNow() {
  const effort = byId("preset").value;
  return { maxStretch: Number(byId("stretch").value), padding: Number(byId("padding").value), charts: effort, packing: effort,
    pageSize: Number(byId("size").value), seams: true };
}

async function unwrap() {
  if (!state.file) return;
  state.running?.abort();
  const running = (state.running = new AbortController());
  document.body.classList.add("busy");
  byId("progress").value = 0;
  const begun = performance.now();
  try {
    const meshes = state.primitives.map(({ positions, indices, matrices }) => ({ positions, indices, density: densityOf(matrices) }));
    const result = await (await library).unwrap(meshes, {
      ...optionsNow(), signal: running.signal, onProgress: (stage, fraction) => (byId("progress").value = fraction) });
    state.result = result;
    show(result, (performance.now() - begun) / 1000);
  } catch (error) {
    if (!running.signal.aborted) tell(error.message, true);
  } finally {
    if (state.running === running) {
      state.running = null;
      document.body.classList.remove("busy");
    }
  }
}

function tell(text, isError = false) {
  byId("figures").textContent = text;
  byId("figures").className = isError ? "error" : "";
}

function show(result, seconds) {
  const { pages: [page], chartCount, stretchL2, utilization } = result;
  const shape = corners(state.primitives, result.meshes);
  const checker = byId("checker").checked ? Math.max(4, Math.round(Math.max(page.width, page.height) / 64)) : 0;
  for (const viewer of viewers) viewer.show({ ...shape, page: [page.width, page.height], checker });
  const triangles = result.meshes.reduce((sum, mesh) => sum + mesh.indices.length / 3, 0);
  byId("page-size").textContent = `${page.width} × ${page.height}`;
  tell(`${triangles.toLocaleString("en")} triangles, ${chartCount} charts, L2 stretch ${stretchL2.toFixed(4)}, ` +
    `${Math.round(100 * utilization)} % of the page, ${seconds.toFixed(2)} s`);
  byId("save").disabled = false;
}

// What is drawn: of each corner its position in the scene, uv and chart; and of each seam both ends.
function corners(primitives, meshes) {
  const copies = primitives.flatMap((primitive, i) => primitive.matrices.map((matrix) => ({ ...primitive, matrix, ...meshes[i] })));
  const fills = new Float32Array(6 * copies.reduce((sum, { indices }) => sum + indices.length, 0));
  const seams = copies.reduce((sum, copy) => sum + copy.seams.reduce((own, x) => own + x, 0), 0);
  const lines = new Float32Array(12 * seams), low = [Infinity, Infinity, Infinity], high = low.map((x) => -x);
  let at = 0, end = 0;
  for (const { positions, matrix: m, vertices, uvs, indices, triangleChart, seams } of copies) {
    const first = at;
    for (let i = 0; i < indices.length; ++i, at += 6) {
      const v = indices[i], p = 3 * vertices[v];
      for (let k = 0; k < 3; ++k) {
        const x = m[k] * positions[p] + m[4 + k] * positions[p + 1] + m[8 + k] * positions[p + 2] + m[12 + k];
        fills[at + k] = x;
        low[k] = Math.min(low[k], x);
        high[k] = Math.max(high[k], x);
      }
      fills[at + 3] = uvs[2 * v];
      fills[at + 4] = uvs[2 * v + 1];
      fills[at + 5] = triangleChart[Math.floor(i / 3)];
    }
    for (let i = 0; i < indices.length; ++i) {
      if (!seams[i]) continue;
      for (const corner of [i, i % 3 === 2 ? i - 2 : i + 1]) {
        lines.set(fills.subarray(first + 6 * corner, first + 6 * corner + 6), end);
        end += 6;
      }
    }
  }
  const centre = low.map((x, k) => (x + high[k]) / 2), radius = Math.hypot(...low.map((x, k) => high[k] - x)) / 2 || 1;
  return { fills, lines, centre, radius };
}

function take(file, name) {
  const primitives = primitivesOf(file);
  Object.assign(state, { file, primitives, name, result: null });
  byId("name").textContent = name;
  byId("save").disabled = true;
  viewers[0].zoom = viewers[1].zoom = 1;
  return unwrap();
}

async function open(file) {
  try {
    if (/\.glb$/i.test(file.name)) return await take(readGlb(await file.arrayBuffer()), file.name);
    if (!/\.obj$/i.test(file.name)) throw new Error(`${file.name} is neither a GLB nor an OBJ file`);
    await takeMesh(fans(readObj(await file.text())), file.name);
  } catch (error) {
    tell(`${file.name}: ${error.message}`, true);
  }
}

function takeMesh(mesh, name) {
  const file = fileOfMesh(mesh);
  if (mesh.indices.length < 3) throw new Error("the file has no triangles");
  const [primitive] = primitivesOf(file);
  Object.assign(state, { file, primitives: [{ ...primitive, indices: mesh.indices }], name, result: null });
  byId("name").textContent = name;
  byId("save").disabled = true;
  return unwrap();
}

// The result as a file: the uvs become the first set, or the one after those that are there.
export function resultFile() {
  const { primitives } = state;
  const sets = primitives.map(({ primitive }) => Object.keys(primitive.attributes).filter((name) => name.startsWith("TEXCOORD_")).length);
  const set = byId("replace").checked ? 0 : Math.max(...sets);
  return withResults(state.file, primitives, state.result.meshes, set);
}

function save() {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(resultFile());
  link.download = `${state.name.replace(/\.\w+$/, "")}-unwrapped.glb`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

function listen() {
  let waiting = 0;
  for (const id of ["stretch", "padding", "preset", "size", "checker"]) {
    byId(id).addEventListener("input", () => {
      for (const name of ["stretch", "padding"]) byId(`${name}-value`).textContent = byId(name).value;
      clearTimeout(waiting);
      waiting = setTimeout(unwrap, 120);  // not at every step of a slider
    });
  }
  byId("file").addEventListener("change", ({ target }) => target.files[0] && open(target.files[0]));
  byId("save").addEventListener("click", save);
  addEventListener("dragover", (event) => {
    event.preventDefault();
    byId("drop").hidden = false;
  });
  addEventListener("dragleave", (event) => (byId("drop").hidden = !event.relatedTarget));
  addEventListener("drop", (event) => {
    event.preventDefault();
    byId("drop").hidden = true;
    if (event.dataTransfer.files[0]) open(event.dataTransfer.files[0]);
  });
}

listen();
// For tests: ready once the sample is shown.
window.playground = { open, resultFile, state, viewers, library, ready: takeMesh(sampleMesh(), "a knot") };
