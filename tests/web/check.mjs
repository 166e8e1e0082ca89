// The player in Debian's Chromium, without a GPU, against `neuvv render`: PSNR of six views; its element; bad streams.
//   node tests/web/check.mjs NEUVV BUILT STREAM [FOLDER [WIDTHxHEIGHT]]
// BUILT: what tools/web/build made. FOLDER: where images are left. Exits with 1 where something is wrong.
import {execFileSync, spawn} from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import os from 'node:os';
import path from 'node:path';
import {fileURLToPath} from 'node:url';

const kAngle = 0.6, kLeast_db = 45, kMost_s = 240;
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
const kSent = {'/elsewhere.nvs': elsewhere, '/stream.nvs': bytes, '/whole/stream.nvs': bytes, '/empty.nvs': Buffer.alloc(0), '/damaged.nvs': damaged,
               '/page.nvs': Buffer.from('<!DOCTYPE html><p>Sign in</p>'), '/short.nvs': bytes.subarray(0, bytes.length - 100)};
const kTypes = {'.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm', '.json': 'application/json', '.png': 'image/png'};
const kPolicy = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; connect-src 'self'; worker-src 'self'; img-src 'self'";

function file(name) {
    const roots = [['/test/', here], ['/views/', folder], ['/', built]];
    const [prefix, root] = roots.find(([start]) => name.startsWith(start));
    const found = path.join(root, path.normalize('/' + name.slice(prefix.length)));
    return fs.existsSync(found) && fs.statSync(found).isFile() ? fs.readFileSync(found) : null;
}

let finish;
const finished = new Promise(resolve => finish = resolve);
const others = [];  // requests that should not be
const server = http.createServer((request, response) => {
    const name = new URL(request.url, 'http://x').pathname;
    if (name === '/results') {
        let body = '';
        request.on('data', part => body += part).on('end', () => finish(JSON.parse(body)));
        return response.end();
    }
    const content = kSent[name] ?? file(name), range = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '');
    const headers = {'Content-Type': kTypes[path.extname(name)] ?? 'application/octet-stream', 'Content-Security-Policy': kPolicy};
    if (!content) {
        if (!['/missing.nvs', '/favicon.ico'].includes(name)) others.push(name);
        response.writeHead(404, headers).end();
    } else if (!range || name.startsWith('/whole/')) {
        response.writeHead(200, headers).end(content);
    } else if (Number(range[1]) >= content.length) {
        response.writeHead(416, headers).end();
    } else {
        const part = content.subarray(Number(range[1]), Number(range[2]) + 1);
        headers['Content-Range'] = `bytes ${range[1]}-${Number(range[1]) + part.length - 1}/${content.length}`;
        response.writeHead(206, headers).end(part);
    }
});

const frames = renderViews();
await new Promise(resolve => server.listen(0, '127.0.0.1', resolve));
const profile = fs.mkdtempSync(path.join(os.tmpdir(), 'neuvv-chromium-'));
const browser = spawn('chromium', ['--headless=new', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
    '--disable-dev-shm-usage', `--user-data-dir=${profile}`, '--no-first-run', `http://127.0.0.1:${server.address().port}/test/page.html`],
    {stdio: ['ignore', 'ignore', 'pipe'], detached: true});  // a group of its own, which is ended as a whole
let log = '';
browser.stderr.on('data', text => log += text);
browser.on('exit', code => finish({problem: `chromium ended with ${code}\n${log}`}));
const timer = setTimeout(() => finish({problem: `nothing came in ${kMost_s} s\n${log}`}), 1000 * kMost_s);
const results = await finished;
clearTimeout(timer);
if (browser.exitCode === null) {
    const exited = new Promise(resolve => browser.on('exit', resolve));
    process.kill(-browser.pid, 'SIGKILL');
    await exited;
}
await fs.promises.rm(profile, {recursive: true, force: true, maxRetries: 20, retryDelay: 100});  // some may still write
server.close();

const wrong = [];
const expect = (condition, text) => condition || wrong.push(text);
expect(!results.problem, results.problem);
for (const [i, view] of (results.views ?? []).entries()) {
    fs.writeFileSync(path.join(folder, `web_${i}.png`), Buffer.from(view.png.split(',')[1], 'base64'));
    console.log(`view ${i}: ${view.psnr_db.toFixed(2)} dB; frame there after ${view.decoded_ms.toFixed(0)} ms, image ${view.image_ms.toFixed(0)} ms`);
    expect(view.psnr_db >= kLeast_db, `view ${i} has ${view.psnr_db.toFixed(2)} dB`);
}
if (!results.problem) {
    console.log(`first picture of the element: ${results.first_ms.toFixed(0)} ms, ${Math.round(results.first_bytes / 1000)} KB of the stream`);
    expect(results.first_bytes > 0, 'no bytes were counted');
    const kProblems = {'/missing.nvs': '404', '/empty.nvs': 'is empty', '/page.nvs': 'a web page', '/damaged.nvs': 'is damaged',
                       '/elsewhere.nvs': 'is damaged', '/short.nvs': 'ends early', '/whole/stream.nvs': 'ranges'};
    expect(results.views.length === 6 && results.frames === frames, 'views or frames are missing');
    for (const [url, text] of Object.entries(kProblems))
        expect(results.element.problems[url].includes(text), `${url}: "${results.element.problems[url]}" does not say "${text}"`);
    expect(results.other_view_db < kLeast_db - 10, 'another view passes, too');
    expect(results.element.atEnd, 'the player does not end');
    expect(results.element.recovers, 'the player does not recover');
    expect(results.element.duration > 0 && results.element.stepped > 0, 'the player does not step');
    expect(others.length === 0, `asked for ${others}`);
}
if (!given) fs.rmSync(folder, {recursive: true});
for (const text of wrong) console.error(`wrong: ${text}`);
process.exit(wrong.length > 0 ? 1 : 0);
