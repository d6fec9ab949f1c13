// libatlas/gltf-transform beside glTF-Transform's own unwrap(), called the same way on six files that are made here.
// After npm ci in this folder: LIBATLAS_PACKAGE=FOLDER node --test gltf.test.mjs
import assert from "node:assert/strict";
import { pathToFileURL } from "node:url";
import { test } from "node:test";

import { Document, NodeIO } from "@gltf-transform/core";
import { KHRMeshQuantization } from "@gltf-transform/extensions";
import { cloneDocument, unwrap as theirs } from "@gltf-transform/functions";
import validator from "gltf-validator";
import * as watlas from "watlas";

import { box, waves } from "../../bindings/js/tests/support.mjs";

const ours = (await import(pathToFileURL(`${process.env.LIBATLAS_PACKAGE}/gltf-transform.js`))).unwrap;
const { load } = await import(pathToFileURL(`${process.env.LIBATLAS_PACKAGE}/node.js`));
const library = await load();
const io = new NodeIO().registerExtensions([KHRMeshQuantization]);

function begun() {
  const document = new Document();
  document.createBuffer();
  document.createScene();
  return document;
}
const accessor = (document, type, array) => document.createAccessor().setType(type).setArray(array);
function primitiveOf(document, { positions, indices }) {
  const primitive = document.createPrimitive().setAttribute("POSITION", accessor(document, "VEC3", positions));
  if (indices) primitive.setIndices(accessor(document, "SCALAR", Uint16Array.from(indices)));
  return primitive;
}
function shown(document, ...primitives) {
  const mesh = document.createMesh();
  primitives.forEach((primitive) => mesh.addPrimitive(primitive));
  const node = document.createNode().setMesh(mesh);
  document.getRoot().listScenes()[0].addChild(node);
  return node;
}
const unit = (positions) => positions.map((_, i) => {
  const v = positions.subarray(i - (i % 3), i - (i % 3) + 3);
  return v[i % 3] / Math.hypot(...v);
});

const files = {
  indexed() {
    const document = begun();
    shown(document, primitiveOf(document, waves(30)));
    return { document, options: {} };
  },
  "without indices, with normals"() {
    const document = begun(), { positions, indices } = waves(16);
    const soup = new Float32Array(3 * indices.length);
    indices.forEach((v, i) => soup.set(positions.subarray(3 * v, 3 * v + 3), 3 * i));
    shown(document, primitiveOf(document, { positions: soup }).setAttribute("NORMAL", accessor(document, "VEC3", unit(soup))));
    return { document, options: {} };
  },
  "several meshes and scales on one page"() {
    const document = begun();
    shown(document, primitiveOf(document, box())).setScale([3, 3, 3]);
    const second = shown(document, primitiveOf(document, waves(20)), primitiveOf(document, box(2)));
    second.addChild(document.createNode().setMesh(second.getMesh()).setTranslation([4, 0, 0]));
    return { document, options: { groupBy: "scene", overwrite: true } };
  },
  quantized() {
    const document = begun(), { positions, indices } = waves(30);
    document.createExtension(KHRMeshQuantization).setRequired(true);
    const primitive = primitiveOf(document, { positions: Int16Array.from(positions, (x) => Math.round(x * 20000)), indices });
    primitive.getAttribute("POSITION").setNormalized(true);
    shown(document, primitive);
    return { document, options: { groupBy: "primitive" } };
  },
  "morph targets"() {
    const document = begun(), mesh = waves(20);
    const primitive = primitiveOf(document, mesh);
    primitive.addTarget(document.createPrimitiveTarget().setAttribute("POSITION", accessor(document, "VEC3", mesh.positions.map((x) => x / 9))));
    shown(document, primitive);
    return { document, options: {} };
  },
  "a second set beside shared arrays"() {
    const document = begun(), { positions, indices } = waves(20);
    const whole = primitiveOf(document, { positions, indices });
    const half = document.createPrimitive().setAttribute("POSITION", whole.getAttribute("POSITION"));
    const uvs = accessor(document, "VEC2", Float32Array.from({ length: (2 * positions.length) / 3 }, (_, i) => (i % 7) / 7));
    const middle = 3 * Math.floor(indices.length / 6);
    for (const [primitive, part] of [[whole, indices.subarray(0, middle)], [half, indices.subarray(middle)]]) {
      primitive.setIndices(accessor(document, "SCALAR", Uint16Array.from(part))).setAttribute("TEXCOORD_0", uvs);
    }
    shown(document, whole, half);
    return { document, options: { texcoord: 1 } };
  },
};

// Of triangles in uv.
function areas(primitive, set) {
  const uv = primitive.getAttribute(set).getArray(), indices = primitive.getIndices().getArray();
  return Array.from({ length: indices.length / 3 }, (_, t) => {
    const [a, b, c] = [0, 1, 2].map((k) => 2 * indices[3 * t + k]);
    return ((uv[b] - uv[a]) * (uv[c + 1] - uv[a + 1]) - (uv[c] - uv[a]) * (uv[b + 1] - uv[a + 1])) / 2;
  });
}

