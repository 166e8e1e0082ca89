// Performers in scenes of three.js, in a browser: images against those that NeuVV rendered, and what can be counted.
import * as THREE from '/stage/three.module.js';
import {GLTFLoader} from '/stage/GLTFLoader.js';
import {NeuvvPerformerExtension, PerformerMesh} from '/stage/index.js';
import {TimeMap, timeMapText} from '/time_map.js';
import {pixels, psnr} from '/test/images.js';

const kWidth = 320, kHeight = 240;
const kLeast_db = await (await fetch('/views/least_db.json')).json();
const results = {psnr_db: {}, pngs: {}, wrong: [], warnings: [], errors: [], opened: 0};
const expect = (condition, text) => condition || results.wrong.push(text);
for (const [name, list] of [['warn', results.warnings], ['error', results.errors]]) console[name] = (...words) => list.push(words.join(' '));

const renderer = new THREE.WebGLRenderer({antialias: false, preserveDrawingBuffer: true});
renderer.setSize(kWidth, kHeight, false);
renderer.setClearColor(0, 0);
renderer.shadowMap.enabled = true;

async function until(done, what) {
    const begin = performance.now();
    while (!done()) {
        if (performance.now() - begin > 30000) throw new Error(`waited for ${what}`);
        await new Promise(resolve => setTimeout(resolve, 10));
    }
}
async function truth(name) {
    const image = Object.assign(new Image(), {src: `/views/${name}.png`});
    await image.decode();
    return pixels(image, kWidth, kHeight);
}
/** What the canvas shows. `name`: of a file in which it is kept. */
async function drawn(scene, camera, name) {
    renderer.render(scene, camera);
    if (name) results.pngs[name] = renderer.domElement.toDataURL('image/png');
    return pixels(renderer.domElement, kWidth, kHeight);
}
/** The same through a linear image of floats, in which light is blended as NeuVV does. */
function drawnLinearly(scene, camera) {
    const target = new THREE.WebGLRenderTarget(kWidth, kHeight, {type: THREE.FloatType}), light = new Float32Array(4 * kWidth * kHeight);
    renderer.setRenderTarget(target);
    renderer.render(scene, camera);
    renderer.readRenderTargetPixels(target, 0, 0, kWidth, kHeight, light);
    renderer.setRenderTarget(null);
    target.dispose();
    const image = new Uint8ClampedArray(light.length), colour = new THREE.Color();
    for (let y = 0; y < kHeight; ++y)
        for (let x = 0; x < kWidth; ++x) {
            const from = 4 * ((kHeight - 1 - y) * kWidth + x), to = 4 * (y * kWidth + x);
            colour.setRGB(light[from], light[from + 1], light[from + 2]).convertLinearToSRGB();
            image.set([...colour.toArray(), light[from + 3]].map(part => 255 * part), to);
        }
    return image;
}

async function opened(name) {
    ++results.opened;
    const gltf = await new GLTFLoader().register(parser => new NeuvvPerformerExtension(parser)).loadAsync(`/views/${name}.gltf`);
    const {stage} = gltf.userData, scene = new THREE.Scene().add(gltf.scene);
    scene.background = stage.background;
    const show = async () => {
        stage.update(performance.now());
        await until(() => {
            stage.update(performance.now());
            return stage.isReady;
        }, `the frames of ${name}`);
    };
    await show();
    const camera = new THREE.PerspectiveCamera(gltf.cameras[0].fov, kWidth / kHeight, 0.05, 50);
    gltf.cameras[0].matrixWorld.decompose(camera.position, camera.quaternion, camera.scale);
    camera.updateMatrixWorld();
    return {scene, stage, show, camera};
}

/** Alpha as a grey image. */
const alphaOf = image => image.map((_, i) => image[i | 3]);

/** PSNR of an image of a stage, when the frames are whole, of which the first parts come first. */
async function psnrOnceWhole(stage, name, draw, least_db) {
    const from = await truth(name), begin = performance.now();
    for (;;) {
        const value = psnr(await draw(), from);
        if (value >= least_db || performance.now() - begin > 5000) return value;
        await new Promise(resolve => setTimeout(resolve, 20));
        stage.update(performance.now());
    }
}

async function compareLit() {
    const {scene, stage, camera} = await opened('lit');
    results.psnr_db.lit = await psnrOnceWhole(stage, 'lit', () => drawnLinearly(scene, camera), kLeast_db.lit);
    await drawn(scene, camera, 'lit');
    stage.dispose();
}

