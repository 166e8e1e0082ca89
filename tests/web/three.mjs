// Performers in scenes of three.js, in Debian's Chromium, against `neuvv render`; stages and their time maps.
//   node tests/web/three.mjs NEUVV BUILT STREAM [FOLDER]
// BUILT: what tools/web/build made, with three.js. FOLDER: where images are left. Exits with 1 where something is wrong.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {resultsOf} from './browser.mjs';
import {folderWith, programWith} from './modules.mjs';

const kSize = [320, 240];
// `ring`: NeuVV shades each leaf of a stage's copies once, for the ray to its middle, and its shadows are softer.
const kLeast_db = {turned: 45, stretched: 45, canvas: 45, eyes: 45, parallel: 35, lit: 30, ring: 25};
const [neuvv, built, stream, given] = process.argv.slice(2);
folderWith('three');
const folder = given ?? fs.mkdtempSync(path.join(os.tmpdir(), 'neuvv-three-'));
fs.mkdirSync(folder, {recursive: true});
const here = path.dirname(fileURLToPath(import.meta.url));
const {inverse, lookAt, multiply, placement} = await import(path.resolve(built, 'matrices.js'));
const run = words => execFileSync(neuvv, words, {encoding: 'utf8', cwd: folder, stdio: ['ignore', 'pipe', 'ignore']});
const render = (stage, image, ...words) =>
    run(['render', stage, '-o', image, '--camera', 'camera', '--size', kSize.join('x'), '--samples', '1', '--far-levels', 'off', '--time', '0',
         '--overwrite', ...words]);

// One performer alone, turned and stretched; again, lit by a spot, half transparent.
function makeLoneStages() {
    run(['stage', 'new', 'lone.gltf', '--overwrite']);
    run(['stage', 'remove', 'lone.gltf', 'floor']);
    run(['stage', 'set', 'lone.gltf', '--background', 'white', '--ambient', '1,1,1']);
    run(['stage', 'add', 'lone.gltf', 'stream.nvs', '--name', 'anna', '--turn', '20,30,10', '--scale', '1.2,0.8,1']);
    run(['stage', 'camera', 'lone.gltf', 'camera', '--at', '1.7,1.2,2.5', '--aim', '0.8,0.3,0.3']);
    run(['stage', 'light', 'lone.gltf', 'key', '--at', '1.5,2,2', '--aim', '0.8,0.3,0.3', '--cone', '8,14', '--intensity', '20', '-o',
         'lit.gltf', '--overwrite']);
    run(['stage', 'set', 'lit.gltf', 'anna', '--clip', 'plain.nvs']);
    run(['stage', 'set', 'lit.gltf', '--background', 'black', '--ambient', '0.1,0.2,0.3', '--shadows', 'off']);
    run(['stage', 'set', 'lit.gltf', 'anna', '--opacity', '0.5']);
    run(['stage', 'light', 'lone.gltf', 'key', '--remove']);
    render('lit.gltf', 'lit.png');
    render('lone.gltf', 'alpha.png', '--alpha');
}
// What each ray of a camera sees of the stream alone. In the page, a performer with the transform `worldFromTree` is seen by
// a camera that stands in the world as this one stands in the stream.
function renderTurned() {
    const angle = 0.6, [w, h] = kSize, focal = h / 2 / Math.tan(angle / 2), worldFromTree = placement(0.7, 1.5, [-0.4, 0.2, 0.6]);
    const treeFromCamera = inverse(lookAt([1.9, 1.4, 2.2], [0.5, 0.5, 0.5]));
    const rows = [0, 1, 2, 3].map(row => [0, 1, 2, 3].map(column => treeFromCamera[4 * column + row]));
    const write = (name, json) => fs.writeFileSync(path.join(folder, name), JSON.stringify(json));
    write('camera.json', {w, h, fl_x: focal, fl_y: focal, cx: w / 2, cy: h / 2, frames: [{transform_matrix: rows}]});
    run(['render', 'stream.nvs', '-o', 'turned.png', '--camera', 'camera.json', '--frames', '0', '--background', 'white', '--samples', '1',
         '--direct', '--overwrite']);
    write('turned.json', {angle, worldFromTree, worldFromCamera: multiply(worldFromTree, treeFromCamera)});
}
// A ring on a floor, each copy at another time, and what a browser cannot show.
function makeRing() {
    run(['stage', 'new', 'ring.gltf', '--overwrite']);
    run(['stage', 'add', 'ring.gltf', 'stream.nvs', '--name', 'anna', '--time', 'loop']);
    run(['stage', 'duplicate', 'ring.gltf', 'anna', '--count', '2', '--ring', '2', '--stagger', '1f']);
    run(['stage', 'set', 'ring.gltf', 'anna 2', '--spin', '90', '--time', 'reverse']);
    render('ring.gltf', 'ring.png');
    const json = JSON.parse(fs.readFileSync(path.join(folder, 'ring.gltf')));
    json.nodes.push({name: 'berta', extensions: {NEUVV_performer: {uri: 'berta.nvv'}}});
    json.nodes.find(({name}) => name === 'anna').extensions.NEUVV_performer.paint = [{uri: 'red.nvpaint'}];
    json.scenes[0].nodes.push(json.nodes.length - 1);
    fs.writeFileSync(path.join(folder, 'ring.gltf'), JSON.stringify(json));
}
// One whose set is not there, and whose stream is therefore not to be asked for.
function makeBroken() {
    const json = JSON.parse(fs.readFileSync(path.join(folder, 'lone.gltf')));
    json.nodes.find(({name}) => name === 'anna').extensions.NEUVV_performer.uri = 'unopened.nvs';
    json.buffers = [{byteLength: 12, uri: 'nothing.bin'}];
    json.bufferViews = [{buffer: 0, byteLength: 12}];
    json.accessors = [{bufferView: 0, componentType: 5126, count: 1, type: 'VEC3', min: [0, 0, 0], max: [0, 0, 0]}];
    json.meshes = [{primitives: [{attributes: {POSITION: 0}}]}];
    json.scenes[0].nodes.push(json.nodes.push({name: 'set', mesh: 0}) - 1);
    fs.writeFileSync(path.join(folder, 'broken.gltf'), JSON.stringify(json));
}

