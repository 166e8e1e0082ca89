// What the player shows, in a browser: each view of views.json against the image that NeuVV rendered, and the element.
import {FrameReader} from '/frames.js';
import {pixels, psnr} from '/test/images.js';
import {lookAt, multiply, perspective} from '/matrices.js';
import {useControls} from './controls.js';
import {kBeginnings, kLeastParts, kParts} from '/nvs.js';
import {Renderer} from '/renderer.js';

const results = {};

// How long an image takes, with what it has to wait for.
function millisecondsOf(canvas, draw) {
    const gl = canvas.getContext('webgl2'), begin = performance.now(), times = 5;
    for (let i = 0; i < times; ++i) {
        draw();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }
    return (performance.now() - begin) / times;
}

async function compareViews({stream, width, height, angle, views}) {
    const canvas = Object.assign(document.createElement('canvas'), {width, height});
    const renderer = new Renderer(canvas, await (await fetch('/performer.frag')).text());
    const url = new URL(stream, location.href), reader = await FrameReader.open(url);
    const compared = async (from, {frame, eye, target, image}, partCount = kParts) => {
        const begin = performance.now();
        const tree = await from.tree(frame, partCount), decoded_ms = performance.now() - begin;
        renderer.show(tree);
        const clipFromTree = multiply(perspective(angle, width / height, 0.01), lookAt(eye, target)), white = [1, 1, 1, 1];
        const draw = () => {
            renderer.gl.viewport(0, 0, width, height);
            renderer.clear(white);
            renderer.draw([...eye, 1], clipFromTree, white);
        };
        const image_ms = millisecondsOf(canvas, draw);
        draw();
        const png = canvas.toDataURL('image/png'), truth = new Image();
        const shown = await pixels(canvas, width, height);
        truth.src = image;
        await truth.decode();
        const wanted = await pixels(truth, width, height);
        const entries = tree.entries.reduce((count, word) => count + (word !== 0), 0);
        return {shown, wanted, view: {psnr_db: psnr(shown, wanted), decoded_ms, image_ms, entries, png}};
    };
    results.frames = reader.frames.length;
    const all = [];
    for (const view of views) all.push(await compared(reader, view));
    results.views = all.map(({view}) => view);
    results.other_view_db = psnr(all[0].shown, all[1].wanted);
    const {firstBytes} = FrameReader;
    FrameReader.firstBytes = Math.min(firstBytes, reader.frames[views[0].frame].parts[1].bytes / 2);
    results.first = (await compared(reader, views[0], kBeginnings)).view;
    FrameReader.firstBytes = firstBytes;
    results.coarse = (await compared(reader, views[0], kLeastParts)).view;
    reader.end();
    const small = await FrameReader.open(url, 1);
    results.small = (await compared(small, views[0])).view;
    small.end();
    renderer.end();
}

const event = (player, name) => new Promise(resolve => player.addEventListener(name, resolve, {once: true}));
const later = milliseconds => new Promise(resolve => setTimeout(resolve, milliseconds));
async function until(done) {
    while (!done()) await later(20);
}

// How long sound and frames, of a stream of some seconds, take to come within 40 ms and to stay there for 20 images, seconds.
async function hear(player, sounds) {
    const loaded = event(player, 'loadeddata');
    player.src = '/slow.nvs';
    await loaded;
    player.currentTime = 1;
    await player.play();
    const begin = performance.now(), seconds = () => (performance.now() - begin) / 1000;
    for (let together = 0; together < 20 && seconds() < 30;) {
        await new Promise(requestAnimationFrame);
        const sound = sounds.at(-1), apart = Math.abs(sound.currentTime - player.currentTime);
        together = !sound.paused && !sound.seeking && apart <= 0.04 ? together + 1 : 0;
    }
    results.element.together_s = seconds();
    player.pause();
    results.element.isSilent = sounds.at(-1).paused;
}

// A list of streams: the next one is opened where one ends, and begins at the time that was set before it was there.
async function playOn(player) {
    const next = event(player, 'ended').then(() => {
        player.src = '/slow.nvs';
        player.currentTime = 2;
        return player.play();
    });
    player.currentTime = 0.9 * player.duration;
    await player.play();
    await next;  // it plays
    results.playedOn = !player.paused && !player.error && player.currentTime >= 2;
    player.pause();
    const ended = player.play();
    player.pause();
    results.playRejects = await ended.then(() => false, error => error.name === 'AbortError');
}