// By rays of one camera against what each of NeuVV's sees, and stretched against its alpha.
async function compareLone() {
    const {scene, stage, camera} = await opened('lone'), [{mesh}] = stage.performers;
    const transparent = () => {
        scene.background = null;
        return drawnLinearly(scene, camera);
    };
    results.psnr_db.stretched = await psnrOnceWhole(stage, 'alpha', () => alphaOf(transparent()), kLeast_db.stretched);
    const alpha = transparent(), shown = await drawn(scene, camera);
    const isSolid = pixel => alpha[4 * pixel + 3] === 255, solid = alpha.filter((_, i) => i % 4 === 3 && isSolid(i >> 2)).length;
    expect(solid > 500 && solid < 0.5 * kWidth * kHeight, `${solid} pixels are solid`);
    results.psnr_db.canvas = psnr(shown, alpha, isSolid);
    await hideByBoxes(scene, camera, shown, isSolid);
    scene.background = new THREE.Color(0xffffff);
    await compareEyes(scene, camera);
    await compareParallel(scene, camera);
    hitByRays(mesh, camera);
    await compareTurned(scene, stage, mesh, camera);
    const before = renderer.info.memory.textures;
    stage.dispose();
    expect(renderer.info.memory.textures === before - 3, `${before - renderer.info.memory.textures} textures were freed`);
}

// Turned, shifted and larger, as the camera of turned.png sees it, which stands still for it.
async function compareTurned(scene, stage, mesh, camera) {
    const {angle, worldFromTree, worldFromCamera} = await (await fetch('/views/turned.json')).json();
    const node = mesh.parent;
    new THREE.Matrix4().fromArray(worldFromTree).decompose(node.position, node.quaternion, node.scale);
    new THREE.Matrix4().fromArray(worldFromCamera).decompose(camera.position, camera.quaternion, camera.scale);
    camera.fov = THREE.MathUtils.radToDeg(angle);
    camera.updateProjectionMatrix();
    results.psnr_db.turned = await psnrOnceWhole(stage, 'turned', () => drawnLinearly(scene, camera), kLeast_db.turned);
    await drawn(scene, camera, 'turned');
    camera.position.x += 0.3;
    results.psnr_db.otherView = psnr(drawnLinearly(scene, camera), await truth('turned'));
}

// A box behind the performer changes none of its solid pixels; one before it hides it.
async function hideByBoxes(scene, camera, shown, isSolid) {
    const box = new THREE.Mesh(new THREE.BoxGeometry(20, 20, 0.1), new THREE.MeshBasicMaterial({color: 0xff00ff}));
    box.quaternion.copy(camera.quaternion);
    const at = async (distance, name) => {
        box.position.copy(camera.position).addScaledVector(camera.getWorldDirection(new THREE.Vector3()), distance);
        return drawn(scene, camera, name);
    };
    const isMagenta = (image, pixel) => image[4 * pixel] === 255 && image[4 * pixel + 1] === 0 && image[4 * pixel + 2] === 255;
    const count = (image, is) => Array.from({length: kWidth * kHeight}, (_, pixel) => pixel).filter(pixel => is(image, pixel)).length;
    scene.add(box);
    const behind = await at(8, 'box_behind'), before = await at(0.5), within = await at(2.6, 'box_within');
    expect(psnr(behind, shown, isSolid) > 50, 'a box behind the performer shows through it');
    expect(count(behind, isMagenta) > 1000, 'a box behind the performer is not seen beside it');
    expect(count(before, isMagenta) === kWidth * kHeight, 'a box before the performer does not hide it');
    const cut = count(within, (image, pixel) => isSolid(pixel) && isMagenta(image, pixel));
    expect(cut > 100 && cut < 0.9 * count(within, (_, pixel) => isSolid(pixel)), `a box in the performer hides ${cut} solid pixels`);
    scene.remove(box);
}

// Two eyes of a headset: parts of one image, by an array of cameras; each is as an image of its own.
async function compareEyes(scene, camera) {
    const [width, height] = [kWidth / 2, kHeight / 2], lefts = [0, width], low = height / 2;
    const eyes = lefts.map(left => Object.assign(camera.clone(), {viewport: new THREE.Vector4(left, low, width, height)}));
    const both = await drawn(scene, new THREE.ArrayCamera(eyes), 'eyes');
    renderer.setViewport(0, 0, width, height);
    const alone = await drawn(scene, camera);  // at the bottom left
    renderer.setViewport(0, 0, kWidth, kHeight);
    const part = (image, left, top) => {
        const rows = new Uint8ClampedArray(4 * width * height);
        for (let y = 0; y < height; ++y) rows.set(image.subarray(4 * ((top + y) * kWidth + left)).subarray(0, 4 * width), 4 * width * y);
        return rows;
    };
    results.psnr_db.eyes = Math.min(...lefts.map(left => psnr(part(both, left, kHeight - low - height), part(alone, 0, kHeight - height))));
}

