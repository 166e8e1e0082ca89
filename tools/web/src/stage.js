// The page shows the stage that its address names, by three.js: stage.html?src=show.glb
import {Controls, kControlsStyle} from './controls.js';

const kMostDensity = 2;  // pixels across and down of a pixel of the page
const kAngle = 40;       // degrees from the top to the bottom of the image, where the stage has no camera
const kUsualView = {position: [0, 1.6, 4], target: [0, 1, 0]};  // metres

const problem = document.body.appendChild(Object.assign(document.createElement('div'), {className: 'problem', role: 'alert'}));
const say = text => problem.textContent = text;
problem.addEventListener('click', () => say(''));  // it covers a part of the stage

/** Three.js and what belongs to it, which tools/web/build leaves beside this page. */
async function libraries() {
    try {
        const [three, {GLTFLoader}, {OrbitControls}, {NeuvvPerformerExtension}] = await Promise.all(
            ['three.module', 'GLTFLoader', 'OrbitControls', 'index'].map(name => import(`./stage/${name}.js`)));
        return {three, GLTFLoader, OrbitControls, NeuvvPerformerExtension};
    } catch (error) {
        throw new Error(`three.js is not beside this page (\`tools/web/build OUT node_modules/three\` copies it, after \`npm install three\`): ${error.message}`);
    }
}

// The stage's first camera, or one before it: {camera, target}.
function view({three}, gltf) {
    const camera = new three.PerspectiveCamera(kAngle, 1, 0.01, 200), target = new three.Vector3(...kUsualView.target);
    const given = gltf.cameras.find(one => one.isPerspectiveCamera);
    camera.position.set(...kUsualView.position);
    if (!given) return {camera, target};
    given.matrixWorld.decompose(camera.position, camera.quaternion, new three.Vector3());
    camera.fov = given.fov;
    const ahead = given.getWorldDirection(new three.Vector3()), distance = target.clone().sub(camera.position).dot(ahead);
    return {camera, target: camera.position.clone().addScaledVector(ahead, Math.max(distance, 0.5))};
}

function makeRenderer({three}) {
    const renderer = new three.WebGLRenderer({antialias: true});
    renderer.shadowMap.enabled = true;
    renderer.xr.enabled = true;
    renderer.setPixelRatio(Math.min(devicePixelRatio, kMostDensity));
    document.body.append(renderer.domElement);
    return renderer;
}

// Who enters the headset stands on the floor below the camera.
function standInHeadset({three}, renderer, scene, camera) {
    const floor = new three.Group(), before = camera.clone();
    scene.add(floor);
    renderer.xr.addEventListener('sessionstart', () => {
        before.copy(camera);
        const turn = new three.Euler().setFromQuaternion(camera.quaternion, 'YXZ').y;
        floor.position.set(camera.position.x, 0, camera.position.z);
        floor.rotation.y = turn;
        floor.add(camera);
    });
    renderer.xr.addEventListener('sessionend', () => {
        floor.remove(camera);
        camera.copy(before);
    });
}

function addControls(stage, renderer) {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(kControlsStyle);
    document.adoptedStyleSheets = [sheet];
    const kFeatures = {optionalFeatures: ['local-floor']};
    const enterXR = async () => renderer.xr.setSession(await navigator.xr.requestSession('immersive-vr', kFeatures));
    const fillScreen = () => document.fullscreenElement ? document.exitFullscreen() : document.body.requestFullscreen();
    new Controls(Object.assign(stage, {enterXR}), document.body, fillScreen, say).hidden = false;
}

async function begin() {
    const all = await libraries(), {GLTFLoader, NeuvvPerformerExtension} = all;
    const src = new URLSearchParams(location.search).get('src') || 'show.glb';
    if (/\.nvs$/i.test(src)) throw new Error(`${src} is a stream, no stage: index.html?src=${src} plays it`);
    const gltf = await new GLTFLoader().register(parser => new NeuvvPerformerExtension(parser)).loadAsync(src)
        .catch(error => { throw new Error(`${src}: ${error.message}`); });
    try {
        show(all, gltf);
    } catch (error) {
        gltf.userData.stage.dispose();  // which ends its streams
        throw error;
    }
}

function show(all, gltf) {
    const renderer = makeRenderer(all), scene = new all.three.Scene().add(gltf.scene), {stage} = gltf.userData, {camera, target} = view(all, gltf);
    const orbit = new all.OrbitControls(camera, renderer.domElement);
    orbit.target.copy(target);
    scene.background = stage.background;
    const resize = () => {
        renderer.setSize(innerWidth, innerHeight);
        camera.aspect = innerWidth / innerHeight;
        camera.updateProjectionMatrix();
    };
    addEventListener('resize', resize);
    resize();
    standInHeadset(all, renderer, scene, camera);
    const problems = new Set(stage.omitted.length > 0 ? [`not shown: ${stage.omitted.join('; ')}`] : []);
    for (const {name, mesh} of stage.performers)
        mesh.media.addEventListener('error', ({message}) => say([...problems.add(`${name}, ${mesh.url}: ${message}`)].join('\n')));
    say([...problems].join('\n'));
    addControls(stage, renderer);
    renderer.setAnimationLoop(now => {
        if (!renderer.xr.isPresenting) orbit.update();
        stage.update(now, camera);
        renderer.render(scene, camera);
    });
    stage.play();
}

begin().catch(error => say(error.message));
