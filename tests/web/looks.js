// What is seen of the player and of the page of stages, in screenshots: shapes and places, not fonts.
import {pixels} from './images.js';
import '/neuvv-player.js';

const kOutside = [0, 160, 0], kInside = [0x18, 0x18, 0x18], kMargin = 20;  // colours of the page and of the player; pixels
const kNear = 6, kOff = 2;         // of colours; pixels
const kLight = 225;                // what is white is above
const kLeastLine = 40, kThumb = 14;  // pixels

const results = {wrong: []};
let what = '';
const expect = (condition, text) => condition || results.wrong.push(`${what}: ${text}`);
const later = milliseconds => new Promise(resolve => setTimeout(resolve, milliseconds));
const post = (name, words) => fetch(name, {method: 'POST', body: JSON.stringify(words)});
const event = (target, name) => new Promise(resolve => target.addEventListener(name, resolve, {once: true}));
async function until(done, text) {
    for (const begin = performance.now(); !done(); await later(20))
        if (performance.now() - begin > 20000) throw new Error(`${what}: ${text} does not come`);
}

/** A screenshot of the page. */
class Shot {
    static async of(name) {
        for (let i = 0; i < 3; ++i) await new Promise(requestAnimationFrame);
        const bitmap = await createImageBitmap(await (await post('/screenshot', {name})).blob()), shot = new Shot();
        return Object.assign(shot, {width: bitmap.width, height: bitmap.height, data: await pixels(bitmap, bitmap.width, bitmap.height)});
    }
    colour(x, y) { return [0, 1, 2].map(part => this.data[4 * (y * this.width + x) + part]); }
    isLight(x, y) { return this.colour(x, y).every(part => part > kLight); }
    is(colour) { return (x, y) => this.colour(x, y).every((part, i) => Math.abs(part - colour[i]) <= kNear); }
    /** How many pixels outside of a rectangle have another colour than the page. */
    paintedOutside({left, top, right, bottom}) {
        const isPage = this.is(kOutside);
        return this.where((x, y) => (x < left || x >= right || y < top || y >= bottom) && !isPage(x, y)).length;
    }
    /** The pixels in a rectangle of the page of which something is true, as [x, y]. */
    where(is, {left = 0, top = 0, right = this.width, bottom = this.height} = {}) {
        const found = [];
        for (let y = Math.round(top); y < Math.round(bottom); ++y)
            for (let x = Math.round(left); x < Math.round(right); ++x)
                if (is(x, y)) found.push([x, y]);
        return found;
    }
}
const boxOf = places => {
    const of = axis => places.reduce(([low, high], place) => [Math.min(low, place[axis]), Math.max(high, place[axis] + 1)], [Infinity, -Infinity]);
    const [[left, right], [top, bottom]] = [of(0), of(1)];
    return {left, right, top, bottom};
};
const isWithin = (inner, outer) =>
    inner.left >= outer.left && inner.right <= outer.right && inner.top >= outer.top && inner.bottom <= outer.bottom;
const rectOf = element => element.getBoundingClientRect();
const isSeen = element => getComputedStyle(element).display !== 'none';

// All that is in a bar is inside it, one beside the other.
function expectBar(root) {
    const bar = rectOf(root.querySelector('.bar')), parts = [...root.querySelectorAll('.bar > *')].filter(isSeen).map(rectOf);
    expect(parts.every(part => isWithin(part, bar)), 'something is outside of the bar');
    expect(parts.every((part, i) => i === 0 || part.left >= parts[i - 1].right), 'something in the bar covers another');
    expect(rectOf(root.querySelector('.bar .line')).width >= kLeastLine, 'the time line is too short');
    return bar;
}
// A triangle, or two bars, in the middle of its button.
function expectPlayShape(shot, root, isPaused) {
    const button = rectOf(root.querySelector('.bar button')), light = shot.where((x, y) => shot.isLight(x, y), button), box = boxOf(light);
    const off = Math.max(...[['left', 'right'], ['top', 'bottom']].map(([low, high]) => Math.abs(box[low] + box[high] - button[low] - button[high]) / 2));
    expect(off <= kOff, `the play button's shape is ${off} pixels off the middle`);
    const middle = (box.left + box.right) / 2, left = light.filter(([x]) => x + 0.5 < middle).length, right = light.filter(([x]) => x + 0.5 > middle).length;
    expect(light.length > 20 && (isPaused ? left > 1.5 * right : Math.abs(left - right) < 0.2 * left),
           `the play button, ${isPaused ? 'paused' : 'playing'}, has ${left} light pixels at the left, ${right} at the right`);
}
// White up to the time, where the thumb is.
function expectTimeLine(shot, root, fraction) {
    const line = rectOf(root.querySelector('.bar .line')), y = Math.round((line.top + line.bottom) / 2);
    const lightAt = row => boxOf(shot.where((x, at) => shot.isLight(x, at), {...line.toJSON(), top: row, bottom: row + 1}));
    const thumb = line.left + kThumb / 2 + fraction * (line.width - kThumb), edge = lightAt(y - 5), played = lightAt(y);
    const isAt = (found, place) => Math.abs(found - place) <= kOff;
    expect(isAt((edge.left + edge.right) / 2, thumb), `the thumb at ${fraction} is at ${edge.left} to ${edge.right}, not ${thumb}`);
    expect(isAt(played.left, fraction > 0 ? line.left + kThumb / 2 : line.left) && isAt(played.right, thumb + kThumb / 2),
           `at ${fraction}, ${played.left} to ${played.right} are white, of the line from ${line.left} to ${line.right}`);
}
// Light letters in a dark box, which is inside of what it belongs to.
function expectMessage(shot, root, outer) {
    const message = root.querySelector('.problem'), box = rectOf(message), light = shot.where((x, y) => shot.isLight(x, y), box);
    expect(isSeen(message) && isWithin(box, outer) && message.scrollWidth <= message.clientWidth, 'the message is not inside');
    const dark = shot.where((x, y) => shot.colour(x, y).every(part => part < 50), box).length, all = Math.round(box.width) * Math.round(box.height);
    expect(light.length > 50 && dark > 0.6 * all, `the message has ${light.length} light and ${dark} dark pixels of ${all}`);
    expect(isWithin(boxOf(light), box), 'the letters are outside of their box');
}