// As orthographic cameras see it, and as one that is far away.
async function compareParallel(scene, camera) {
    const middle = new THREE.Vector3(0.8, 0.3, 0.3), direction = middle.clone().sub(camera.position).normalize(), high = 1.6;
    const parallel = new THREE.OrthographicCamera(-high * kWidth / kHeight / 2, high * kWidth / kHeight / 2, high / 2, -high / 2, 0.1, 10);
    parallel.position.copy(middle).addScaledVector(direction, -4);
    const distance = 400, angle = 2 * THREE.MathUtils.radToDeg(Math.atan(high / 2 / distance));
    const far = new THREE.PerspectiveCamera(angle, kWidth / kHeight, distance - 5, distance + 5);
    far.position.copy(middle).addScaledVector(direction, -distance);
    for (const one of [parallel, far]) {
        one.lookAt(middle);
        one.updateMatrixWorld();
    }
    results.psnr_db.parallel = psnr(await drawn(scene, parallel, 'parallel'), await drawn(scene, far));
}

function hitByRays(mesh, camera) {
    const rays = new THREE.Raycaster(), box = mesh.geometry.boundingBox.clone();
    const corner = box.max.clone().applyMatrix4(mesh.matrixWorld), centre = box.getCenter(new THREE.Vector3()).applyMatrix4(mesh.matrixWorld);
    rays.set(camera.position, centre.clone().sub(camera.position).normalize());
    const [hit] = rays.intersectObject(mesh), onBox = hit?.point.clone().applyMatrix4(mesh.matrixWorld.clone().invert());
    expect(hit && hit.distance < camera.position.distanceTo(centre) && Math.abs(box.distanceToPoint(onBox)) < 1e-6, 'a ray does not hit the box');
    rays.set(camera.position, camera.position.clone().sub(corner).normalize());
    expect(rays.intersectObject(mesh).length === 0, 'a ray that looks away hits');
    let refusal = '';
    try {
        new PerformerMesh({src: 'performer.nvs'});
    } catch (error) {
        refusal = error.message;
    }
    expect(refusal.includes('url'), `a performer without an address is made: ${refusal}`);
}

// A floor, and lights of each kind whose shadows can be switched off.
async function castShadows() {
    ++results.opened;
    const scene = new THREE.Scene(), mesh = new PerformerMesh({url: '/views/stream.nvs'});
    const floor = new THREE.Mesh(new THREE.PlaneGeometry(8, 8), new THREE.MeshStandardMaterial());
    floor.rotation.x = -Math.PI / 2;
    floor.receiveShadow = mesh.castShadow = true;
    mesh.position.y = 0.2;
    const camera = new THREE.PerspectiveCamera(45, kWidth / kHeight, 0.1, 50);
    camera.position.set(2, 3, 4);
    camera.lookAt(0.5, 0, 0);
    scene.add(floor, mesh);
    await until(() => {
        mesh.update(performance.now());
        return mesh.media.readyState >= 2;
    }, 'a performer');
    const twin = mesh.clone();
    expect(twin.castShadow && twin.position.equals(mesh.position) && twin.media !== mesh.media, 'a clone is not one');
    twin.dispose();
    const lights = {directional: new THREE.DirectionalLight(0xffffff, 2), spot: new THREE.SpotLight(0xffffff, 60, 0, 0.5),
                    point: new THREE.PointLight(0xffffff, 30)};
    for (const [name, light] of Object.entries(lights)) {
        light.position.set(-1, 4, 1);
        scene.add(light);
        const open = await drawn(scene, camera);
        light.castShadow = true;
        const shaded = await drawn(scene, camera, `shadow_${name}`);
        let darker = 0;
        for (let i = 0; i < open.length; i += 4) darker += open[i] - shaded[i] > 40;
        expect(darker > 300 && darker < 20000, `the shadow of a ${name} light darkens ${darker} pixels`);
        scene.remove(light);
    }
    mesh.dispose();
}

