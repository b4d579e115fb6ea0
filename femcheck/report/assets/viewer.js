"use strict";
// The deformed solid in WebGL, without a library: one indexed surface, a line, four numbers for the
// eye. Tried: pyvista's export_html wants trame installed and is deprecated since 0.49.

const PART_SUPPLY = [0, 1, 2, 3, 0]; // free surface, chambers' walls of supplies 1…3, tip face
const GREY = [0.68, 0.68, 0.68];
const MOST_CONTEXTS = 8; // a browser grants some sixteen; those out of sight give theirs back

const VERTEX = `
attribute vec3 place, normal;
attribute float level;
uniform mat4 eye;
uniform mat3 turn;
varying float stretch;
varying vec3 facing;
void main() {
  stretch = level;
  facing = turn * normal;
  gl_Position = eye * vec4(place, 1.0);
}`;

const FRAGMENT = `
precision mediump float;
uniform sampler2D map;
uniform vec4 colour;
uniform float mapped, lit;
varying float stretch;
varying vec3 facing;
void main() {
  vec3 base = mix(colour.rgb, texture2D(map, vec2(stretch * 0.99609375 + 0.001953125, 0.5)).rgb, mapped);
  vec3 n = normalize(facing + vec3(0.0, 0.0, 1e-6));
  float front = abs(n.z), side = 0.5 + 0.5 * dot(n, vec3(-0.45, 0.65, 0.6)) * sign(n.z);
  float light = mix(1.0, 0.42 + 0.4 * front + 0.24 * side, lit);
  gl_FragColor = vec4(base * min(light, 1.08), colour.a);
}`;

function bytesOf(text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
  return bytes;
}

function decodeModel(packed) {
  const triangles = bytesOf(packed.triangles).buffer;
  const indices = packed.wide ? new Uint32Array(triangles) : new Uint16Array(triangles);
  const shapes = packed.shapes.map((shape) => {
    const steps = new Uint16Array(bytesOf(shape.at).buffer);
    const at = new Float32Array(steps.length);
    for (let k = 0; k < at.length; k++) at[k] = packed.offset[k % 3] + packed.step * steps[k];
    const levels = Float32Array.from(bytesOf(shape.stretch), (one) => one / 255);
    return { at, levels, normals: normalsOf(at, indices), line: shape.line };
  });
  return { indices, shapes };
}

function normalsOf(at, indices) {
  const sums = new Float32Array(at.length);
  for (let k = 0; k < indices.length; k += 3) {
    const [a, b, c] = [3 * indices[k], 3 * indices[k + 1], 3 * indices[k + 2]];
    const n = cross(difference(at, b, a), difference(at, c, a)); // longer for larger triangles
    for (const one of [a, b, c]) for (let d = 0; d < 3; d++) sums[one + d] += n[d];
  }
  for (let k = 0; k < sums.length; k += 3) {
    const length = Math.hypot(sums[k], sums[k + 1], sums[k + 2]) || 1;
    for (let d = 0; d < 3; d++) sums[k + d] /= length;
  }
  return sums;
}

const difference = (at, b, a) => [at[b] - at[a], at[b + 1] - at[a + 1], at[b + 2] - at[a + 2]];
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0],
];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const unit = (a) => scaled(a, 1 / (Math.hypot(...a) || 1));

function mixed(from, to, share) {
  const values = new Float32Array(to.length);
  for (let k = 0; k < values.length; k++) values[k] = from[k] + share * (to[k] - from[k]);
  return values;
}

// A tube round a polyline, for lines are one pixel wide in WebGL.
function tubeOf(line, radius) {
  const sides = 8, count = line.length / 3, at = [], indices = [];
  for (let k = 0; k < count; k++) {
    const before = 3 * Math.max(k - 1, 0), after = 3 * Math.min(k + 1, count - 1);
    const along = unit(difference(line, after, before));
    const across = unit(cross(along, Math.abs(along[0]) < 0.8 ? [1, 0, 0] : [0, 1, 0]));
    const other = cross(along, across);
    for (let s = 0; s < sides; s++) {
      const angle = (2 * Math.PI * s) / sides;
      const [c, d] = [radius * Math.cos(angle), radius * Math.sin(angle)];
      for (let x = 0; x < 3; x++) at.push(line[3 * k + x] + c * across[x] + d * other[x]);
      if (k > 0) {
        const [a, b] = [k * sides + s, k * sides + ((s + 1) % sides)];
        indices.push(a - sides, b - sides, b, a - sides, b, a);
      }
    }
  }
  return { at: new Float32Array(at), indices: new Uint16Array(indices) };
}

function plateOf(radius) {
  const at = [0, 0, -0.4], indices = [];
  for (let k = 0; k < 72; k++) {
    const angle = (2 * Math.PI * k) / 72;
    at.push(radius * Math.cos(angle), radius * Math.sin(angle), -0.4);
    indices.push(0, k + 1, ((k + 1) % 72) + 1);
  }
  return { at: new Float32Array(at), indices: new Uint16Array(indices) };
}

