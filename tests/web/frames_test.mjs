// Which frames the player for browsers asks for, and what it leaves out when they are not wanted any more.
//   BUILT=… STREAM=… node --test frames_test.mjs      (BUILT: what tools/web/build made)
import assert from 'node:assert';
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import test from 'node:test';
import {repeatedGroup} from './streams.mjs';

const built = path.resolve(process.env.BUILT);
const stream = repeatedGroup(fs.readFileSync(process.env.STREAM), 20, 20, await import(`${built}/nvs.js`));
const later = milliseconds => new Promise(resolve => setTimeout(resolve, milliseconds));
async function until(done) {
    for (const begin = Date.now(); !done() && Date.now() - begin < 10000;) await later(1);
}

// Node has no workers as browsers have them, and reads no files by fetch.
const decoded = [];  // the requests for decoding
let damaged = null;  // of so many parts, all frames are
globalThis.navigator ??= {hardwareConcurrency: 2};
globalThis.Worker = class {
    postMessage({id, module, partCount}) {
        if (module) return;
        decoded.push(partCount);
        const answer = partCount === damaged ? {error: 'a frame is damaged'} : {tree: {}, times: {shapes: 1}};
        setTimeout(() => this.onmessage({data: {id, ...answer}}));
    }
    terminate() {}
};
const fetchOfNode = fetch, caches = [];  // how the caches were to be used, of each request
globalThis.fetch = (url, options) => {
    if (url.protocol === 'file:') return Promise.resolve(new Response(fs.readFileSync(url)));
    caches.push(options.cache);
    return fetchOfNode(url, options);
};
const {FrameQueue} = await import(`${built}/frame_queue.js`);
const {FrameReader} = await import(`${built}/frames.js`);
const {kBeginnings, kLeastParts} = await import(`${built}/nvs.js`);

// A reader of 1000 frames, each of which comes when it is told to.
function fakeReader() {
    const reader = {readsAheadFor() {}, tryAgain() {}, fps: 10, lead_s: 0, frames: Array(1000).fill({}), parts: 3, asked: [], arrivals: [], partsInTime: () => reader.parts,
                    learnArrival: seconds => reader.arrivals.push(seconds),
                    tree: (frame, partCount, signal) => new Promise((resolve, reject) => {
                        reader.asked.push({frame, partCount, signal, come: () => resolve({frame})});
                        signal.addEventListener('abort', () => reject(signal.reason));
                    })};
    return reader;
}
const framesOf = asked => asked.map(({frame}) => frame);
const wanted = reader => framesOf(reader.asked.filter(({signal}) => !signal.aborted));
const from = first => Array.from({length: 5}, (_, i) => first + i);

async function showFirst(queue, reader) {
    queue.follow(from(0), {rate: 0}, 0);
    reader.asked.at(-1).come();
    await later(0);
    assert.strictEqual(queue.take()?.tree.frame, 0);
}

test('nothing comes before the first frame that is shown, which begins with little', async () => {
    const reader = fakeReader(), queue = new FrameQueue(reader);
    await showFirst(queue, reader);
    assert.deepStrictEqual(reader.asked.map(({frame, partCount}) => [frame, partCount]), [[0, 1]]);
    queue.follow(from(0), {rate: 1}, 16);
    assert.deepStrictEqual(framesOf(reader.asked), [0, 1, 2, 3, 4]);
    assert.strictEqual(reader.asked[1].partCount, 3, 'as many as come in time');
});

test('what stands still is read as a whole after a moment', async () => {
    const reader = fakeReader(), queue = new FrameQueue(reader);
    await showFirst(queue, reader);
    queue.follow(from(0), {rate: 0}, 200);
    queue.follow(from(1), {rate: 0}, 300);
    queue.follow(from(1), {rate: 0}, 900);
    assert(!framesOf(reader.asked.slice(1)).includes(0));
    assert(reader.asked.every(({partCount}) => partCount < 5), 'what is not there does not stand still');
    reader.asked[1].come();
    await later(0);
    assert.strictEqual(queue.take().tree.frame, 1);
    queue.follow(from(1), {rate: 0}, 1100);
    assert.strictEqual(framesOf(reader.asked).filter(frame => frame === 1).length, 1);
    queue.follow(from(1), {rate: 0, waits: true}, 1200);
    queue.follow(from(1), {rate: 0}, 1300);
    assert(reader.asked.every(({partCount}) => partCount < 5), 'nor does a player that waits');
    queue.follow(from(1), {rate: 0}, 1500);
    const whole = reader.asked.find(({partCount}) => partCount === 5);
    assert.strictEqual(whole.frame, 1);
    whole.come();
    await later(0);
    assert.strictEqual(queue.take().partCount, 5);
    const count = reader.asked.length;
    queue.follow(from(1), {rate: 0}, 1900);
    assert.strictEqual(reader.asked.length, count, 'once');
});

