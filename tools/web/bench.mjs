// What a frame of a stream costs by decoder.wasm, in Node, and by the program: from bytes to a slice tree, in
// milliseconds of one core, the median over the frames. Decoding should take at most twice as long.
//   node tools/web/bench.mjs STREAM [BUILT [NEUVV_BENCH]]
// BUILT: what tools/web/build made.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {inflateSync} from 'node:zlib';

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../..');
const [stream, built = `${root}/build/web`, bench = `${root}/build/release/neuvv-bench`] = process.argv.slice(2);
if (!stream) {
    console.error('usage: node tools/web/bench.mjs STREAM [BUILT [NEUVV_BENCH]]');
    process.exit(1);
}
const {copied, instantiated} = await import(path.resolve(built, 'decoder.js'));
const {headBytes, kCoarseParts, kParts, readHead} = await import(path.resolve(built, 'nvs.js'));
const file = fs.readFileSync(stream), {frames} = readHead(file.subarray(0, headBytes(file, file.length)));
const codec = await instantiated(await WebAssembly.compile(fs.readFileSync(path.join(built, 'decoder.wasm'))));
const bytesAt = ({begin, bytes}) => file.subarray(begin, begin + bytes);

function milliseconds(work) {
    const begin = process.cpuUsage();
    work();
    const {user, system} = process.cpuUsage(begin);
    return (user + system) / 1000;
}

function openGroup({tables: place, depth, degree, mostLeaves}, budget) {
    const bytes = inflateSync(bytesAt(place)), tables = copied(codec, bytes);
    const group = codec.neuvv_group_new(tables, bytes.length, depth, degree, mostLeaves, budget);
    codec.free(tables);
    if (!group) throw new Error(`${stream}: its tables are damaged`);
    return group;
}

// Both steps of the frame that follows, and the slice tree of it.
function measureFrame(group, {group: {boxSize}, parts: all}, partCount) {
    const parts = all.slice(0, partCount), bytes = Buffer.concat(parts.map(bytesAt)), place = copied(codec, bytes);
    const sizes = copied(codec, new Uint8Array(Uint32Array.from(all, part => part.bytes).buffer));
    let leaves, tree;
    const decode_ms = milliseconds(() => {
        leaves = codec.neuvv_group_decode_shape(group, place, bytes.length, sizes, partCount);
        if (leaves >= 0) leaves = codec.neuvv_group_decode_planes(group, place, bytes.length, sizes, partCount);
    });
    if (leaves < 0) throw new Error(`${stream}: a frame is damaged`);
    const tree_ms = milliseconds(() => tree = codec.neuvv_slice_tree_new(group, ...boxSize));
    for (const free of [place, sizes]) codec.free(free);
    codec.neuvv_slice_tree_free(tree);
    return {decode_ms, tree_ms, leaves};
}

function measure(budget = 0) {
    let group, last = null;
    return frames.map(frame => {
        if (frame.group !== last) {
            if (last) codec.neuvv_group_free(group);
            group = openGroup(last = frame.group, budget);
        }
        return measureFrame(group, frame, budget ? kCoarseParts : kParts);
    });
}

const median = values => values.sort((a, b) => a - b)[values.length >> 1];
measure();  // until then, Node's compiler is still at work
const here = measure(), decode_ms = median(here.map(one => one.decode_ms)), tree_ms = median(here.map(one => one.tree_ms));
const native = JSON.parse(execFileSync(bench, ['stream', stream, '--frames', String(Math.min(frames.length, 10000)), '--json'],
                                       {encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit']}));
function line(name, web, program) {
    const ratio = (web / program).toFixed(2);
    console.log(`${name.padEnd(40)}${web.toFixed(1).padStart(12)}${program.toFixed(1).padStart(10)}${ratio.padStart(8)}`);
}
console.log(`${stream}: ${frames.length} frames of ${native.leaves} leaves`);
console.log(`${''.padEnd(40)}${'WebAssembly'.padStart(12)}${'program'.padStart(10)}${'ratio'.padStart(8)}  ms of one core`);
line('bytes to slice', decode_ms, native.decode_ms);
line('slice to what the device gets', tree_ms, native.upload_ms);
for (const part of [2, 4]) {
    const all = measure(Math.floor(native.leaves / part)), of = name => median(all.map(one => one[name]));
    console.log(`budget of 1/${part} of the leaves: ${of('leaves')} leaves, ${of('decode_ms').toFixed(1)} + ${of('tree_ms').toFixed(1)} ms`);
}
