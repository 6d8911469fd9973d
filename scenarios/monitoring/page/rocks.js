import { BufferAttribute, BufferGeometry, Color, Mesh, PerspectiveCamera, Quaternion, Scene, ShaderMaterial, Vector3, WebGLRenderer } from "three";

const plain = new Color("#b8ab98"), withSensor = new Color("#2f86d6"), alarmed = new Color("#e0463c");

// A sphere is a square that faces the eye and covers it, in which each pixel finds where its ray meets the sphere: exact, and
// two triangles instead of hundreds. No instances: a computer without a graphics card draws them one by one.
const material = () => new ShaderMaterial({
  uniforms: { sun: { value: new Vector3(1, -0.6, 1.5).normalize() } },
  vertexShader: `
    attribute vec4 ball; // centre and radius
    attribute vec3 tint;
    varying vec3 place, middle, colour;
    varying float radius;
    void main() {
      middle = (viewMatrix * vec4(ball.xyz, 1.0)).xyz;
      radius = ball.w;
      colour = tint;
      float far = length(middle);
      vec3 toEye = -middle / far, right = normalize(cross(vec3(0.0, 1.0, 0.0), toEye)), up = cross(toEye, right);
      float size = radius * far / sqrt(max(far * far - radius * radius, 1e-12));
      place = middle + size * (position.x * right + position.y * up);
      gl_Position = projectionMatrix * vec4(place, 1.0);
    }`,
  fragmentShader: `
    uniform vec3 sun;
    uniform mat4 projectionMatrix;
    varying vec3 place, middle, colour;
    varying float radius;
    void main() {
      vec3 ray = normalize(place);
      float along = dot(ray, middle), inside = along * along - dot(middle, middle) + radius * radius;
      if (inside < 0.0) discard;
      vec3 hit = (along - sqrt(inside)) * ray, normal = (hit - middle) / radius;
      vec4 clip = projectionMatrix * vec4(hit, 1.0);
      gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
      float light = 0.35 + 0.7 * max(dot(normal, normalize((viewMatrix * vec4(sun, 0.0)).xyz)), 0.0);
      gl_FragColor = vec4(colour * light, 1.0);
      #include <colorspace_fragment>
    }`,
});

const mostBodies = 200000, mostBalls = 2e6; // a scene that would fill the memory is not drawn