test('ten quick seeks ask for ten frames, and only the last is still wanted', async () => {
    const reader = fakeReader(), queue = new FrameQueue(reader);
    await showFirst(queue, reader);
    queue.follow(from(0), {rate: 0}, 16);
    const before = reader.asked.length;
    for (let i = 1; i <= 10; ++i) queue.follow(from(90 * i), {rate: 0, seeks: true}, 16 + 16 * i);
    assert.strictEqual(reader.asked.length - before, 10);
    assert.deepStrictEqual(wanted(reader), [0, 900]);
    reader.asked.at(-1).come();
    await later(0);
    assert.strictEqual(queue.take().tree.frame, 900);
    queue.follow(from(900), {rate: 0}, 300);
    assert.deepStrictEqual(wanted(reader), [0, 900, 901, 902, 903, 904]);
    for (const one of reader.asked.slice(-4)) one.come();
    await later(0);
    queue.follow(from(901), {rate: 0, seeks: true}, 316);
    assert(queue.has(904), 'what is decoded stays');
});

test('what comes to a page that slept says nothing of later frames', async () => {
    const reader = fakeReader(), queue = new FrameQueue(reader), now = performance.now;
    await showFirst(queue, reader);
    queue.follow(from(0), {rate: 1}, 16);
    performance.now = () => now.call(performance) + 3600000;
    reader.asked[1].come();
    await later(0);
    performance.now = now;
    assert(queue.has(1) && reader.arrivals.length === 0, `${reader.arrivals}`);
    reader.asked[2].come();
    await later(0);
    assert.strictEqual(reader.arrivals.length, 1);
});

test('frames that cannot be there in time are left out', async () => {
    const reader = fakeReader(), queue = new FrameQueue(reader);
    await showFirst(queue, reader);
    reader.lead_s = 0.25;
    queue.follow(from(1), {rate: 1}, 16);
    assert.deepStrictEqual(framesOf(reader.asked), [0, 3, 4, 5]);
    reader.asked[2].come();
    await later(0);
    queue.follow(from(5), {rate: 1}, 316);
    assert(!reader.asked[1].signal.aborted);
    assert.strictEqual(queue.take().tree.frame, 4, 'late, but later than what is shown');
    assert.strictEqual(queue.take(), null);
    queue.follow(from(5), {rate: 1}, 332);
    assert(reader.asked[1].signal.aborted, 'earlier than what is shown');
    assert.strictEqual(reader.arrivals.length, 1);
    queue.follow(from(900), {rate: 0}, 348);
    assert.deepStrictEqual(wanted(reader).filter(frame => frame >= 900), from(900), 'but not while the player waits');
    assert.deepStrictEqual(wanted(reader).filter(frame => frame > 4 && frame < 900), [], 'after a jump');
});

// Counts requests, and those that ended early. `damaged`: how many answers are wrong from now on.
async function serve(delay_ms, context) {
    const counts = {asked: 0, ended: 0}, ways = {damaged: 0};
    const server = http.createServer(async (request, response) => {
        const [, begin, end] = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range).map(Number);
        ++counts.asked;
        response.on('close', () => counts.ended += response.writableFinished ? 0 : 1);
        await later(delay_ms);
        const part = ways.damaged-- > 0 ? stream.subarray(begin, end + 1).map(byte => byte ^ 1) : stream.subarray(begin, end + 1);
        response.writeHead(206, {'Content-Range': `bytes ${begin}-${begin + part.length - 1}/${stream.length}`}).end(part);
    });
    await new Promise(resolve => server.listen(0, '127.0.0.1', resolve));
    context.after(() => server.closeAllConnections() ?? server.close());
    return {url: new URL(`http://127.0.0.1:${server.address().port}/stream.nvs`), counts, ways};
}

