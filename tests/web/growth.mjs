// A player that loops: after its first minute, neither its heap nor its textures may grow. Not part of tools/test, as it takes long.
//   node tests/web/growth.mjs BUILT STREAM [MINUTES]
// BUILT: what tools/web/build made. Exits with 1 where something grows.
import fs from 'node:fs';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {resultsOf} from './browser.mjs';

// By so many bytes the least heap of the last third may be above that of the first. Frames that are being decoded, some of
// 10 MB each, are on the heap, too: one run that fails proves no growth, and the heap by minutes has to be looked at.
const kMostHeap = 2e6;
const [built, stream, minutes = '30'] = process.argv.slice(2);
const here = path.dirname(fileURLToPath(import.meta.url));
const {results} = await resultsOf({page: `/test/growth.html?minutes=${minutes}`, roots: [['/test/', here], ['/', built]],
                                   sent: {'/stream.nvs': fs.readFileSync(stream)}, most_s: 60 * minutes + 240,
                                   flags: ['--js-flags=--expose-gc', '--enable-precise-memory-info']});
const wrong = results.problem ? [results.problem] : [];
if (results.counts?.length >= 18) {
    const leastOf = counts => Math.min(...counts.map(count => count.heap));
    const minutesOf = counts => Array.from({length: Math.floor(counts.length / 6)}, (_, i) => leastOf(counts.slice(6 * i, 6 * i + 6)));
    const heaps = minutesOf(results.counts).slice(1), third = Math.ceil(heaps.length / 3);  // after the first minute
    const before = Math.min(...heaps.slice(0, third)), after = Math.min(...heaps.slice(-third));
    const textures = Math.max(...results.counts.map(count => count.textures));
    console.log(`heap ${(before / 1e6).toFixed(2)} MB at first, ${(after / 1e6).toFixed(2)} MB in the last third; at most ${textures} textures; ` +
                `${results.counts.at(-1).frames} times shown`);
    console.log(`heap by minutes, MB: ${minutesOf(results.counts).map(bytes => (bytes / 1e6).toFixed(1)).join(' ')}`);
    if (after > before + kMostHeap) wrong.push('the heap grows');
    if (textures > 6) wrong.push('textures are left');  // three of a tree, and of the next
    if (results.counts.at(-1).frames === results.counts[6].frames) wrong.push('nothing was played');
} else {
    wrong.push('MINUTES must be at least 3');
}
for (const text of wrong) console.error(`wrong: ${text}`);
process.exit(wrong.length > 0 ? 1 : 0);
