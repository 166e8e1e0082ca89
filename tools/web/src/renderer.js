// Draws slice trees with WebGL 2: the engine's own walk (performer.frag), a ray for each pixel.
import {raysOf} from './matrices.js';
import {boxesOf, kStop, kWidth, texturesOf} from './slice_tree.js';

// The far sides of the box around the leaves, so that it is drawn also where the eye is inside: a strip of 12 triangles.
export const kVertex = `#version 300 es
uniform mat4 clip_from_tree;
uniform vec3 low, high;  // of the box, metres
void main() {
    int bit = 1 << gl_VertexID;
    vec3 at = mix(low, high, vec3(ivec3(0x287a, 0x02af, 0x31e3) & bit) / float(bit));
    gl_Position = clip_from_tree * vec4(at, 1);
}`;
const kCorners = 14;

// Throws where the browser cannot draw.
export class WebglMissing extends Error {}

const srgbOf = linear => linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;

/** A slice tree in textures. */
class TreeOnDevice {
    constructor(gl, tree) {
        this.gl = gl;
        this.textures = texturesOf(tree).map(one => this.#uploaded(one));
        this.boxes = boxesOf(tree);
        const {degree, nodeLevels, topLevels, topFirst, topLast} = tree;
        Object.assign(this, {constants: [degree, nodeLevels, topLevels], topFirst, topLast});
    }
    #uploaded({name, channels, words, rows}) {
        const gl = this.gl;
        if (rows > gl.getParameter(gl.MAX_TEXTURE_SIZE)) throw new WebglMissing('a frame has more leaves than this browser draws');
        const [internal, format] = {1: [gl.R32UI, gl.RED_INTEGER], 2: [gl.RG32UI, gl.RG_INTEGER], 4: [gl.RGBA32UI, gl.RGBA_INTEGER]}[channels];
        const texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texStorage2D(gl.TEXTURE_2D, 1, internal, kWidth, rows);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
        gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, kWidth, rows, format, gl.UNSIGNED_INT, words);
        return {name, texture};
    }
    free() { for (const {texture} of this.textures) this.gl.deleteTexture(texture); }
}

export class Renderer {
    #gl; #walk; #programs = new Map(); #tree = null;

    /** `walk`: the text of performer.frag. Throws WebglMissing. */
    constructor(canvas, walk) {
        this.#gl = canvas.getContext('webgl2', {alpha: true, premultipliedAlpha: true, antialias: false, depth: true,
                                                powerPreference: 'high-performance'});
        if (!this.#gl) throw new WebglMissing('this browser has no WebGL 2');
        if (this.#gl.getParameter(this.#gl.MAX_TEXTURE_SIZE) < kWidth) throw new WebglMissing('this browser has too small textures');
        this.#walk = walk;
    }
    get gl() { return this.#gl; }
    /** The slice tree that draw() shows from now on, as frames.js returns it. */
    show(tree) {
        if (this.#gl.isContextLost()) return;
        const next = new TreeOnDevice(this.#gl, tree);
        this.#tree?.free();
        this.#tree = next;
    }
    /** `background`: linear RGB and alpha; what is not opaque is blended with the page. */
    clear(background = [0, 0, 0, 0]) {
        const gl = this.#gl, alpha = background[3];
        gl.clearColor(...background.slice(0, 3).map(linear => srgbOf(linear) * alpha), alpha);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    }
    /**
     * Into the viewport. `eye`: of the rays, [x, y, z, 1] in metres in the coordinates of the stream. `clipFromTree`: from
     * these to gl_Position. `background`: what has been cleared with.
     */
    draw(eye, clipFromTree, background = [0, 0, 0, 0]) {
        const gl = this.#gl, tree = this.#tree;
        if (gl.isContextLost() || !tree) return;
        const {program, places} = this.#program(tree.constants), {min, size, leaves} = tree.boxes;
        gl.useProgram(program);
        gl.enable(gl.DEPTH_TEST);
        gl.enable(gl.CULL_FACE);
        gl.cullFace(gl.FRONT);
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
        for (const [unit, {name, texture}] of tree.textures.entries()) {
            gl.activeTexture(gl.TEXTURE0 + unit);
            gl.bindTexture(gl.TEXTURE_2D, texture);
            gl.uniform1i(places(name), unit);
        }
        gl.uniformMatrix4fv(places('clip_from_tree'), false, clipFromTree);
        gl.uniform3f(places('low'), ...leaves.min);
        gl.uniform3f(places('high'), ...leaves.max);
        gl.uniformMatrix4fv(places('push.clip_from_tree'), false, clipFromTree);
        gl.uniform4f(places('push.eye'), ...eye);
        for (const [name, vector] of Object.entries(raysOf(eye, clipFromTree, gl.getParameter(gl.VIEWPORT)))) gl.uniform4f(places(`push.${name}`), ...vector, 0);
        gl.uniform4f(places('push.box_min'), ...min, 0);
        gl.uniform4f(places('push.box_size'), ...size, 0);
        gl.uniform4f(places('push.background'), ...background);
        gl.uniform1f(places('push.stop'), kStop);
        gl.uniform1ui(places('push.top.first'), tree.topFirst);
        gl.uniform1ui(places('push.top.last'), tree.topLast);
        gl.drawArrays(gl.TRIANGLE_STRIP, 0, kCorners);
    }
    /** Forgets what it had on a device that was lost. */
    restore() {
        this.#tree = null;
        this.#programs.clear();
    }
    /** Frees all that it has on the device. */
    end() {
        this.#tree?.free();
        this.#tree = null;
        for (const {program} of this.#programs.values()) this.#gl.deleteProgram(program);
        this.#programs.clear();
    }

    // The walk for trees of this shape.
    #program(constants) {
        const key = constants.join();
        if (!this.#programs.has(key)) this.#programs.set(key, this.#compiled(constants));
        return this.#programs.get(key);
    }
    #compiled(constants) {
        const gl = this.#gl, program = gl.createProgram(), locations = new Map();
        const defined = constants.map((value, id) => `#define SPIRV_CROSS_CONSTANT_ID_${id} ${value}u\n`).join('');
        const version = '#version 300 es\n';
        for (const [type, text] of [[gl.VERTEX_SHADER, kVertex], [gl.FRAGMENT_SHADER, this.#walk.replace(version, version + defined)]]) {
            const shader = gl.createShader(type);
            gl.shaderSource(shader, text);
            gl.compileShader(shader);
            gl.attachShader(program, shader);
            if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
                throw new WebglMissing(`the browser does not compile a shader: ${gl.getShaderInfoLog(shader)}`);
            gl.deleteShader(shader);
        }
        gl.linkProgram(program);
        if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
            throw new WebglMissing(`the browser does not link a shader: ${gl.getProgramInfoLog(program)}`);
        const places = name => {
            if (!locations.has(name)) locations.set(name, gl.getUniformLocation(program, name));
            return locations.get(name);
        };
        return {program, places};
    }
}