// What a primitive draws: the positions of its corners.
function drawn(primitive) {
  const position = primitive.getAttribute("POSITION"), indices = primitive.getIndices()?.getArray();
  return Array.from({ length: indices?.length ?? position.getCount() }, (_, i) => position.getElement(indices ? indices[i] : i, [])).flat();
}

for (const [name, make] of Object.entries(files)) {
  test(name, async () => {
    const { document, options } = make(), set = `TEXCOORD_${options.texcoord ?? 0}`;
    const before = await validated(document), own = cloneDocument(document), rival = cloneDocument(document);
    await own.transform(ours({ ...options, library }));
    await rival.transform(theirs({ ...options, watlas }));
    assert.deepEqual((await validated(own)).filter((issue) => !before.includes(issue)), []);
    assert.deepEqual(await validated(rival), await validated(own));
    const old = primitives(document);
    primitives(own).forEach((primitive, i) => {
      assert.deepEqual(drawn(primitive), drawn(old[i]));
      assert.ok(primitive.getAttribute(set).getArray().every((x) => x >= 0 && x <= 1));
      assert.ok(areas(primitive, set).every((area) => area <= 0));  // clockwise, since v points down
      assert.equal(primitive.listTargets().length, old[i].listTargets().length);
      assert.deepEqual(primitive.listSemantics().sort(), primitives(rival)[i].listSemantics().sort());
    });
    const vertices = (of) => primitives(of).reduce((sum, p) => sum + p.getAttribute("POSITION").getCount(), 0);
    console.log(`${name}: ${vertices(document)} vertices become ${vertices(own)}, theirs ${vertices(rival)}`);
    assert.equal(own.getRoot().listAccessors().length, rival.getRoot().listAccessors().length);
  });
}

const primitives = (document) => document.getRoot().listMeshes().flatMap((mesh) => mesh.listPrimitives());

async function validated(document) {
  const { issues } = await validator.validateBytes(await io.writeBinary(document));
  // Uvs that no texture uses are worth a remark to the validator.
  const remark = ({ code, pointer }) => code === "UNUSED_OBJECT" && /TEXCOORD_\d$/.test(pointer);
  return issues.messages.filter((message) => !remark(message)).map(({ code, severity }) => `${severity}: ${code}`);
}

test("texels have one size in the scene", async () => {
  const { document } = files["several meshes and scales on one page"]();
  await document.transform(ours({ groupBy: "scene", library }));
  const [large, , small] = primitives(document);
  const area = (primitive) => areas(primitive, "TEXCOORD_0").reduce((sum, x) => sum - x, 0);
  assert.ok(Math.abs(area(large) / area(small) - 9) < 0.3, `${area(large) / area(small)}`);
});

test("instances have places apart, in the extras of their nodes", async () => {
  const { document } = files["several meshes and scales on one page"]();
  const before = primitives(document).map(drawn);
  await document.transform(ours({ groupBy: "scene", instances: true, library }));
  assert.deepEqual(primitives(document).map(drawn), before);
  const places = document.getRoot().listNodes().map((node) => node.getExtras());
  assert.equal(places.length, 3);
  for (const { lightmapScale, lightmapOffset } of places) {
    [0, 1].forEach((k) => assert.ok(lightmapOffset[k] >= 0 && lightmapOffset[k] + lightmapScale[k] <= 1.000001));
  }
  const apart = (a, b) => [0, 1].some((k) => a.lightmapOffset[k] + a.lightmapScale[k] <= b.lightmapOffset[k] || b.lightmapOffset[k] + b.lightmapScale[k] <= a.lightmapOffset[k]);
  places.forEach((a, i) => places.slice(0, i).forEach((b) => assert.ok(apart(a, b))));
  for (const primitive of primitives(document)) assert.ok(primitive.getAttribute("TEXCOORD_0").getArray().every((x) => x >= 0 && x <= 1));
  assert.deepEqual(await validated(document), []);
  await assert.rejects(document.transform(ours({ instances: true, library })), /groupBy/);
});

test("primitives that have uvs are left alone, and so are lines", async () => {
  const document = begun(), primitive = primitiveOf(document, box());
  primitive.setAttribute("TEXCOORD_0", accessor(document, "VEC2", new Float32Array(300)));
  const lines = primitiveOf(document, box()).setMode(1);
  shown(document, primitive, lines);
  const kept = primitive.getAttribute("TEXCOORD_0");
  await document.transform(ours({ library }));
  assert.equal(primitive.getAttribute("TEXCOORD_0"), kept);
  assert.equal(lines.getAttribute("TEXCOORD_0"), null);
  await assert.rejects(document.transform(ours({ library, groupBy: "node" })), /groupBy/);
  await assert.rejects(document.transform(ours({ library, overwrite: true, pages: 2 })), /pages/);
});
