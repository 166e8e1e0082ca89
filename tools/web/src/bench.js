// bench.html?src=show.nvs measures how fast a browser decodes and draws a stream, wherever it is opened.
import {FrameReader} from './frames.js';
import {loadedWalk} from './loaded.js';
import {Orbit} from './orbit.js';
import {Renderer} from './renderer.js';

const kFrames = 12, kImages = 24;  // that are decoded; that are drawn of each size
const kSizes = [[640, 360], [1280, 720], [1680, 1760]];  // the last: about that of an eye of a standalone headset
const kTurn = 2 * Math.PI / kImages;

const src = new URLSearchParams(location.search).get('src') ?? 'show.nvs';
const rows = document.querySelector('tbody'), state = document.querySelector('#state'), canvas = document.querySelector('canvas');
document.querySelector('#stream').textContent = src;

function tell(name, value) {
    const row = rows.insertRow();
    row.insertCell().textContent = name;
    row.insertCell().textContent = value;
}
const middle = values => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];
const ms = values => `${middle(values).toFixed(1)} ms`;

// Milliseconds of each image of a turn around the box, with what it has to wait for.
function imagesOf(renderer, box, [width, height]) {
    const gl = renderer.gl, times = [];
    Object.assign(canvas, {width, height});
    gl.viewport(0, 0, width, height);
    const orbit = new Orbit(() => {});
    for (let i = 0; i < kImages; ++i) {
        orbit.turn(kTurn, 0);
        const begin = performance.now(), {eye, clipFromTree} = orbit.camera(box, width / height);
        renderer.clear();
        renderer.draw(eye, clipFromTree);
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
        if (i > 0) times.push(performance.now() - begin);  // the first one compiles
    }
    return times;
}

async function measure() {
    const renderer = new Renderer(canvas, await loadedWalk()), gl = renderer.gl;
    tell('browser', navigator.userAgent);
    tell('renderer', gl.getParameter(gl.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER));
    const opened = performance.now(), reader = await FrameReader.open(new URL(src, document.baseURI));
    tell('the head of the stream', `${(performance.now() - opened).toFixed(0)} ms`);
    const decoded = [], uploaded = [];
    for (let frame = 0; frame < Math.min(kFrames, reader.frames.length); ++frame) {
        const begin = performance.now(), tree = await reader.tree(frame), there = performance.now();
        renderer.show(tree);
        decoded.push(there - begin);
        uploaded.push(performance.now() - there);
    }
    tell('a frame, fetched and decoded, one after the other', ms(decoded));
    tell('its upload', ms(uploaded));
    for (const size of kSizes) {
        await new Promise(requestAnimationFrame);
        tell(`an image of ${size.join('×')}`, ms(imagesOf(renderer, reader.box, size)));
    }
    reader.end();
    renderer.end();
}

try {
    await measure();
    state.textContent = 'Done. All are medians.';
} catch (error) {
    state.textContent = `${src}: ${error.message}`;
}
