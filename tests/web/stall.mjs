// The player in Chromium while its server stalls, ends answers early, or sends others than it was asked for.
//   node tests/web/stall.mjs NEUVV BUILT STREAM
// BUILT: what tools/web/build made. Exits with 1 where something is wrong.
import fs from 'node:fs';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {answer, resultsOf} from './browser.mjs';
import {repeatedGroup} from './streams.mjs';

const kStreams = ['/stream.nvs', '/kept/stream.nvs'], kBlock = 1 << 14, kPiece = 3000;  // bytes
const [, built, stream] = process.argv.slice(2);
const here = path.dirname(fileURLToPath(import.meta.url));
const bytes = repeatedGroup(fs.readFileSync(stream), 320, 20, await import(path.resolve(built, 'nvs.js')));

// What a server may do with the range [begin, end) of the stream, apart from sending it.
const kWays = {
    isSilent() {},
    stops: (response, begin, end) =>  // and sends nothing of the rest
        send(response, begin, end).write(bytes.subarray(begin, begin % kBlock === 0 ? begin + (end - begin >> 1) : begin)),
    endsEarly: (response, begin, end) =>
        send(response, begin, end).write(bytes.subarray(begin, Math.min(begin + kPiece, end)), () => setTimeout(() => response.destroy(), 30)),
    sendsLess: (response, begin) => response.writeHead(206).end(bytes.subarray(begin, begin + 1)),
    sendsNothing: response => response.writeHead(206).end(),
    sendsMore: (response, begin) => response.writeHead(206).end(bytes.subarray(begin)),
    sendsOthers: (response, begin, end) => send(response, begin + 1, end + 1).end(bytes.subarray(begin + 1, end + 1)),
    sendsAll: response => response.writeHead(200).end(bytes),
    hasLess: (response, begin, end) => send(response, begin, end, begin).end(bytes.subarray(begin, end)),
    hasNoMore: response => response.writeHead(416).end(),
    isBusy: response => response.writeHead(503).end(),
    damages: (response, begin, end) => send(response, begin, end, bytes.length, {ETag: '"1"', 'Cache-Control': 'max-age=600'})
        .end(bytes.subarray(begin, end).map(byte => byte ^ 1)),
};
function send(response, begin, end, size = bytes.length, more = {}) {
    return response.writeHead(206, {'Content-Length': end - begin, 'Content-Range': `bytes ${begin}-${end - 1}/${size}`, ...more});
}

// Which way the server has now, for how many requests. Answers how many were left of the way before.
let way = null, left = 0;
const setWay = words => {
    const before = String(left);
    [way, left] = [words.way, words.times ?? Infinity];
    return before;
};
function serve(request, response, name, content) {
    const [, begin, last] = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '') ?? [];
    if (!kStreams.includes(name) || !kWays[way] || left === 0) return answer(request, response, name, content);
    --left;
    kWays[way](response, Number(begin), Math.min(Number(last) + 1, bytes.length));
}

const roots = [['/test/', here], ['/', built]], ways = JSON.stringify(Object.keys(kWays));
const {results} = await resultsOf({page: '/test/stall.html', roots, sent: {...Object.fromEntries(kStreams.map(name => [name, bytes])), '/ways.json': ways}, answers: {'/server': setWay}, serve});
if (results.problem) results.wrong.push(results.problem);
for (const text of results.wrong) console.error(`wrong: ${text}`);
process.exit(results.wrong.length > 0 ? 1 : 0);
