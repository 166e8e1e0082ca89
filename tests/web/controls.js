// Uses a player as people do, by its bar, keys, pointers and attributes. Returns what was wrong, in lines.
import {pixels, psnr} from './images.js';

const kOther_db = 30;  // between images that differ

const event = (target, name) => new Promise(resolve => target.addEventListener(name, resolve, {once: true}));

// What it shows some images later.
async function shownImage(player) {
    for (let i = 0; i < 4; ++i) await new Promise(requestAnimationFrame);
    const bitmap = await createImageBitmap(player.shadowRoot.querySelector('canvas'), {resizeWidth: 160, resizeHeight: 120});
    return pixels(bitmap, 160, 120);  // of one size, however many rays it has
}

// Which of the actions, {name: function}, leave the image as it is.
async function withoutEffect(player, actions) {
    const names = [];
    let before = await shownImage(player);
    for (const [name, act] of Object.entries(actions)) {
        act();
        const after = await shownImage(player);
        if (psnr(before, after) > kOther_db) names.push(name);
        before = after;
    }
    return names;
}

// Whether the same is shown again within five seconds, after the browser has lost its graphics.
async function comesBack(player, canvas) {
    const before = await shownImage(player), losing = canvas.getContext('webgl2').getExtension('WEBGL_lose_context');
    const restored = event(canvas, 'webglcontextrestored'), begin = performance.now();
    losing.loseContext();
    await new Promise(resolve => setTimeout(resolve, 100));  // the page hears of it
    losing.restoreContext();
    await restored;
    while (performance.now() - begin < 5000)
        if (psnr(before, await shownImage(player)) > kOther_db) return true;
    return false;
}

export async function useControls(stream) {
    const wrong = [], expect = (condition, text) => condition || wrong.push(text);
    const getContext = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, options) {  // so that what was drawn can be read later
        return getContext.call(this, kind, {...options, preserveDrawingBuffer: true});
    };
    const player = document.createElement('neuvv-player'), root = player.shadowRoot, loaded = event(player, 'loadeddata');
    Object.assign(player.style, {width: '320px', height: '240px'});
    player.setAttribute('controls', '');
    player.setAttribute('muted', '');
    player.poster = '/views/view_0.png';
    document.body.append(player);
    const shows = selector => getComputedStyle(root.querySelector(selector)).display !== 'none';
    expect(shows('.poster'), 'the poster is not shown');
    player.src = stream;
    await loaded;
    expect(!shows('.poster'), 'the poster stays');
    expect(shows('.bar') && player.muted, 'attributes are not taken');
    const buttons = [...root.querySelectorAll('.bar button')].filter(button => !button.hidden);
    expect(buttons.every(button => button.getAttribute('aria-label') && button.offsetWidth >= 24 && button.offsetHeight >= 24),
           'a button has no name, or is too small');
    const [play] = buttons, canvas = root.querySelector('canvas'), line = root.querySelector('.line input');
    const began = event(player, 'play');
    play.click();
    await began;
    expect(play.getAttribute('aria-label') === 'pause' && !player.paused, 'the button does not play');
    play.click();
    expect(play.getAttribute('aria-label') === 'play' && player.paused, 'the button does not pause');
    line.value = 0.6 * player.duration;
    line.dispatchEvent(new Event('input'));
    expect(Math.abs(player.currentTime - 0.6 * player.duration) < 1e-3, 'the time line does not seek');
    await event(player, 'seeked');
    for (let i = 0; i < 60 && !root.querySelector('.line span'); ++i) await new Promise(requestAnimationFrame);
    expect(root.querySelector('.line span'), 'the time line does not show what was fetched');
    const key = name => () => canvas.dispatchEvent(new KeyboardEvent('keydown', {key: name, cancelable: true}));
    const pointer = (type, id, x, y, more = {}) => canvas.dispatchEvent(new PointerEvent(type, {pointerId: id, clientX: x, clientY: y, ...more}));
    canvas.setPointerCapture = () => {};  // of pointers that are not there
    const drag = more => () => {
        pointer('pointerdown', 1, 100, 100, more);
        pointer('pointermove', 1, 160, 120, more);
        pointer('pointerup', 1, 160, 120, more);
    };
    const pinch = () => {
        pointer('pointerdown', 1, 100, 100);
        pointer('pointerdown', 2, 120, 100);
        pointer('pointermove', 2, 150, 100);
        pointer('pointerup', 1, 100, 100);
        pointer('pointerup', 2, 150, 100);
    };
    canvas.focus();
    const wheel = () => canvas.dispatchEvent(new WheelEvent('wheel', {deltaY: 300, cancelable: true}));
    const still = await withoutEffect(player, {ArrowLeft: key('ArrowLeft'), ArrowUp: key('ArrowUp'), '+': key('+'), drag: drag({}),
                                               shift: drag({shiftKey: true}), pinch, wheel, Home: key('Home')});
    expect(still.length === 0, `without an effect: ${still}`);
    expect((await withoutEffect(player, {nothing: () => {}})).length === 1, 'images differ where nothing is done');
    const before = player.currentTime;
    key(',')();
    expect(player.currentTime < before, 'a key does not step');
    expect(await comesBack(player, canvas), 'a lost context does not come back as it was');
    player.remove();
    return wrong;
}
