// The player in a headset that IWER (npm) simulates: each eye against what NeuVV renders from there; hands that move it.
import {pixels as imagePixels, psnr} from './images.js';
import {XRDevice, metaQuest3} from '/modules/iwer/build/iwer.module.min.js';

const results = {eyes: []};
const kEncode = linear => linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
const kDecode = srgb => srgb <= 0.04045 ? srgb / 12.92 : ((srgb + 0.055) / 1.055) ** 2.4;

const event = (target, name) => new Promise(resolve => target.addEventListener(name, resolve, {once: true}));

// What `draw` returns, which is called with the next image's frame after the player has drawn it.
const inFrame = (session, draw) => new Promise(resolve => session.requestAnimationFrame((_, frame) => resolve(draw(frame))));
async function frames(session, count) {
    for (let i = 0; i < count; ++i) await inFrame(session, () => {});
}

// The part of the canvas that an eye sees, from the top, over black: sRGB, as images.js has pixels.
function pixelsOf(gl, {x, y, width, height}) {
    const read = new Uint8Array(4 * width * height), result = [];
    gl.readPixels(x, y, width, height, gl.RGBA, gl.UNSIGNED_BYTE, read);
    for (let row = height - 1; row >= 0; --row)
        for (let at = 4 * row * width; at < 4 * (row + 1) * width; at += 4) {
            const alpha = read[at + 3] / 255;  // light that is premultiplied after it was encoded
            for (let i = 0; i < 3; ++i) result.push(alpha > 0 ? 255 * kEncode(alpha * kDecode(read[at + i] / 255 / alpha)) : 0);
            result.push(255);
        }
    return result;
}

async function imageOf(url, body) {
    const answer = await fetch(url, {method: 'POST', body: JSON.stringify(body)});
    if (!answer.ok) throw new Error(await answer.text());
    const bitmap = await createImageBitmap(await answer.blob());
    return imagePixels(bitmap, bitmap.width, bitmap.height);
}

// The camera of an eye in the stream's coordinates, as a transforms.json has it. The performer stands 2 m ahead.
function cameraOf(view, {width, height}, {min, max}) {
    const p = view.projectionMatrix, m = view.transform.matrix, foot = [(min[0] + max[0]) / 2, min[1], (min[2] + max[2]) / 2];
    const shift = [foot[0], foot[1], foot[2] + 2];
    return {w: width, h: height, fl_x: p[0] * width / 2, fl_y: p[5] * height / 2, cx: (1 - p[8]) * width / 2, cy: (1 + p[9]) * height / 2,
            frames: [{transform_matrix: [0, 1, 2].map(row => [m[row], m[4 + row], m[8 + row], m[12 + row] + shift[row]]).concat([[0, 0, 0, 1]])}]};
}

async function compareEyes(player, session, gl) {
    const space = await session.requestReferenceSpace('local-floor'), layer = session.renderState.baseLayer;
    const seen = await inFrame(session, frame => {
        results.eyes_png = gl.canvas.toDataURL('image/png');
        return frame.getViewerPose(space).views.map(view => {
            const viewport = layer.getViewport(view), {x, y, width, height} = viewport;
            return {eye: view.eye, camera: cameraOf(view, viewport, player.box), pixels: pixelsOf(gl, {x, y, width, height})};
        });
    });
    for (const {eye, camera, pixels} of seen)
        results.eyes.push({eye, psnr_db: psnr(pixels, await imageOf('/render', {camera, frame: 0, background: 'black', name: `eye_${eye}`}))});
    results.swapped_db = psnr(seen[0].pixels, seen[1].pixels);  // of the two eyes, which see different things
}

// A squeeze moves the performer with the hand; a short press of the trigger plays.
async function useHands(player, session, device, gl) {
    const right = device.controllers.right, {min, max} = player.box, middle = (max[1] - min[1]) / 2;
    right.connected = true;
    right.position.set(0, middle, -0.3);
    right.quaternion.set(0, 0, 0, 1);  // towards the performer
    await frames(session, 3);
    const shownImage = () => inFrame(session, () => pixelsOf(gl, {x: 0, y: 0, width: gl.drawingBufferWidth / 2, height: gl.drawingBufferHeight}));
    const before = await shownImage();
    right.updateButtonValue('squeeze', 1);
    await frames(session, 3);
    right.position.set(0.2, middle, -0.6);
    await frames(session, 3);
    right.updateButtonValue('squeeze', 0);
    await frames(session, 3);
    results.moved_db = psnr(before, await shownImage());
    const began = event(player, 'play');
    right.updateButtonValue('trigger', 1);
    await frames(session, 2);
    right.updateButtonValue('trigger', 0);
    await began;
    results.plays = !player.paused;
}

async function run() {
    const device = new XRDevice(metaQuest3, {stereoEnabled: true});
    device.installRuntime({forceInstall: true});
    device.stereoEnabled = true;
    device.position.set(0.1, 1.4, 0.1);
    for (const hand of Object.values(device.controllers)) hand.connected = false;  // their rays would be in the image
    let session = null;
    const requested = navigator.xr.requestSession.bind(navigator.xr);
    navigator.xr.requestSession = async (...words) => session = await requested(...words);
    await import('/neuvv-player.js');
    const player = document.createElement('neuvv-player');
    document.body.append(player);
    const loaded = event(player, 'loadeddata');
    player.src = '/stream.nvs';
    await loaded;
    const leave = async () => {
        const left = event(player, 'leavexr');
        await session.end();
        await left;
    };
    const gl = player.shadowRoot.querySelector('canvas').getContext('webgl2');
    await player.enterXR('immersive-ar');
    await frames(session, 60);  // the whole frame has come
    await compareEyes(player, session, gl);
    await useHands(player, session, device, gl);
    await leave();
    await player.enterXR();
    await frames(session, 3);
    results.room_png = await inFrame(session, () => gl.canvas.toDataURL('image/png'));
    await leave();
    player.pause();
    player.step(1);  // the page draws again
    await event(player, 'seeked');
    results.refused = await player.enterXR('inline').then(() => '', error => error.message);
    const entering = player.enterXR();
    player.dispose();
    results.disposed = await entering.then(() => '', error => error.message);
}

try {
    await run();
} catch (error) {
    results.problem = `${error.message}\n${error.stack}`;
}
await fetch('/results', {method: 'POST', body: JSON.stringify(results)});