class Drawing {
  // What one canvas holds in its graphics memory; throws where there is no WebGL.
  constructor(canvas, packed, model, map) {
    const gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });
    if (!gl || (packed.wide && !gl.getExtension("OES_element_index_uint"))) throw new Error("no WebGL");
    this.gl = gl;
    this.packed = packed;
    this.model = model;
    this.program = this.link();
    this.name = (kind, name) => gl[`get${kind}Location`](this.program, name);
    this.buffers = {};
    this.solid = this.body(model.indices);
    this.ghost = this.body(model.indices);
    this.fill(this.ghost, model.shapes[0].at, model.shapes[0].normals, model.shapes[0].levels);
    const plate = plateOf(1.45 * packed.radius);
    this.plate = this.body(plate.indices);
    this.fill(this.plate, plate.at);
    this.line = null;
    this.texture(map);
  }

  link() {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error("no program");
    gl.useProgram(program);
    return program;
  }

  texture(map) {
    const gl = this.gl;
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, map);
    for (const name of ["MIN_FILTER", "MAG_FILTER"]) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl.LINEAR);
    for (const name of ["WRAP_S", "WRAP_T"]) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl.CLAMP_TO_EDGE);
  }

  body(indices) {
    const gl = this.gl, made = { indices: gl.createBuffer(), count: indices.length, wide: indices instanceof Uint32Array };
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, made.indices);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
    for (const name of ["place", "normal", "level"]) made[name] = gl.createBuffer();
    return made;
  }

  fill(body, at, normals, levels) {
    const gl = this.gl, zeros = (n) => new Float32Array(n);
    const data = { place: at, normal: normals || zeros(at.length), level: levels || zeros(at.length / 3) };
    for (const [name, values] of Object.entries(data)) {
      gl.bindBuffer(gl.ARRAY_BUFFER, body[name]);
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
    }
  }

  shape(at, normals, levels, line) {
    this.fill(this.solid, at, normals, levels);
    const tube = tubeOf(line, 0.032 * this.packed.radius);
    if (!this.line) this.line = this.body(tube.indices);
    this.fill(this.line, tube.at);
  }

  draw(body, colour, { mapped = 0, lit = 0, from = 0, count = body.count } = {}) {
    const gl = this.gl;
    for (const [name, size] of [["place", 3], ["normal", 3], ["level", 1]]) {
      const where = this.name("Attrib", name);
      gl.bindBuffer(gl.ARRAY_BUFFER, body[name]);
      gl.enableVertexAttribArray(where);
      gl.vertexAttribPointer(where, size, gl.FLOAT, false, 0, 0);
    }
    gl.uniform4fv(this.name("Uniform", "colour"), colour);
    gl.uniform1f(this.name("Uniform", "mapped"), mapped);
    gl.uniform1f(this.name("Uniform", "lit"), lit);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, body.indices);
    const kind = body.wide ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT;
    gl.drawElements(gl.TRIANGLES, count, kind, from * (body.wide ? 4 : 2));
  }

  render(eye, turn, look) {
    const gl = this.gl;
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.clearColor(...look.ground, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    // the canvas itself stays opaque, or the page's ground would shine through
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.uniformMatrix4fv(this.name("Uniform", "eye"), false, eye);
    gl.uniformMatrix3fv(this.name("Uniform", "turn"), false, turn);
    this.draw(this.plate, [...look.plate, 1]);
    gl.depthMask(false); // the undeformed body first: behind the solid wherever that is
    if (look.ghost) this.draw(this.ghost, [0.5, 0.52, 0.54, 0.3], { lit: 0.7, count: 3 * this.packed.parts[0] });
    gl.depthMask(true);
    if (look.solid) this.parts(look, false);
    gl.depthMask(false);
    if (look.solid) this.parts(look, true);
    gl.depthMask(true);
    gl.disable(gl.DEPTH_TEST);
    if (look.solid && look.beam) this.draw(this.line, [...look.ink, 1]);
  }

  // Chambers first: what is see-through comes after what it shows.
  parts(look, clear) {
    let from = 0;
    this.packed.parts.forEach((triangles, part) => {
      const isClear = look.open && part === 0;
      if (triangles && isClear === clear) {
        const supply = PART_SUPPLY[part], bySupply = look.supplies;
        const colour = bySupply ? (supply ? look.colours[supply - 1] : GREY) : GREY;
        const alpha = isClear ? 0.22 : 1;
        this.draw(this.solid, [...colour, alpha], { mapped: bySupply ? 0 : 1, lit: 1, from, count: 3 * triangles });
      }
      from += 3 * triangles;
    });
  }

  release() {
    const lose = this.gl.getExtension("WEBGL_lose_context");
    if (lose) lose.loseContext();
  }
}

class Camera {
  constructor(packed) {
    this.packed = packed;
    this.reset();
  }

  reset() {
    this.azimuth = this.packed.azimuth;
    this.elevation = 0.3;
    this.zoom = 1;
  }

  turnBy(right, up) {
    this.azimuth -= right;
    this.elevation = Math.min(1.55, Math.max(-1.2, this.elevation + up));
  }

  nearer(factor) {
    this.zoom = Math.min(8, Math.max(0.4, this.zoom * factor));
  }

  // Column by column, as WebGL takes them: to the screen, and directions to the eye's.
  matrices(aspect, middle, reach) {
    const [ca, sa] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    const right = [-sa, ca, 0], back = [ca * ce, sa * ce, se], up = cross(back, right);
    const far = 4.2 * reach, focal = (2 * 1.75 * this.zoom) * Math.min(1, aspect);
    const [n, f] = [far - 2.5 * reach, far + 2.5 * reach];
    const rows = [
      [...scaled(right, focal / aspect), -dot(right, middle) * focal / aspect],
      [...scaled(up, focal), -dot(up, middle) * focal],
      [...scaled(back, -(f + n) / (f - n)), (dot(back, middle) - far) * (-(f + n) / (f - n)) - (2 * f * n) / (f - n)],
      [...scaled(back, -1), far + dot(back, middle)],
    ];
    const eye = new Float32Array(16);
    for (let r = 0; r < 4; r++) for (let c = 0; c < 4; c++) eye[4 * c + r] = rows[r][c];
    const turn = new Float32Array(9);
    [right, up, back].forEach((row, r) => row.forEach((value, c) => { turn[3 * c + r] = value; }));
    return { eye, turn };
  }
}