/// Rocks as clumps of spheres, placed by the poses of their bodies.
export class Rocks {
  constructor(canvas) {
    this.canvas = canvas;
    this.bodies = [];
    this.alarms = new Set();
    this.parts = new Map(); // payloads of bris/poses by their first body
    this.view = { turn: 0.7, tilt: 0.35, distance: 1, centre: new Vector3() };
    this.world = new Scene();
    this.camera = new PerspectiveCamera(35, 1, 0.001, 100);
    this.camera.up.set(0, 0, 1);
    try {
      this.renderer = new WebGLRenderer({ canvas, antialias: false, alpha: true, preserveDrawingBuffer: true });
    } catch (error) { this.renderer = null; }
    this.listen();
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  scene({ shapes, bodies }) {
    if (!Array.isArray(bodies) || bodies.length > mostBodies) throw new Error("expected a list of bodies");
    this.bodies = bodies.map(([id, shape, radius, sensor]) => ({ id, balls: Array.isArray(shapes[shape]) ? shapes[shape] : [], radius, sensor }));
    const count = this.bodies.reduce((sum, b) => sum + b.balls.length, 0);
    if (count > mostBalls) { this.bodies = []; throw new Error(`expected at most ${mostBalls} spheres, found ${count}`); }
    if (this.mesh) { this.world.remove(this.mesh); this.mesh.geometry.dispose(); this.mesh.material.dispose(); }
    const geometry = new BufferGeometry(), corners = new Float32Array(12 * count), order = new Uint32Array(6 * count);
    for (let k = 0; k < count; ++k) {
      corners.set([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0], 12 * k);
      order.set([0, 1, 2, 0, 2, 3].map((corner) => 4 * k + corner), 6 * k);
    }
    geometry.setAttribute("position", new BufferAttribute(corners, 3));
    geometry.setIndex(new BufferAttribute(order, 1));
    geometry.setAttribute("ball", new BufferAttribute(new Float32Array(16 * count), 4)); // the same at each corner
    geometry.setAttribute("tint", new BufferAttribute(new Float32Array(12 * count), 3));
    geometry.setDrawRange(0, 0);
    this.mesh = new Mesh(geometry, material());
    this.mesh.frustumCulled = false;
    this.world.add(this.mesh);
    this.placed = this.complete = this.coming = null;
    for (const part of [...this.parts.values()]) this.poses(part);
  }

  /// Payload of a part of bris/poses. Returns the number of bodies and the time when all parts of one time are there;
  /// null: not yet, or it does not fit the scene. Of poses that come faster than pictures only the newest are drawn.
  poses(payload) {
    const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
    if (payload.byteLength < 20 || view.getUint8(0) !== 2) return null;
    const n = view.getUint32(4, true), time = view.getFloat64(8, true), first = view.getUint32(16, true);
    const count = (payload.byteLength - 20) / 28;
    if (this.parts.size > 10000) this.parts.clear();
    this.parts.set(first, payload); // the scene may come later
    if (!Number.isInteger(count) || n !== this.bodies.length || first + count > n) return null;
    if (!this.coming || this.coming.time !== time) this.coming = { time, numbers: new Float32Array(7 * n), from: new Set(), missing: n };
    const { numbers, from } = this.coming;
    for (let k = 0; k < 7 * count; ++k) numbers[7 * first + k] = view.getFloat32(20 + 4 * k, true);
    if (!from.has(first)) this.coming.missing -= count;
    from.add(first);
    if (this.coming.missing > 0) return null;
    this.complete = this.coming;
    this.taken = (this.taken ?? 0) + 1;
    this.schedule();
    return { bodies: n, time };
  }

  /// Draws the newest poses when the picture before is complete: a slow graphics processor never keeps messages waiting.
  schedule() {
    this.again = true;
    if (this.due || this.fence) return;
    this.due = true;
    requestAnimationFrame(() => {
      this.due = this.again = false;
      this.place();
      if (this.renderer) this.watch(this.renderer.getContext(), performance.now());
    });
  }

  watch(gl, began) {
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    const look = () => {
      if (!gl.isContextLost() && gl.getSyncParameter(this.fence, gl.SYNC_STATUS) !== gl.SIGNALED) { setTimeout(look, 4); return; }
      const took = performance.now() - began;
      gl.deleteSync(this.fence);
      this.adapt(took);
      setTimeout(() => { this.fence = null; if (this.again) this.schedule(); }, took); // half of the time is for others
    };
    setTimeout(look, 4);
  }

  /// A quarter of the pixels while pictures take too long and others wait; all of them at rest.
  adapt(milliseconds) {
    const all = Math.min(2, devicePixelRatio);
    if (milliseconds > 100 && this.again) this.ratio = all / 2;
    clearTimeout(this.rest);
    this.rest = setTimeout(() => { if (this.ratio < all) { this.ratio = all; this.draw(); } }, 1000);
  }

  place() {
    if (!this.complete || !this.mesh) return;
    const { numbers, time } = this.complete, f = (b, k) => numbers[7 * b + k];
    this.time = time;
    this.placed = this.bodies.map((_, b) => ({ position: new Vector3(f(b, 0), f(b, 1), f(b, 2)),
      attitude: new Quaternion(f(b, 4), f(b, 5), f(b, 6), f(b, 3)) }));
    if (!this.aimed) this.aim();
    const at = new Vector3(), { ball, tint } = this.mesh.geometry.attributes;
    let k = 0;
    this.bodies.forEach((body, b) => {
      if (this.onlySensors && !body.sensor) return;
      const { position, attitude } = this.placed[b];
      const colour = this.alarms.has(body.sensor) && body.sensor ? alarmed : body.sensor ? withSensor : plain;
      for (const [x, y, z, r] of body.balls) {
        at.set(x, y, z).multiplyScalar(body.radius).applyQuaternion(attitude).add(position);
        for (const end = k + 4; k < end; ++k) {
          ball.setXYZW(k, at.x, at.y, at.z, r * body.radius);
          tint.setXYZ(k, colour.r, colour.g, colour.b);
        }
      }
    });
    this.mesh.geometry.setDrawRange(0, 6 * k / 4);
    ball.needsUpdate = tint.needsUpdate = true;
    this.draw();
  }

  aim() {
    const low = new Vector3(Infinity, Infinity, Infinity), high = low.clone().negate();
    for (const { position } of this.placed) { low.min(position); high.max(position); }
    this.view.centre.copy(low).add(high).multiplyScalar(0.5);
    this.view.distance = 1.9 * Math.max(1e-3, high.distanceTo(low));
    this.aimed = true;
  }

  alarm(ids) { this.alarms = ids; this.schedule(); }
  only(sensors) { this.onlySensors = sensors; this.schedule(); }

  /// Where the centre of a body is on the canvas, in CSS pixels; for tests.
  onScreen(b) {
    this.draw();
    const p = this.placed[b].position.clone().project(this.camera);
    return { x: (p.x + 1) / 2 * this.canvas.clientWidth, y: (1 - p.y) / 2 * this.canvas.clientHeight };
  }

  draw() {
    if (!this.renderer) return;
    const { clientWidth: w, clientHeight: h } = this.canvas;
    if (!w || !h) return;
    const ratio = this.ratio ??= Math.min(2, devicePixelRatio);
    if (this.canvas.width !== Math.floor(w * ratio) || this.canvas.height !== Math.floor(h * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(w, h, false);
    }
    const { turn, tilt, distance, centre } = this.view;
    this.camera.aspect = w / h;
    this.camera.near = distance / 100;
    this.camera.far = distance * 10;
    this.camera.position.set(Math.cos(turn) * Math.cos(tilt), Math.sin(turn) * Math.cos(tilt), Math.sin(tilt))
      .multiplyScalar(distance).add(centre);
    this.camera.lookAt(centre);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.renderer.render(this.world, this.camera);
    this.pictures = (this.pictures ?? 0) + 1;
  }

  turn(dx, dy) {
    this.view.turn += dx;
    this.view.tilt = Math.max(-1.5, Math.min(1.5, this.view.tilt + dy));
    this.draw();
  }
  zoom(factor) { this.view.distance *= factor; this.draw(); }

  listen() {
    const c = this.canvas;
    c.addEventListener("pointermove", (e) => { if (e.buttons) this.turn(-0.01 * e.movementX, 0.01 * e.movementY); });
    c.addEventListener("pointerdown", (e) => c.setPointerCapture(e.pointerId));
    c.addEventListener("wheel", (e) => { e.preventDefault(); this.zoom(Math.exp(0.001 * e.deltaY)); }, { passive: false });
    const keys = { ArrowLeft: () => this.turn(-0.1, 0), ArrowRight: () => this.turn(0.1, 0), ArrowUp: () => this.turn(0, 0.1),
      ArrowDown: () => this.turn(0, -0.1), "+": () => this.zoom(0.9), "-": () => this.zoom(1 / 0.9) };
    c.addEventListener("keydown", (e) => { if (keys[e.key]) { e.preventDefault(); keys[e.key](); } });
  }
}
