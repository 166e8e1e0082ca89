// A player whose server does not do what it should. The player's own times pass faster here.
import {pixels, psnr} from './images.js';

let faster = 20;
const kMost_ms = 20000, kStands_ms = 500, kSeconds = 5;  // of the stream
const kSize = 160, kSame_db = 20;  // pixels; more rays are sent through an image that stands still
const setTimeoutOfBrowser = setTimeout;
window.setTimeout = (run, milliseconds = 0) => setTimeoutOfBrowser(run, milliseconds / faster);
const getContext = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, options) {  // so that what was drawn can be read later
    return getContext.call(this, kind, {...options, preserveDrawingBuffer: true});
};
const {NeuvvPlayer} = await import('/neuvv-player.js');

const results = {wrong: []};
const later = milliseconds => new Promise(resolve => setTimeoutOfBrowser(resolve, milliseconds));
const post = (name, words) => fetch(name, {method: 'POST', body: JSON.stringify(words)});
const server = async (way, times) => (await post('/server', {way, times})).text();

// What is true of a player, in a line, with what was expected of it.
let what = '';
const expect = (condition, text) => condition || results.wrong.push(`${what}: ${text}`);
async function until(done, text) {
    for (const begin = performance.now(); !done(); await later(10))
        if (performance.now() - begin > kMost_ms) return expect(false, `${text} does not come`);
}
const event = (player, name) => {
    let isThere = false;
    player.addEventListener(name, () => isThere = true, {once: true});
    return until(() => isThere, name);
};

async function opened(src = '/stream.nvs') {
    document.querySelector('neuvv-player')?.remove();
    const player = Object.assign(new NeuvvPlayer(), {loop: true, muted: true, playbackRate: 8});
    document.body.append(player);
    Object.assign(player.style, {width: `${kSize}px`});
    player.setAttribute('sound', '');
    player.src = src;
    return player;
}
async function playing() {
    await server('well');
    const player = await opened();
    player.play().catch(() => {});
    await event(player, 'playing');
    return player;
}
const line = player => player.shadowRoot.querySelector('.problem').textContent;
async function imageOf(player) {
    const bitmap = await createImageBitmap(player.shadowRoot.querySelector('canvas'), {resizeWidth: kSize, resizeHeight: kSize});
    return pixels(bitmap, kSize, kSize);
}
// `before`: what it has shown.
async function expectStays(player, before) {
    const value = psnr(before, await imageOf(player)), seen = before.filter((part, i) => i % 4 === 3 && part > 20).length;
    expect(seen > 100 && value > kSame_db, `the last image, of ${seen} pixels, does not stay: ${value.toFixed(1)} dB`);
}
const goesOn = async player => {
    const {currentTime} = player;
    await until(() => player.currentTime !== currentTime && player.readyState >= 2, 'another time');
};

// Until its time has not gone on for a moment: on a machine that is busy, it also waits for frames that come.
async function standing(player) {
    let [time, since] = [player.currentTime, performance.now()];
    await until(() => {
        if (player.currentTime !== time) [time, since] = [player.currentTime, performance.now()];
        return performance.now() - since > kStands_ms;
    }, 'a time that stands still');
}

// It waits with its last image, and goes on by itself.
async function waits(way) {
    what = `a server that ${way}`;
    faster = 8;  // until it gives up, there are eight seconds, in which a busy machine has done the rest
    const player = await playing();
    const waiting = event(player, 'waiting');
    await server(way);
    await waiting;
    await standing(player);
    const {currentTime} = player, before = await imageOf(player);
    await later(200);
    expect(!player.paused && !player.error, `it gives up: ${line(player)}`);
    expect(player.currentTime === currentTime, 'the time does not stand still');
    await expectStays(player, before);
    const again = event(player, 'playing');
    await server('well');
    await again;
    await goesOn(player);
    expect(!player.error && line(player) === '', `it says ${line(player)}`);
    player.dispose();
    faster = 20;
}

// A few answers are not what they should be: the player asks again, and nobody notices.
async function asksAgain(way, times = 3) {
    what = `a server that ${way} ${times} times`;
    const player = await playing();
    const end = player.currentTime + kSeconds;
    await server(way, times);
    await until(() => player.currentTime > end || player.error, 'the end');
    expect(!player.error, `it says ${line(player)}`);
    expect(await server('well') === '0', 'the server was not asked');
    player.dispose();
}

// It gives up in one line, with its last image, and tries again when it is told to.
async function givesUp(way) {
    what = `a server that ${way} for ever`;
    const player = await playing(), failed = event(player, 'error');
    let before;
    player.addEventListener('error', () => before = imageOf(player), {once: true});
    await server(way);
    await failed;
    expect(player.paused && line(player).startsWith('/stream.nvs: ') && !line(player).includes('\n'), `it says ${line(player)}`);
    expect(way === 'damages' ? line(player).includes('is damaged') : line(player).includes('press play'), `it says no way out: ${line(player)}`);
    await later(200);
    await expectStays(player, await before);
    await server('well');
    await player.play().catch(error => expect(false, `play() rejects: ${error.message}`));
    expect(line(player) === '' && !player.error, `it still says ${line(player)}`);
    await goesOn(player);
    player.dispose();
}

// A stream whose head does not come is opened again by play(), and by `src`.
async function opensAgain(byPlay) {
    what = `a head that does not come, and ${byPlay ? 'play()' : 'src'}`;
    await server('isSilent');
    const player = await opened();
    await event(player, 'error');
    expect(line(player).includes('press play'), `it says no way out: ${line(player)}`);
    await server('well');
    const loaded = event(player, 'loadeddata');
    if (byPlay) {
        await player.play().catch(error => expect(false, `play() rejects: ${error.message}`));
        await goesOn(player);
    } else {
        player.src = '/stream.nvs';
        await loaded;
    }
    expect(line(player) === '' && !player.error, `it still says ${line(player)}`);
    player.dispose();
}

// The browser keeps a damaged head; the server is asked again.
async function forgetsDamagedHead() {
    what = 'a damaged head';
    await server('damages');
    const player = await opened('/kept/stream.nvs');
    await event(player, 'error');
    await server('well');
    await player.play().catch(error => expect(false, `play() rejects: ${error.message}`));
    expect(!player.error, `it still says ${line(player)}`);
    player.dispose();
}

// However little each answer brings, the stream comes.
async function comesInPieces() {
    what = 'a server that ends each answer early';
    await server('endsEarly');
    const player = await opened();
    await event(player, 'loadeddata');
    expect(!player.error, `it says ${line(player)}`);
    player.dispose();
}

try {
    const ways = await (await fetch('/ways.json')).json();
    for (const way of ['isSilent', 'stops']) await waits(way);
    for (const way of ways.filter(one => !['isSilent', 'stops', 'damages'].includes(one))) await asksAgain(way);
    await asksAgain('damages', 1);
    for (const way of ['isSilent', 'sendsNothing', 'sendsOthers', 'hasLess', 'damages']) await givesUp(way);
    for (const byPlay of [true, false]) await opensAgain(byPlay);
    await forgetsDamagedHead();
    await comesInPieces();
} catch (error) {
    results.problem = `${what}: ${error.message}\n${error.stack}`;
}
await post('/results', results);
