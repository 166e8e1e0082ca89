// A page of one file, opened from the disk, in Debian's Chromium: shows what the page in a folder shows, sounds, seeks, plays
// to its end, and asks for nothing. Pages that need a server say so where there is none.
//   node tests/web/one_file.mjs NEUVV BUILT STREAM
// BUILT: what tools/web/build made. Exits with 1 where something is wrong.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import {pathToFileURL} from 'node:url';
import {serving, started} from './browser.mjs';
import {programWith} from './modules.mjs';
import {tone} from './streams.mjs';

const kPatience_ms = 20000, kMost_ms = 120000, kSame_db = 40, kOther_db = 25;
const [neuvv, built, stream] = process.argv.slice(2);
if (!fs.existsSync(path.join(built, 'one_file.html'))) {
    console.log('skipped: esbuild is not installed (apt-get install esbuild)');
    process.exit(77);
}
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'neuvv-one-file-')), show = path.join(folder, 'a show.nvs');
const program = programWith(neuvv, built, folder), wrong = [];
const expect = (condition, text) => condition || wrong.push(text);
fs.copyFileSync(stream, show);
fs.writeFileSync(path.join(folder, 'a show.m4a'), tone(4));
for (const page of ['a show.html', 'published'])
    execFileSync(program, ['publish', show, '--web', path.join(folder, page)], {stdio: 'ignore'});

// In the page, before its script: what is heard goes through `heard`.
function listen() {
    const make = AudioContext.prototype.createMediaElementSource;
    AudioContext.prototype.createMediaElementSource = function (audio) {
        const source = make.call(this, audio);
        window.heard = new AnalyserNode(this);
        source.connect(window.heard);
        return source;
    };
}
const heard = () => {
    const samples = new Float32Array(2048);
    window.heard?.getFloatTimeDomainData(samples);
    return Math.max(...samples);
};
// Stands at a frame, with as many rays as it gets.
async function stand(frame) {
    const player = document.querySelector('neuvv-player');
    while (player.readyState < 2) await new Promise(resolve => setTimeout(resolve, 20));
    player.pause();
    player.controls = false;
    const there = new Promise(resolve => player.addEventListener('seeked', resolve, {once: true}));
    player.currentTime = (frame + 0.5) / player.frameRate;
    await there;
    return {duration: player.duration, hasSound: player.hasSound, fetched: player.buffered.end(0)};
}
async function playToEnd() {
    const player = document.querySelector('neuvv-player'), ended = new Promise(resolve => player.addEventListener('ended', resolve));
    player.loop = false;
    player.currentTime = 0;
    await player.play();
    await ended;
    return player.error?.message ?? (player.ended && player.paused && player.currentTime === player.duration);
}
const pictureOf = async page => (await page.call('Page.captureScreenshot', {format: 'png'})).data;
// PSNR of two PNGs as base64, of the pixels that are no background in one of them.
async function psnrOf(pngs) {
    const kBackground = 0x18, [a, b] = await Promise.all(pngs.map(async png => {
        const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(png), letter => letter.charCodeAt(0))]));
        const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
        context.drawImage(bitmap, 0, 0);
        return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
    }));
    let sum = 0, count = 0;
    for (let i = 0; i < a.length; ++i) {
        if (i % 4 === 3 || (a[i] === kBackground && b[i] === kBackground)) continue;
        sum += (a[i] - b[i]) ** 2;
        ++count;
    }
    return count < 1000 ? 0 : Math.min(100, 10 * Math.log10(255 ** 2 / (sum / count)));
}
const compared = async (one, other) => other.evaluate(psnrOf, [await pictureOf(one), await pictureOf(other)]);
// What both show has a PSNR of so much, at last: a frame becomes whole, and gets more rays.
async function agreement(one, other) {
    let value = 0;
    for (const begin = Date.now(); value < kSame_db && Date.now() - begin < kPatience_ms;) value = await compared(one, other);
    return value;
}

// What a page says that is not served, once that is seen; null: it says nothing.
async function unserved() {
    await new Promise(resolve => setTimeout(resolve, 1500));
    const line = document.querySelector('.unserved'), {width, height} = line.getBoundingClientRect();
    if (width === 0) return null;
    return getComputedStyle(line).color === 'rgb(255, 255, 255)' && width > 100 && height > 10 ? line.innerText : 'what is not seen';
}

