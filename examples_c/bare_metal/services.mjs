// services.c's calls from JavaScript: node services.mjs MODULE.wasm TILE.nft. Prints the same lines; the stack is the
// part of it that lies in the module's memory, as what WebAssembly keeps of it elsewhere cannot be seen.
import { readFileSync } from "node:fs";

const SAMPLES = 64, ITEMS = 100, BATCH = 8, WORKSPACE_BYTES = 32768;
const PRECISION_F64 = 0, PRECISION_F32 = 1, OMIS_RIDGE = 0;
const PAINT = 0xc0dec0de, STRUCT_BYTES = 256;

const abi = readFileSync(new URL("../../capi/abi.txt", import.meta.url), "utf8");
const offset = (field) => Number(abi.match(new RegExp(`^ *${field}: offset (\\d+)`, "m"))[1]);
const PRECISION_OFFSET = offset("nf_cv_config.precision"), STD_ERROR_OFFSET = offset("nf_estimate.std_error");

const [, , module, tileFile] = process.argv;
const { instance } = await WebAssembly.instantiate(readFileSync(module));
const nf = instance.exports;
nf.memory.grow(4);
const words = new Uint32Array(nf.memory.buffer), floats = new Float32Array(nf.memory.buffer);

let free = nf.__heap_base.value;
function allocate(bytes) {
    const at = free = Math.ceil(free / 16) * 16;
    free += bytes;
    return at;
}
const structure = () => allocate(STRUCT_BYTES);
const workspace = allocate(WORKSPACE_BYTES), u = allocate(8 * SAMPLES), f = allocate(4 * SAMPLES);
let failures = 0;

// The stack grows down, to the memory's beginning or, as older linkers have it, to where the variables end.
const stackStart = nf.__stack_pointer.value / 4, dataEnd = Math.ceil(nf.__data_end.value / 4);
const stackEnd = dataEnd < stackStart ? dataEnd : 0;
const paint = () => words.fill(PAINT, stackEnd, stackStart);
function stackUsed() {
    let word = stackEnd;
    while (word < stackStart && words[word] === PAINT) ++word;
    return 4 * (stackStart - word);
}

function line(name, status, first, second) {
    const stack = stackUsed(), hex = (bits) => bits.toString(16).padStart(8, "0");
    const rest = (stack ? ` stack ${stack}` : "") + (status ? ` FAILED: ${status}` : "");
    console.log(`${name} ${hex(first)} ${hex(second)}` + rest);
    if (status) ++failures;
}

function tile() {
    const bytes = readFileSync(tileFile), file = allocate(bytes.length), tile = structure();
    new Uint8Array(nf.memory.buffer).set(bytes, file);
    paint();
    const status = nf.nf_tile_from_bytes(file, bytes.length, tile);
    line("nf_tile_from_bytes", status, words[tile / 4 + 2], words[tile / 4 + 3]);
    if (status) return;
    const pixel = structure(), domain = structure();
    paint();
    for (let i = 0; i < SAMPLES; ++i) {
        nf.nf_tile_sampler_pixel(pixel, tile, 3, 5, 0, i);
        nf.nf_tile_sampler_domain(domain, pixel, 7);
        nf.nf_tile_sampler_draw(domain, 2, u + 8 * i);
    }
    line("nf_tile_sampler_draw", 0, words[u / 4], words[u / 4 + 2 * SAMPLES - 1]);
    const round = Math.fround;
    for (let i = 0; i < SAMPLES; ++i) {
        const x = floats[u / 4 + 2 * i], y = floats[u / 4 + 2 * i + 1];
        floats[f / 4 + i] = round(round(x * x) + round(2 * y));
    }
}

// nf_cv_config and nf_cv_samples: fields that are not set are zero.
function configuration(precision) {
    const config = structure();
    words.fill(0, config / 4, (config + STRUCT_BYTES) / 4);
    [words[config / 4], words[config / 4 + 1], words[config / 4 + 2]] = [2, 2, 1];
    words[(config + PRECISION_OFFSET) / 4] = precision;
    return config;
}
function samples() {
    const all = structure();
    words.fill(0, all / 4, (all + STRUCT_BYTES) / 4);
    [words[all / 4], words[all / 4 + 1], words[all / 4 + 2]] = [u, f, SAMPLES];
    return all;
}

function controlVariate(name, precision) {
    const config = configuration(precision), all = samples(), estimate = structure();
    paint();
    const status = nf.nf_cv_estimate(config, all, 1, workspace, WORKSPACE_BYTES, estimate);
    line(name, status, words[estimate / 4], words[(estimate + STD_ERROR_OFFSET) / 4]);
}

function streaming() {
    const config = configuration(PRECISION_F32), all = samples(), half = WORKSPACE_BYTES / 2;
    const estimate = structure(), accumulator = structure();
    paint();
    const status = nf.nf_cv_accumulator_init(workspace, half, config, accumulator)
        || nf.nf_cv_accumulator_add(words[accumulator / 4], all)
        || nf.nf_cv_accumulator_estimate(words[accumulator / 4], workspace + half, half, estimate);
    line("nf_cv_accumulator", status, words[estimate / 4], words[(estimate + STD_ERROR_OFFSET) / 4]);
}

function mis() {
    const pdf = structure(), counts = structure(), value = structure(), result = structure(), omis = structure();
    const technique = structure();
    floats.set([0.5, 2, 1], pdf / 4);
    words.set([2, 1, 4], counts / 4);
    floats[value / 4] = 3;
    paint();
    let status = nf.nf_mis_weight(0, 0, pdf, counts, 3, 1, result);
    line("nf_mis_weight", status, words[result / 4], 0);
    paint();
    status = nf.nf_omis_init(workspace, WORKSPACE_BYTES, 3, 1, counts, omis);
    for (let j = 0; j < 3 && !status; ++j) {
        words[technique / 4] = j;
        status = nf.nf_omis_add(words[omis / 4], pdf, technique, value, 1);
    }
    status ||= nf.nf_omis_solve(words[omis / 4], OMIS_RIDGE, 0, result, 0);
    line("nf_omis", status, words[result / 4], 0);
}

function minibatch() {
    const rng = structure(), table = structure(), importance = allocate(4 * ITEMS);
    const weight = structure(), index = structure();
    nf.nf_rng_seed(rng, 1n);
    for (let i = 0; i < ITEMS; ++i) floats[importance / 4 + i] = nf.nf_rng_uniform(rng);
    paint();
    const status = nf.nf_table_init(table, workspace, WORKSPACE_BYTES, ITEMS, importance)
        || nf.nf_table_draw(table, rng, BATCH, index, weight)
        || nf.nf_table_update(table, index, importance, BATCH, Math.fround(0.3));
    line("nf_table", status, words[index / 4 + BATCH - 1], words[weight / 4 + BATCH - 1]);
}

tile();
controlVariate("nf_cv_estimate", PRECISION_F64);
streaming();
mis();
minibatch();
console.log(failures ? "failed" : "done");
process.exitCode = failures ? 1 : 0;
