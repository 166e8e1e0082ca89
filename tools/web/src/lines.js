// Straight lines in a room, of one colour.

const kVertex = `#version 300 es
uniform mat4 clip_from_world;
in vec3 place;
void main() { gl_Position = clip_from_world * vec4(place, 1); }`;
const kFragment = `#version 300 es
precision mediump float;
uniform vec4 colour;
out vec4 pixel;
void main() { pixel = colour; }`;

export class Lines {
    #gl; #program; #buffer;

    constructor(gl) {
        this.#gl = gl;
        this.#program = gl.createProgram();
        for (const [type, text] of [[gl.VERTEX_SHADER, kVertex], [gl.FRAGMENT_SHADER, kFragment]]) {
            const shader = gl.createShader(type);
            gl.shaderSource(shader, text);
            gl.compileShader(shader);
            gl.attachShader(this.#program, shader);
            gl.deleteShader(shader);
        }
        gl.linkProgram(this.#program);
        this.#buffer = gl.createBuffer();
    }
    /** `ends`: x, y, z of the two ends of each line, metres. `colour`: sRGB and alpha. */
    draw(ends, clipFromWorld, colour) {
        const gl = this.#gl, place = gl.getAttribLocation(this.#program, 'place');
        gl.useProgram(this.#program);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.#buffer);
        gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(ends), gl.STREAM_DRAW);
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
        gl.uniformMatrix4fv(gl.getUniformLocation(this.#program, 'clip_from_world'), false, clipFromWorld);
        gl.uniform4f(gl.getUniformLocation(this.#program, 'colour'), ...colour);
        gl.enable(gl.DEPTH_TEST);
        gl.drawArrays(gl.LINES, 0, ends.length / 3);
        gl.disableVertexAttribArray(place);
    }
    end() {
        this.#gl.deleteBuffer(this.#buffer);
        this.#gl.deleteProgram(this.#program);
    }
}