// {call, go, evaluate, requests, problems, end}. `script` runs in the page before its own; `requests`: addresses that it has
// asked for; `problems`: what the browser says of them on the console.
async function openedPage(url, script) {
    const {browser, devTools, log, end} = started(['--window-size=400,400', 'about:blank']);
    const {sessionId} = await devTools.page(), requests = [], problems = [];
    const call = (method, params) => devTools.call(method, params, sessionId);
    const ended = problem => () => {
        console.error(`wrong: ${url}: ${problem}\n${log()}`);
        process.exit(1);
    };
    const timer = setTimeout(ended('nothing came'), kMost_ms), fail = ended('chromium has ended');
    browser.on('exit', fail);
    // What a function of the page returns, as JSON.
    const evaluate = async (run, ...values) => {
        const expression = `(${run})(${values.map(value => JSON.stringify(value)).join()})`;
        const {result, exceptionDetails} = await call('Runtime.evaluate', {expression, awaitPromise: true, returnByValue: true});
        if (exceptionDetails) throw new Error(`${url}: ${exceptionDetails.exception?.description ?? exceptionDetails.text}`);
        return result.value;
    };
    const go = async to => {
        const loaded = new Promise(resolve => devTools.listen('Page.loadEventFired', resolve));
        await Promise.all([loaded, call('Page.navigate', {url: to})]);
    };
    devTools.listen('Log.entryAdded', ({entry}) => problems.push(`${entry.text} ${entry.url ?? ''}`));
    devTools.listen('Network.requestWillBeSent', ({request}) => requests.push(request.url));
    await call('Page.enable');
    await call('Network.enable');
    await call('Log.enable');
    await call('Page.addScriptToEvaluateOnNewDocument', {source: `(${script})()`});
    await go(url);
    return {call, go, evaluate, requests, problems, end: () => {
        clearTimeout(timer);
        browser.off('exit', fail);
        return end();
    }};
}

const server = await serving({roots: [['/built/', built], ['/', path.join(folder, 'published')]]});
const pages = [];
try {
    pages.push(await openedPage(pathToFileURL(path.join(folder, 'a show.html')).href, listen));
    pages.push(await openedPage(`${server.address}/index.html`, listen));
    const [one, other] = pages;
    let loudest = 0;
    for (const begin = Date.now(); loudest < 0.01 && Date.now() - begin < kPatience_ms;) loudest = await one.evaluate(heard);
    expect(loudest >= 0.01, `what is heard has an amplitude of ${loudest}`);
    const states = await Promise.all(pages.map(page => page.evaluate(stand, 2)));
    expect(JSON.stringify(states[0]) === JSON.stringify(states[1]) && states[0].hasSound, `the pages say ${JSON.stringify(states)}`);
    const same_db = await agreement(one, other);
    expect(same_db >= kSame_db, `the page of one file shows another picture: ${same_db.toFixed(1)} dB`);
    await one.evaluate(stand, 0);
    let other_db = same_db;
    for (const begin = Date.now(); other_db >= kOther_db && Date.now() - begin < kPatience_ms;) other_db = await compared(one, other);
    console.log(`the same frame: ${same_db.toFixed(1)} dB; another one: ${other_db.toFixed(1)} dB`);
    expect(other_db < kOther_db, `another frame looks the same: ${other_db.toFixed(1)} dB`);
    const end = await one.evaluate(playToEnd);
    expect(end === true, `the page does not play to its end: ${end}`);
    const outside = one.requests.filter(url => !url.startsWith('blob:')).slice(1);
    expect(one.requests[0]?.startsWith('file:') && outside.length === 0, `the page asks for ${outside}`);
    expect(await other.evaluate(unserved) === null, 'a page that is served says that it is not');
    const problems = pages.flatMap(page => page.problems);
    expect(problems.length === 0 && server.missing.length === 0, `the console says ${problems}; asked for ${server.missing}`);
    await other.go(`${server.address}/built/stage.html`);
    expect(await other.evaluate(unserved) === null, 'a page of stages that is served says that it is not');
    for (const page of [path.join(folder, 'published', 'index.html'), path.resolve(built, 'stage.html')]) {
        await one.go(pathToFileURL(page).href);
        const said = await one.evaluate(unserved);
        expect(said?.includes('only from a server') && said.includes('tools/serve'), `${page} from the disk says ${said}`);
    }
} catch (error) {
    wrong.push(error.message);
}
for (const page of pages) await page.end();
server.close();
fs.rmSync(folder, {recursive: true});
for (const text of wrong) console.error(`wrong: ${text}`);
process.exit(wrong.length > 0 ? 1 : 0);