// Known values of tests/stage/time_map_test.cpp, of ten frames.
async function mapTimes() {
    const kKnown = {'loop:2f:5f': [2, 3, 4, 2, 3, 4, 2], 'ping-pong:2f:5f': [2, 3, 4, 3, 2, 3, 4], 'jump:3f:7f': [0, 1, 2, 7, 8, 9, 9],
                    'speed:0.5,hold': [0, 0, 1, 1, 2], 'loop:0:2f,speed:0.5,offset:2f': [0, 0, 0, 0.5, 1, 1, 0, 0.5],
                    'loop:0:0.08s': [0, 1, 0, 1], reverse: [9, 8, 7]};
    for (const [text, known] of Object.entries(kKnown)) {
        const map = await TimeMap.of(text, 10, 25), frames = known.map((_, i) => map.frame(i / 25));
        expect(frames.every((frame, i) => Math.abs(frame - known[i]) < 1e-6), `${text} shows ${frames}`);
        map.free();
    }
    const json = [{operator: 'pause', at: '3f', for: '1.5s'}, {operator: 'loop', from: '0s', to: '2s'}, {operator: 'speed', factor: 0.5}];
    expect(timeMapText(json) === 'pause:3f:1.5s,loop:0s:2s,speed:0.5', `JSON becomes ${timeMapText(json)}`);
    const kProblems = {'lo op': 'lo op', 'loop,reverse': 'time/1: needs an end', 'reverse,offset:0x3f': 'time/1: "0x3f" is no time',
                       'offset:1f2f': 'time/0: "1f2f" is no time', 'loop:5f:5f': 'time/0: '};
    for (const [text, problem] of Object.entries(kProblems)) {
        const said = await TimeMap.of(text, 10, 25).then(() => 'nothing', error => error.message);
        expect(said.includes(problem), `${text}: "${said}" does not say "${problem}"`);
    }
}

// Three copies at other times: one loops, one turns while it goes backwards, one is a frame behind.
async function playRing() {
    const {scene, stage, camera, show} = await opened('ring');
    expect(stage.performers.length === 3, `the ring has ${stage.performers.length} performers`);
    results.psnr_db.ring = await psnrOnceWhole(stage, 'ring', () => drawn(scene, camera, 'ring'), kLeast_db.ring);
    const kKnown = {0: [0, 3, 2], 0.05: [1, 1, 3], 0.13: [3, 0, 1]};
    for (const [time, known] of Object.entries(kKnown)) {
        stage.currentTime = Number(time);
        await show();
        const frames = stage.performers.map(({mesh}) => Math.floor(mesh.media.currentTime * 25));
        expect(frames.join() === known.join(), `at ${time} s the ring shows ${frames}, not ${known}`);
    }
    const turn = stage.performers[1].mesh.rotation.y;
    expect(Math.abs(turn - THREE.MathUtils.degToRad(90 * 0.13)) < 1e-6, `a spin turned by ${turn}`);
    stage.loop = false;
    stage.play();
    let ended = false;
    stage.addEventListener('ended', () => ended = true);
    await until(() => {
        stage.update(performance.now());
        return ended;
    }, 'the end of the ring');
    expect(stage.paused && stage.currentTime === stage.duration, 'the ring does not stop at its end');
    stage.dispose();
}

// A glTF that cannot be read leaves no stream open: none of its own is asked for.
async function readBroken() {
    const load = new GLTFLoader().register(parser => new NeuvvPerformerExtension(parser)).loadAsync('/views/broken.gltf');
    const said = await load.then(() => 'nothing', error => error.message);
    expect(said.includes('nothing.bin'), `a glTF without its set: "${said}"`);
    await new Promise(resolve => setTimeout(resolve, 300));
}

// The page of stages itself, and the same without three.js.
async function openPages() {
    await import('/stage.js');
    ++results.opened;
    const [problem] = document.querySelectorAll('.problem');
    await until(() => document.querySelector('.bar span')?.textContent.includes('/') || problem.textContent, 'the page of stages');
    const isNamed = /^not shown: .*berta\.nvv[^\n]*$/.test(problem.textContent);
    expect(isNamed, `the page of stages says ${problem.textContent}`);
    await import('/without/stage.js');
    const other = document.querySelectorAll('.problem')[1];
    await until(() => other.textContent, 'the page without three.js');
    expect(other.textContent.includes('three.js is not beside this page'), `without three.js: ${other.textContent}`);
}

try {
    await mapTimes();
    await compareLit();
    await compareLone();
    await castShadows();
    await playRing();
    await readBroken();
    await openPages();
    results.warnings = [...new Set(results.warnings)];
} catch (error) {
    results.problem = `${error.message}\n${error.stack}\n${[...results.wrong, ...results.errors].join('\n')}`;
}
await fetch('/results', {method: 'POST', body: JSON.stringify(results)});
