// Loops a stream for ?minutes=N, and counts what it holds every ten seconds, each time where it stands at the same frame.
import '/memories.js';
import {NeuvvPlayer} from '/neuvv-player.js';

const kPlay_s = 10, kSettled_s = 2, kAt_s = 0.2;  // the frame's time
const minutes = Number(new URLSearchParams(location.search).get('minutes')), results = {};
const later = seconds => new Promise(resolve => setTimeout(resolve, 1000 * seconds));

let textures = 0;
for (const [name, change] of [['createTexture', 1], ['deleteTexture', -1]]) {
    const native = WebGL2RenderingContext.prototype[name];
    WebGL2RenderingContext.prototype[name] = function (...words) {
        textures += change;
        return native.apply(this, words);
    };
}
let asked = 0;  // of the workers
const {postMessage} = Worker.prototype;
Worker.prototype.postMessage = function (...words) {
    ++asked;
    return postMessage.apply(this, words);
};

// Until it has the frames that it wants there, with all of their parts, and nothing is on its way.
async function standStill(player) {
    player.pause();
    player.currentTime = kAt_s;
    for (let before = -1; before !== asked || player.readyState < 4; await later(kSettled_s)) before = asked;
}

try {
    const player = new NeuvvPlayer();
    let frames = 0;
    player.addEventListener('timeupdate', () => ++frames);
    Object.assign(player, {loop: true, src: '/stream.nvs'});
    player.style.width = '120px';  // which is drawn quickly without a GPU
    document.body.append(player);
    player.addEventListener('error', event => results.problem = event.message);
    const begin = performance.now();
    while (performance.now() - begin < 60000 * minutes && !results.problem) {
        await player.play();
        await later(kPlay_s);
        await standStill(player);
        await fetch('/count', {method: 'POST', body: JSON.stringify({textures, frames, seconds: (performance.now() - begin) / 1000})});
    }
} catch (error) {
    results.problem = `${error.message}\n${error.stack}`;
}
await fetch('/results', {method: 'POST', body: JSON.stringify(results)});
