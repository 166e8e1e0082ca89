// Loops a stream for ?minutes=N, and counts every ten seconds the bytes of the heap and the textures.
import {NeuvvPlayer} from '/neuvv-player.js';

const kPause_s = 10;
const minutes = Number(new URLSearchParams(location.search).get('minutes')), results = {counts: []};

let textures = 0;
for (const [name, change] of [['createTexture', 1], ['deleteTexture', -1]]) {
    const native = WebGL2RenderingContext.prototype[name];
    WebGL2RenderingContext.prototype[name] = function (...words) {
        textures += change;
        return native.apply(this, words);
    };
}

try {
    const player = new NeuvvPlayer();
    let frames = 0;
    player.addEventListener('timeupdate', () => ++frames);
    Object.assign(player, {loop: true, autoplay: true, src: '/stream.nvs'});
    document.body.append(player);
    player.addEventListener('error', event => results.problem = event.message);
    for (let i = 0; i < 60 * minutes / kPause_s && !results.problem; ++i) {
        await new Promise(resolve => setTimeout(resolve, 1000 * kPause_s));
        gc();
        results.counts.push({heap: performance.memory.usedJSHeapSize, textures, frames});
    }
} catch (error) {
    results.problem = `${error.message}\n${error.stack}`;
}
await fetch('/results', {method: 'POST', body: JSON.stringify(results)});
