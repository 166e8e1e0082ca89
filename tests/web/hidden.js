// A player that is hidden while it plays, and shown again.

const kHidden_s = 3, kSleep_s = 3, kQuiet_s = 1, kMostWork_s = 5;
const kMostOff_s = 0.4;  // of the time, after it is shown again

const results = {wrong: [], counts: {}};
const expect = (condition, text) => condition || results.wrong.push(text);
const later = seconds => new Promise(resolve => setTimeout(resolve, 1000 * seconds));
const post = (name, words = {}) => fetch(name, {method: 'POST', body: JSON.stringify(words)});
const event = (target, name) => new Promise(resolve => target.addEventListener(name, resolve, {once: true}));

// What is asked of the server and of the workers, and what is drawn.
const counts = {requests: 0, decoded: 0, shown: 0}, sounds = [];
const count = (owner, name, what) => {
    const native = owner[name];
    owner[name] = function (...words) {
        counts[what] += 1;
        return native.apply(this, words);
    };
};
const fetchOfBrowser = fetch;
window.fetch = (url, options) => {
    counts.requests += String(url).endsWith('.nvs');
    return fetchOfBrowser(url, options);
};
count(Worker.prototype, 'postMessage', 'decoded');
count(WebGL2RenderingContext.prototype, 'texStorage2D', 'shown');
const NativeAudio = Audio;
window.Audio = function () {
    sounds.push(new NativeAudio());
    return sounds.at(-1);
};
const {NeuvvPlayer} = await import('/neuvv-player.js');

let hiddenAt;  // the player's time
const kTextures = 3;  // of a frame
const since = before => Object.fromEntries(Object.entries(counts).map(([name, value]) => [name, value - before[name]]));

async function whileVisible(seconds) {
    const before = {...counts};
    await later(seconds);
    const {shown, ...others} = since(before);
    return {...others, frames: shown / kTextures / seconds};  // a second
}

// What was asked for before comes to its end.
async function quiet() {
    for (const begin = performance.now(); performance.now() - begin < 1000 * kMostWork_s;) {
        const before = counts.requests + counts.decoded;
        await later(kQuiet_s);
        if (counts.requests + counts.decoded === before) return;
    }
}

// While it is hidden, the time stands still, with its sound, and nothing is fetched or decoded in the end.
async function hide(player) {
    await post('/hide');
    expect(document.hidden, 'the page is not hidden');
    await quiet();
    const before = {...counts}, [sound] = sounds, heard = sound.currentTime;
    await later(kHidden_s);
    results.counts.hidden = since(before);
    expect(Object.values(results.counts.hidden).every(value => value === 0), 'a hidden player works');
    expect(sound.paused && sound.currentTime === heard, 'a hidden player sounds');
    expect(!player.paused && player.currentTime === hiddenAt, 'the time of a hidden player goes on');
}

// It goes on where it was within a second, in time, at the frames a second that it had.
async function goesOn(player, name, usual) {
    const times = [], begin = performance.now(), waits = [];
    player.addEventListener('timeupdate', () => times.push(player.currentTime));
    player.addEventListener('waiting', () => waits.push(player.currentTime));
    const first = await whileVisible(1), passed = (performance.now() - begin) / 1000;
    const ahead = player.currentTime - hiddenAt, then = await whileVisible(2);
    results.counts[name] = {first, then, ahead};
    expect(!document.hidden && !player.paused && !player.error, `${name}: it does not play`);
    expect(times.every((one, i) => i === 0 || one >= times[i - 1]) && times[0] - hiddenAt < kMostOff_s, `${name}: it goes on at ${times[0]} after ${hiddenAt}`);
    expect(Math.abs(ahead - passed) < kMostOff_s, `${name}: after ${passed} s it is ${ahead} s later`);
    expect(first.frames <= 1.3 * player.frameRate, `${name}: there is a burst of ${first.frames} frames`);
    expect(then.frames >= 0.5 * usual.frames, `${name}: it shows ${then.frames} frames a second, not ${usual.frames}`);
    const [sound] = sounds;
    expect(!sound.paused && Math.abs(sound.currentTime - player.currentTime) < kMostOff_s, `${name}: sound and frames are apart`);
    expect(waits.length === 0, `${name}: it waits at ${waits}`);
}

try {
    const player = Object.assign(new NeuvvPlayer(), {loop: true});
    player.style.width = '160px';
    document.body.append(player);
    document.addEventListener('visibilitychange', () => document.hidden && (hiddenAt = player.currentTime));
    player.src = '/stream.nvs';
    await player.play();
    await later(1);
    const usual = results.counts.usual = await whileVisible(2);
    await hide(player);
    await post('/show');
    await goesOn(player, 'shown again', usual);
    await post('/sleep', {seconds: kSleep_s});
    await goesOn(player, 'awake again', usual);
    player.dispose();
} catch (error) {
    results.problem = `${error.message}\n${error.stack}`;
}
await post('/results', results);
