// The player in Debian's Chromium, without a GPU, against `neuvv render`: PSNR of six views; its element; bad streams.
//   node tests/web/player.mjs NEUVV BUILT STREAM [FOLDER [WIDTHxHEIGHT]]
// BUILT: what tools/web/build made. FOLDER: where images are left. Exits with 1 where something is wrong.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {resultsOf} from './browser.mjs';
import {tone} from './streams.mjs';

const kAngle = 0.6, kLeast_db = 45, kLeastSmall_db = 20, kMostFirst_bytes = 120e3;
const kMostLost_db = 6;  // of the coarse parts, by half of their bytes
const [neuvv, built, stream, given, size = '320x240'] = process.argv.slice(2);
const folder = given ?? fs.mkdtempSync(path.join(os.tmpdir(), 'neuvv-web-'));
fs.mkdirSync(folder, {recursive: true});
const here = path.dirname(fileURLToPath(import.meta.url));
const [width, height] = size.split('x').map(Number);
const run = words => execFileSync(neuvv, words, {encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore']});
const bytes = fs.readFileSync(stream);
const {crc32, headBytes, readHead} = await import(path.resolve(built, 'nvs.js'));
const head = readHead(bytes.subarray(0, headBytes(bytes, Infinity)));

// Six cameras around the performer, each at another frame, and what NeuVV renders from there.
function renderViews() {
    const {boxMin, boxSize} = head.frames[0].group, frames = head.frames.length;
    const target = boxMin.map((low, axis) => low + boxSize[axis] / 2);
    const distance = 0.5 * Math.hypot(...boxSize) / Math.tan(kAngle / 2);
    const focal = height / 2 / Math.tan(kAngle / 2), views = [];
    for (let i = 0; i < 6; ++i) {
        const turn = 0.4 + i * Math.PI / 3, tilt = 0.5 * Math.sin(2 * i), across = Math.cos(tilt);
        const z = [Math.sin(turn) * across, Math.sin(tilt), Math.cos(turn) * across], flat = Math.hypot(z[0], z[2]);
        const x = [z[2] / flat, 0, -z[0] / flat];
        const y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]];
        const eye = target.map((at, axis) => at + distance * z[axis]);
        const frame = Math.floor(i * frames / 6), image = `view_${i}.png`, camera = path.join(folder, `camera_${i}.json`);
        fs.writeFileSync(camera, JSON.stringify({
            w: width, h: height, fl_x: focal, fl_y: focal, cx: width / 2, cy: height / 2,
            frames: [{transform_matrix: [0, 1, 2].map(axis => [x[axis], y[axis], z[axis], eye[axis]]).concat([[0, 0, 0, 1]])}]}));
        run(['render', stream, '-o', path.join(folder, image), '--camera', camera, '--frames', String(frame), '--background',
             'white', '--samples', '1', '--direct', '--overwrite']);  // what each ray sees
        views.push({frame, eye, target, image: `/views/${image}`});
    }
    fs.writeFileSync(path.join(folder, 'views.json'), JSON.stringify({stream: '/stream.nvs', width, height, angle: kAngle, views}));
    return frames;
}

const damaged = Buffer.from(bytes);
damaged[40] ^= 1;
// A head whose group begins elsewhere, with a sound check.
const elsewhere = Buffer.from(bytes), headEnd = headBytes(bytes, Infinity) - 4;
elsewhere[32 + 40] ^= 1;
elsewhere.writeUInt32LE(crc32(elsewhere.subarray(0, headEnd)), headEnd);
// One that is so slow that it lasts for some seconds, and its sound.
const slow = Buffer.from(bytes), slowFps = head.frames.length / 4;
slow.writeFloatLE(slowFps, 20);
slow.writeUInt32LE(crc32(slow.subarray(0, headEnd)), headEnd);
const kSent = {'/slow.nvs': slow, '/slow.m4a': tone(4), '/stream.m4a': tone(head.frames.length / head.fps), '/elsewhere.nvs': elsewhere, '/stream.nvs': bytes, '/whole/stream.nvs': bytes, '/empty.nvs': Buffer.alloc(0), '/damaged.nvs': damaged,
               '/page.nvs': Buffer.from('<!DOCTYPE html><p>Sign in</p>'), '/short.nvs': bytes.subarray(0, bytes.length - 100)};
const frames = renderViews();
const roots = [['/test/', here], ['/views/', folder], ['/', built]];
const {results, missing} = await resultsOf({page: '/test/player.html', roots, sent: kSent});

