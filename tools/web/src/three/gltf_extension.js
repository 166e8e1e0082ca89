// NeuVV's stages in three.js: glTF whose nodes have NEUVV_performer, and whose scene has NEUVV_stage (engine/stage/README.md).
import {AmbientLight, Color, Group, LoaderUtils} from 'three';
import {PerformerMesh} from './performer_mesh.js';
import {Stage} from './stage.js';

const kPerformer = 'NEUVV_performer', kStage = 'NEUVV_stage';
const kMostShadows = 4;  // lights that have them: kMaxShadows of shaders/shared/lights.h
const kShadow = {bias: -0.0005, normalBias: 0.02};  // so that the set casts none on itself where lights graze it

const members = value => value && typeof value === 'object' && !Array.isArray(value) ? value : {};
const numberOr = (value, otherwise) => Number.isFinite(value) ? value : otherwise;
// Linear, as three.js works; null where there is none.
const colourOf = value => Array.isArray(value) && value.length === 3 && value.every(part => part >= 0) ? new Color(...value) : null;

/**
 * For GLTFLoader.register(): `parser => new NeuvvPerformerExtension(parser)`. A node that has a performer gets a
 * PerformerMesh, and `userData.stage` of what is loaded is the Stage that plays them and has the background of the scene.
 * What a browser cannot show is named in one warning on the console.
 */
export class NeuvvPerformerExtension {
    name = kPerformer;
    #parser; #performers = []; #omitted = []; #settings;
    #opening = [];  // opens the streams when all else is there: a glTF that cannot be read leaves none open

    constructor(parser) {
        const {json} = parser;
        this.#parser = parser;
        this.#settings = members(json.scenes?.[json.scene ?? 0]?.extensions?.[kStage]);
    }
    // Buffers inside the file are decoded here: three.js would fetch them, which strict policies for content do not allow.
    beforeRoot() {
        for (const [index, {uri}] of (this.#parser.json.buffers ?? []).entries()) {
            const [, base64] = /^data:[^,]*;base64,(.*)$/s.exec(uri ?? '') ?? [];
            if (!base64) continue;
            const bytes = Uint8Array.from(atob(base64), letter => letter.charCodeAt(0));
            this.#parser.cache.add(`buffer:${index}`, Promise.resolve(bytes.buffer));
        }
    }
    createNodeAttachment(index) {
        const node = this.#parser.json.nodes[index], settings = node.extensions?.[kPerformer];
        if (!settings) return null;
        const group = new Group();  // it turns with the node, and the mesh in it by its own spin
        this.#opening.push(() => this.#addPerformer(group, members(settings), node.name ?? `node ${index}`));
        return Promise.resolve(group);
    }
    async afterRoot(gltf) {
        const settings = this.#settings;
        for (const open of this.#opening) open();
        this.#light(gltf.scene);
        for (const name of ['environment', 'cameraPath'])
            if (settings[name]) this.#omitted.push(`the stage's ${name}`);
        gltf.userData.stage = new Stage(gltf, this.#performers, settings.duration, colourOf(settings.background) ?? new Color(0));
        gltf.userData.stage.omitted = this.#omitted;
        if (this.#omitted.length > 0) console.warn(`NeuVV: a browser does not show ${this.#omitted.join('; ')}`);
    }

    #addPerformer(group, settings, name) {
        const uri = settings.uri;
        if (typeof uri !== 'string' || !/\.nvs$/i.test(uri)) {
            this.#omitted.push(`${uri} of "${name}" (neuvv publish makes a .nvs of a .nvv)`);
            return;
        }
        if (settings.paint?.length > 0) this.#omitted.push(`the paint of "${name}"`);
        const urlOf = one => typeof one === 'string' ? LoaderUtils.resolveURL(one, this.#parser.options.path) : null;
        const sound = members(settings.sound);
        const mesh = new PerformerMesh({url: urlOf(uri), sound: urlOf(sound.uri), isLit: this.#settings.falloff !== false});
        mesh.castShadow = settings.castsShadow !== false;
        mesh.visible = settings.visible !== false;
        mesh.opacity = Math.max(0, Math.min(numberOr(settings.opacity, 1), 1));
        const gain = Math.min(1, 10 ** (numberOr(sound.gain, 0) / 20));  // a page makes no sound louder than its file
        this.#performers.push({name, mesh, gain, time: settings.time ?? [], spin_deg: numberOr(settings.spin, 0)});
        group.add(mesh);
    }
    // Ambient light, and the shadows of performers on the set.
    #light(scene) {
        const lights = [], {ambient, shadows} = this.#settings;
        scene.traverse(object => {
            if (object.isLight) lights.push(object);
            if (object.isMesh && !(object instanceof PerformerMesh)) object.castShadow = object.receiveShadow = true;
        });
        const casting = lights.filter(light => light.isSpotLight || light.isDirectionalLight).slice(0, kMostShadows);
        for (const light of casting) {
            light.castShadow = shadows !== false;
            Object.assign(light.shadow, kShadow);
        }
        const colour = colourOf(ambient) ?? new Color(lights.length > 0 ? 0 : 0xffffff);
        scene.add(new AmbientLight(colour, Math.PI));  // a white surface reflects 1 of 1
    }
}