// What is said on the console of each of these budgets, which the player has then.
async function warningsOf(player, budgets) {
    const warn = console.warn, said = [];
    for (const budget of budgets) {
        const lines = [], loaded = event(player, 'loadeddata');
        console.warn = line => lines.push(line);
        player.budget = budget;
        await loaded;
        said.push({lines, leaves: player.budget});
    }
    console.warn = warn;
    return said;
}

// What play() does when a player is disposed of: before, and after that.
async function playDisposed(player) {
    const nameOf = promise => Promise.race([promise.then(() => 'it plays', error => error.name), later(10000).then(() => 'nothing')]);
    player.src = '/stream.nvs';
    const pending = nameOf(player.play());
    player.dispose();
    const names = [await pending, await nameOf(player.play())];
    const loaded = event(player, 'loadeddata');
    player.src = '/stream.nvs';
    names.push(await nameOf(player.play()));
    await loaded;
    player.dispose();
    return names;
}

async function useElement(stream) {
    const sounds = [], NativeAudio = Audio;
    window.Audio = function () {
        sounds.push(new NativeAudio());
        return sounds.at(-1);
    };

    await import('/neuvv-player.js');
    const player = document.createElement('neuvv-player');
    player.loop = true;
    document.body.append(player);
    const begin = performance.now(), loaded = event(player, 'loadeddata');
    player.addEventListener('loadeddata', () => {
        results.first_ms = performance.now() - begin;
        results.first_bytes = performance.getEntriesByType('resource').reduce(
            (sum, one) => sum + (one.startTime >= begin && one.name.endsWith(stream) ? one.encodedBodySize : 0), 0);
    }, {once: true});
    player.src = stream;
    await loaded;
    const whole = player.duration;
    player.step(1);
    await event(player, 'seeked');
    const stepped = player.currentTime;
    const playing = event(player, 'playing');
    await player.play();
    await playing;
    await until(() => player.currentTime < stepped);  // it loops
    player.loop = false;
    const ended = event(player, 'ended');
    player.play();
    await ended;
    const atEnd = player.ended && player.paused && player.currentTime > 0.9 * whole;
    player.currentTime = 0;
    await event(player, 'seeked');
    await playOn(player);
    const reopened = event(player, 'loadeddata');
    player.src = stream;
    await reopened;
    const problem = async url => {
        const failed = event(player, 'error');
        player.src = url;
        return (await failed).message;
    };
    results.element = {duration: whole, stepped, atEnd, problems: {}};
    const fetched_s = () => player.buffered.length === 1 ? player.buffered.end(0) - player.buffered.start(0) : 0;
    for (const since = performance.now(); fetched_s() < whole && performance.now() < since + 10000;) await later(20);
    results.element.fetched_s = fetched_s();
    player.loop = true;
    await hear(player, sounds);
    player.loop = false;
    for (const url of ['/missing.nvs', '/empty.nvs', '/page.nvs', '/damaged.nvs', '/elsewhere.nvs', '/short.nvs', '/whole/stream.nvs'])
        results.element.problems[url] = await problem(url);
    const again = event(player, 'loadeddata');
    player.src = stream;
    await again;
    player.currentTime = 0.6 * whole;
    await event(player, 'seeked');
    const fewer = event(player, 'loadeddata');
    player.budget = 1;
    await fewer;
    results.element.budget = {leaves: player.budget, time: player.currentTime / whole, isPaused: player.paused};
    results.warnings = await warningsOf(player, ['abc', ' ', -1, NaN, 0.5, 0, 1000.5, null]);
    results.element.recovers = player.shadowRoot.querySelector('.problem').textContent === '';
    const parent = player.parentNode;
    player.remove();
    await until(() => player.readyState === 0);  // it has let go of all
    const back = event(player, 'loadeddata');
    parent.append(player);
    await back;
    results.disposed = await playDisposed(player);
}

try {
    const plan = await (await fetch('/views/views.json')).json();
    await compareViews(plan);
    await useElement(plan.stream);
    results.controls = await useControls(plan.stream);
} catch (error) {
    results.problem = `${error.message}\n${error.stack}`;
}
await fetch('/results', {method: 'POST', body: JSON.stringify(results)});