const wrong = [];
const savePng = (name, png) => fs.writeFileSync(path.join(folder, `${name}.png`), Buffer.from(png.split(',')[1], 'base64'));
const expect = (condition, text) => condition || wrong.push(text);
expect(!results.problem, results.problem);
for (const [i, view] of (results.views ?? []).entries()) {
    savePng(`web_${i}`, view.png);
    console.log(`view ${i}: ${view.psnr_db.toFixed(2)} dB; frame there after ${view.decoded_ms.toFixed(0)} ms, image ${view.image_ms.toFixed(0)} ms`);
    expect(view.psnr_db >= kLeast_db, `view ${i} has ${view.psnr_db.toFixed(2)} dB`);
}
if (!results.problem) {
    const {first, coarse, small, views: [whole]} = results;
    for (const [name, {png}] of Object.entries({first, coarse, small})) savePng(`web_${name}`, png);
    console.log(`view 0 as it is shown first: ${first.psnr_db.toFixed(2)} dB; by its coarse parts: ${coarse.psnr_db.toFixed(2)} dB`);
    console.log(`view 0 with as few leaves as can be: ${small.psnr_db.toFixed(2)} dB, image ${small.image_ms.toFixed(0)} ms`);
    expect(first.psnr_db !== coarse.psnr_db && first.psnr_db > coarse.psnr_db - kMostLost_db, `what is shown first has ${first.psnr_db} dB, coarse parts ${coarse.psnr_db}`);
    expect(small.entries < 0.6 * whole.entries, 'a budget leaves as many leaves');
    expect(small.psnr_db > kLeastSmall_db, `with a budget, view 0 has ${small.psnr_db.toFixed(2)} dB`);
    console.log(`first frame of the element: ${results.first_ms.toFixed(0)} ms, ${Math.round(results.first_bytes / 1000)} KB of the stream`);
    expect(results.first_bytes > 0, 'no bytes were counted');
    expect(results.first_bytes <= kMostFirst_bytes, `${results.first_bytes} bytes are fetched for the first picture`);
    const kProblems = {'/missing.nvs': '404: there is no such file; check the address',
                       '/empty.nvs': 'is empty', '/page.nvs': 'a web page', '/damaged.nvs': 'is damaged',
                       '/elsewhere.nvs': 'is damaged', '/short.nvs': 'ends early', '/whole/stream.nvs': 'ranges'};
    expect(results.views.length === 6 && results.frames === frames, 'views or frames are missing');
    for (const [url, text] of Object.entries(kProblems))
        expect(results.element.problems[url].includes(text), `${url}: "${results.element.problems[url]}" does not say "${text}"`);
    expect(results.other_view_db < kLeast_db - 10, 'another view passes, too');
    expect(results.element.atEnd, 'the player does not end');
    console.log(`sound and frames come together after ${results.element.together_s.toFixed(1)} s`);
    expect(results.element.together_s < 30, 'sound and frames stay apart');
    expect(results.playedOn, 'the next stream of a list does not play');
    expect(results.playRejects, 'play() does not say that it was ended');
    expect(results.element.isSilent, 'a player that is paused sounds');
    expect(results.element.fetched_s > 0.9 * results.element.duration, 'what has been fetched is not told');
    const {budget} = results.element;
    expect(budget.leaves === 1 && Math.abs(budget.time - 0.6) < 0.01 && budget.isPaused, `another budget changes more: ${JSON.stringify(budget)}`);
    for (const [i, {lines, leaves}] of results.warnings.entries()) {
        const isNonsense = i < 5, isSaid = lines.length === 1 && lines[0].includes('is no number of leaves');
        expect(isNonsense ? isSaid : lines.length === 0, `of budget ${i} the console says ${lines}`);
        expect(leaves === (i === 6 ? 1000 : 0), `budget ${i} is ${leaves}`);
    }
    expect(results.disposed.join() === 'AbortError,AbortError,it plays', `play() and dispose(): ${results.disposed}`);
    expect(results.element.recovers, 'the player does not recover');
    expect(results.element.duration > 0 && results.element.stepped > 0, 'the player does not step');
    for (const text of results.controls) wrong.push(text);
    const others = missing.filter(name => name !== '/missing.nvs');
    expect(others.length === 0, `asked for ${others}`);
}
if (!given) fs.rmSync(folder, {recursive: true});
for (const text of wrong) console.error(`wrong: ${text}`);
process.exit(wrong.length > 0 ? 1 : 0);