fs.copyFileSync(stream, path.join(folder, 'stream.nvs'));
fs.copyFileSync(path.join(path.dirname(stream), 'small.nvs'), path.join(folder, 'plain.nvs'));  // whose colours have no harmonics
fs.writeFileSync(path.join(folder, 'least_db.json'), JSON.stringify(kLeast_db));
makeLoneStages();
renderTurned();
makeRing();
makeBroken();
// One of the stages and the player are those that NeuVV has put into a folder for browsers.
execFileSync(programWith(neuvv, built, folder), ['export', 'lone.gltf', '--as', 'web', '-o', 'published'], {cwd: folder, stdio: ['ignore', 'ignore', 'inherit']});
const published = path.join(folder, 'published'), read = name => fs.readFileSync(path.join(published, name));
const sent = {'/views/lone.gltf': read('show.glb'), '/views/clip_1.nvs': read('clip_1.nvs')};
const roots = [['/test/', here], ['/views/', folder], ['/without/stage/', path.join(folder, 'nothing')], ['/without/', built], ['/', published]];
const {results, asked, missing} = await resultsOf({page: '/test/three.html?src=/views/ring.gltf', roots, sent});

const wrong = [];
const expect = (condition, text) => condition || wrong.push(text);
const db = value => `${value?.toFixed(2)} dB`;
if (results.problem) {
    wrong.push(results.problem);
} else {
    for (const [name, png] of Object.entries(results.pngs))
        fs.writeFileSync(path.join(folder, `web_${name}.png`), Buffer.from(png.split(',')[1], 'base64'));
    for (const [name, value] of Object.entries(results.psnr_db)) console.log(`${name}: ${db(value)}`);
    for (const [name, least] of Object.entries(kLeast_db)) expect(results.psnr_db[name] >= least, `${name} has ${db(results.psnr_db[name])}`);
    expect(results.psnr_db.otherView < kLeast_db.turned - 15, `another view passes, too: ${db(results.psnr_db.otherView)}`);
    for (const text of results.wrong) wrong.push(text);
    const fetched = asked.filter(name => name.endsWith('.nvs')).length;
    expect(fetched === results.opened, `streams were fetched ${fetched} times in ${results.opened} scenes`);
    const isNamed = ['berta.nvv', 'the paint of "anna"'].every(text => results.warnings[0]?.includes(text));
    expect(results.warnings.length === 1 && isNamed, `warned: ${results.warnings}`);
    expect(results.errors.length === 0, `the console has errors: ${results.errors}`);
    const others = missing.filter(name => !name.startsWith('/without/stage/') && name !== '/views/nothing.bin');
    expect(others.length === 0, `asked for ${others}`);
}
if (!given) fs.rmSync(folder, {recursive: true});
for (const text of wrong) console.error(`wrong: ${text}`);
process.exit(wrong.length > 0 ? 1 : 0);