async function seek(player, fraction) {
    const seeked = event(player, 'seeked');
    player.currentTime = fraction * player.duration;
    await seeked;
}

async function lookAtPlayer(width) {
    what = `${width} pixels`;
    await post('/size', {width: width + 2 * kMargin, height: width + 2 * kMargin});
    const player = document.createElement('neuvv-player'), root = player.shadowRoot;
    Object.assign(player, {controls: true, loop: true, src: '/stream.nvs'}).style.width = `${width}px`;
    document.body.append(player);
    const heard = new Promise(resolve => player.addEventListener('volumechange', resolve, {once: true}));
    await Promise.all([event(player, 'loadeddata'), heard]);
    const name = text => `player_${width}_${text}`, all = rectOf(player);
    for (const fraction of [0, 0.25, 0.7]) {
        await seek(player, fraction);
        expectTimeLine(await Shot.of(name(fraction)), root, fraction);
    }
    let shot = await Shot.of(name('paused'));
    const bar = expectBar(root), picture = {...all.toJSON(), bottom: bar.top}, isInside = shot.is(kInside);
    expect(shot.paintedOutside(all) === 0, 'something is painted outside');
    const performer = boxOf(shot.where((x, y) => !isInside(x, y), picture)), margins = [performer.left - all.left, all.right - performer.right,
                                                                                     performer.top - all.top, bar.top - performer.bottom];
    expect(Math.min(...margins) >= 2 && Math.max(...margins) < 0.6 * width, `the performer has the margins ${margins}`);
    expect(shot.where(isInside, bar).length < 0.02 * bar.width * bar.height, 'the bar does not differ from the background');
    expectPlayShape(shot, root, true);
    await player.play();
    expectPlayShape(await Shot.of(name('playing')), root, false);
    player.pause();
    player.controls = false;
    shot = await Shot.of(name('bare'));
    const below = shot.where((x, y) => !shot.is(kInside)(x, y), {...bar.toJSON(), top: bar.bottom - 10});
    expect(below.length === 0, 'the bar stays');
    player.controls = true;
    expectBar(root);
    const failed = event(player, 'error');
    player.src = '/a-name-that-is-so-long-that-it-is-not-to-be-shown-in-one-line-of-any-message.nvs';
    await failed;
    shot = await Shot.of(name('missing'));
    expectMessage(shot, root, picture);
    expect(shot.paintedOutside(all) === 0, 'a message is painted outside');
    player.remove();
}

async function lookAtStage() {
    Object.assign(document.body.style, {margin: '', background: ''});
    document.head.append(Object.assign(document.createElement('link'), {rel: 'stylesheet', href: '/stage.css'}));
    await import('/stage.js');
    what = 'the stage';
    await until(() => document.querySelector('.bar .clock')?.textContent.includes('/') && document.querySelector('.problem').textContent, 'the stage');
    for (const [width, height] of [[480, 360], [240, 240]]) {
        what = `the stage, ${width} pixels`;
        await post('/size', {width, height});
        const {value} = document.querySelector('.line input');
        await until(() => document.querySelector('.line input').value !== value, 'the next frame');
        const shot = await Shot.of(`stage_${width}`), bar = expectBar(document), all = {left: 0, top: 0, right: width, bottom: height};
        expect(shot.width === width && bar.left === 0 && bar.right === width && bar.bottom === height, 'the bar is not at the bottom');
        expectPlayShape(shot, document, false);
        expectMessage(shot, document, {...all, bottom: bar.top});
        const colours = new Set(shot.where(() => true, {...all, bottom: bar.top}).map(([x, y]) => shot.colour(x, y).map(part => part >> 4).join()));
        expect(colours.size > 20, `the picture has ${colours.size} colours`);
    }
}

try {
    Object.assign(document.body.style, {margin: `${kMargin}px`, background: `rgb(${kOutside})`, overflow: 'hidden'});
    for (const width of [480, 240]) await lookAtPlayer(width);
    if (new URLSearchParams(location.search).get('src') !== '/views/') await lookAtStage();
} catch (error) {
    results.problem = `${what}: ${error.message}\n${error.stack}`;
}
await post('/results', results);