test('what is not wanted any more is not decoded', async context => {
    const server = await serve(0, context), reader = await FrameReader.open(server.url);
    decoded.length = 0;
    for (let i = 0; i < 10; ++i) {
        const stop = new AbortController(), tree = reader.tree(i % 4, 5, stop.signal);
        stop.abort();
        await assert.rejects(tree, {name: 'AbortError'});
    }
    assert.strictEqual(decoded.length, 0);
    const last = reader.frames.findLastIndex(frame => !frame.isKey);
    await reader.tree(last, 3);
    assert.deepStrictEqual(decoded, [3, 3], 'what it repeats comes first, of as many parts');
    await reader.tree(last, 5);
    assert.deepStrictEqual(decoded, [3, 3, 5, 5]);
    reader.end();
});

test('a read that ends leaves others what they wait for', async context => {
    const {RangeSource} = await import(`${built}/source.js`);
    const server = await serve(400, context), source = new RangeSource(server.url);
    const first = new AbortController(), second = new AbortController();
    const one = source.read(0, 1000, first.signal), two = source.read(100, 1000, second.signal);
    await until(() => server.counts.asked === 1);
    first.abort();
    await assert.rejects(one, {name: 'AbortError'});
    assert.deepStrictEqual(Buffer.from(await two), stream.subarray(100, 1100));
    assert.deepStrictEqual({...server.counts}, {asked: 1, ended: 0});
    const again = new RangeSource(server.url), third = new AbortController();
    const three = again.read(0, 1000, third.signal);
    await until(() => server.counts.asked === 2);
    third.abort();
    const four = again.read(0, 1000);  // at once after what ended
    await assert.rejects(three, {name: 'AbortError'});
    assert.deepStrictEqual(Buffer.from(await four), stream.subarray(0, 1000));
    await until(() => server.counts.ended > 0);
    assert.deepStrictEqual({...server.counts}, {asked: 3, ended: 1});
});

test('bytes that came damaged, and no others, are not taken from caches again', async context => {
    const {RangeSource} = await import(`${built}/source.js`), kFar = 1 << 16;
    const server = await serve(0, context), source = new RangeSource(server.url);
    server.ways.damaged = 1;
    assert.notDeepStrictEqual(Buffer.from(await source.read(0, 1000)), stream.subarray(0, 1000));
    source.forget(0, 1000);
    caches.length = 0;
    assert.deepStrictEqual(Buffer.from(await source.read(0, 1000)), stream.subarray(0, 1000));
    await source.read(kFar, 1000);
    assert.deepStrictEqual(caches, ['reload', 'default']);
    source.forget(kFar, 1000);
    assert.deepStrictEqual(Buffer.from(await source.read(100, 1000)), stream.subarray(100, 1100));
    await source.read(kFar, 1000);
    assert.deepStrictEqual(caches, ['reload', 'default', 'reload'], 'what is sound stays');
});

test('a head or a part that came damaged is asked for once more', async context => {
    const server = await serve(0, context);
    server.ways.damaged = 1;
    caches.length = 0;
    const reader = await FrameReader.open(server.url);
    assert(caches.length <= 3 && caches[0] === 'default' && caches[1] === 'reload', `${caches}`);
    server.ways.damaged = 1;
    caches.length = 0;
    await reader.tree(reader.frames.length - 1);
    assert(caches.includes('default') && caches.includes('reload') && server.ways.damaged < 0, `${caches}`);
    reader.end();
    server.ways.damaged = Infinity;
    caches.length = 0;
    await assert.rejects(FrameReader.open(server.url), {message: /no \.nvs stream/});
    assert.strictEqual(caches.length, 2);
});

test('a first picture that came damaged is drawn from the whole part, which has a check', async context => {
    const server = await serve(0, context), reader = await FrameReader.open(server.url), {firstBytes} = FrameReader;
    context.after(() => {
        FrameReader.firstBytes = firstBytes;
        damaged = null;
        reader.end();
    });
    FrameReader.firstBytes = reader.frames[0].parts[1].bytes / 2;
    damaged = kBeginnings;
    decoded.length = caches.length = 0;
    await reader.tree(0, kBeginnings);
    assert.deepStrictEqual(decoded, [kBeginnings, kLeastParts]);
    assert(caches.includes('reload'), 'what was damaged comes anew');
    damaged = kLeastParts;
    await assert.rejects(reader.tree(0, kLeastParts), {message: 'a frame is damaged'});
    const stop = new AbortController(), tree = reader.tree(0, kBeginnings, stop.signal);
    stop.abort();
    await assert.rejects(tree, {name: 'AbortError'});
});
