// A player that loops: once all of its code has run for a while, nothing that it holds may grow. Not part of tools/test, as it takes long.
//   node tests/web/growth.mjs BUILT STREAM [MINUTES]
// BUILT: what tools/web/build made. Exits with 1 where something grows.
import fs from 'node:fs';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {answer, resultsOf} from './browser.mjs';

// By so much the median of the last third may be above that of the first: bytes, or how many. `heap`: of scripts, `buffers`:
// of their arrays, `memories`: of WebAssembly; of the page and its workers.
const kMostMore = {heap: 3e4, buffers: 1e4, memories: 0, nodes: 0, listeners: 0, textures: 0};
// These are compared with the second third: a memory of WebAssembly keeps the most that any order of frames has needed, and
// some orders are rare.
const kSettleLate = ['memories'];
const kWarm_s = 90;       // until then, browsers compile what runs often
const kLeastCounts = 6, kStream = '/stream.nvs', kPiece = 4096;
const kMostTextures = 6;  // three of a tree, and of the next
const [built, stream, minutes = '30'] = process.argv.slice(2);
const here = path.dirname(fileURLToPath(import.meta.url));

// So that a page or a worker knows how large its memories of WebAssembly are.
const kMemories = `{
    const {instantiate} = WebAssembly, memories = [];
    WebAssembly.instantiate = async (...words) => {
        const instance = await instantiate(...words);
        memories.push(instance.exports.memory);
        return instance;
    };
    self.memoryBytes = () => memories.reduce((sum, {buffer}) => sum + buffer.byteLength, 0);
}`;
// What the page and its workers hold, once all that nobody holds is gone. It is noted here, as notes of the page's own would
// grow. `buffers`: without the bytes of the stream that have come, of which some are first asked for late.
const counts = [], sentPieces = new Set();  // of the stream, of kPiece bytes each
async function count(words, devTools) {
    const all = {heap: 0, buffers: -kPiece * sentPieces.size, memories: 0}, {sessionId: page} = await devTools.page();
    for (const session of [page, ...await devTools.workers()]) {
        const call = (method, params) => devTools.call(method, params, session);
        all.memories += (await call('Runtime.evaluate', {expression: 'memoryBytes()'})).result.value;
        for (let i = 0; i < 3; ++i) await call('HeapProfiler.collectGarbage');
        const {usedSize, backingStorageSize} = await call('Runtime.getHeapUsage');
        all.heap += usedSize;
        all.buffers += backingStorageSize;
    }
    const {nodes, jsEventListeners: listeners} = await devTools.call('Memory.getDOMCounters', {}, page);
    counts.push({...all, nodes, listeners, ...words});
    return '';
}
function serve(request, response, name, content) {
    const [, begin, last] = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '') ?? [];
    if (name === kStream && begin)
        response.on('finish', () => {
            for (let at = Number(begin); at <= Math.min(last, content.length - kPiece); at += kPiece) sentPieces.add(at);
        });
    answer(request, response, name, content);
}

const sent = {[kStream]: fs.readFileSync(stream), '/memories.js': kMemories,
              '/worker.js': `import './memories.js';\n${fs.readFileSync(path.join(built, 'worker.js'))}`};
const {results} = await resultsOf({page: `/test/growth.html?minutes=${minutes}`, roots: [['/test/', here], ['/', built]], sent,
                                   answers: {'/count': count}, serve, most_s: 60 * minutes + 240});
const wrong = results.problem ? [results.problem] : [];
const late = counts.filter(({seconds}) => seconds > kWarm_s), third = Math.ceil(late.length / 3);
if (late.length < kLeastCounts) wrong.push(`${late.length} counts after ${kWarm_s} s are too few; MINUTES must be at least 3`);
for (const [name, most] of Object.entries(late.length < kLeastCounts ? {} : kMostMore)) {
    const medianOf = part => part.map(count => count[name]).sort((a, b) => a - b)[part.length >> 1];
    const [from, to] = kSettleLate.includes(name) ? [third, -third] : [0, third];
    const before = medianOf(late.slice(from, to)), after = medianOf(late.slice(-third));
    console.log(`${name}: ${before} before, ${after} in the last third; ${counts.map(count => count[name]).join(' ')}`);
    if (after > before + most) wrong.push(`${name} grow from ${before} to ${after}`);
}
console.log(`${counts.at(-1)?.frames} times shown`);
if (counts.some(({textures}) => textures > kMostTextures)) wrong.push('textures are left');
if (counts.some(({frames}, i) => i > 0 && frames <= counts[i - 1].frames)) wrong.push('nothing was played');
for (const text of wrong) console.error(`wrong: ${text}`);
process.exit(wrong.length > 0 ? 1 : 0);
