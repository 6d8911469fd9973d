import { AmbientLight, Color, DirectionalLight, IcosahedronGeometry, InstancedMesh, Matrix4,
  MeshLambertMaterial, PerspectiveCamera, Quaternion, Scene, Vector3, WebGLRenderer } from "three";

const plain = new Color("#b8ab98"), withSensor = new Color("#2f86d6"), alarmed = new Color("#e0463c");

/// Rocks as clumps of spheres: one instance for each sphere, placed by the pose of its body.
export class Rocks {
  constructor(canvas) {
    this.canvas = canvas;
    this.bodies = [];
    this.alarms = new Set();
    this.view = { turn: 0.7, tilt: 0.35, distance: 1, centre: new Vector3() };
    this.world = new Scene();
    this.camera = new PerspectiveCamera(35, 1, 0.001, 100);
    this.camera.up.set(0, 0, 1);
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(1, -0.6, 1.5);
    this.world.add(new AmbientLight(0xffffff, 1.1), sun);
    try {
      this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    } catch (error) { this.renderer = null; }
    this.listen();
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  scene({ shapes, bodies }) {
    this.bodies = bodies.map(([id, shape, radius, sensor]) => ({ id, balls: shapes[shape] ?? [], radius, sensor }));
    const count = this.bodies.reduce((sum, b) => sum + b.balls.length, 0);
    if (this.mesh) { this.world.remove(this.mesh); this.mesh.dispose(); }
    const detail = count > 30000 ? 1 : 2;
    this.mesh = new InstancedMesh(new IcosahedronGeometry(1, detail), new MeshLambertMaterial(), Math.max(1, count));
    this.mesh.count = 0;
    this.mesh.frustumCulled = false;
    this.world.add(this.mesh);
    this.placed = null;
    if (this.waiting) this.poses(this.waiting);
  }

  /// Payload of bris/poses; null: it does not fit the scene.
  poses(payload) {
    this.waiting = payload;
    const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
    if (payload.byteLength < 16 || view.getUint8(0) !== 1) return null;
    const n = view.getUint32(4, true), time = view.getFloat64(8, true);
    if (payload.byteLength !== 16 + 28 * n || n !== this.bodies.length) return null;
    this.placed = [];
    for (let b = 0; b < n; ++b) {
      const f = (k) => view.getFloat32(16 + 28 * b + 4 * k, true);
      this.placed.push({ position: new Vector3(f(0), f(1), f(2)), attitude: new Quaternion(f(4), f(5), f(6), f(3)) });
    }
    this.time = time;
    if (!this.aimed) this.aim();
    this.place();
    return { bodies: n, time };
  }

  place() {
    if (!this.placed || !this.mesh) return;
    const at = new Vector3(), scale = new Vector3(), matrix = new Matrix4();
    let k = 0;
    this.bodies.forEach((body, b) => {
      if (this.onlySensors && !body.sensor) return;
      const { position, attitude } = this.placed[b];
      const colour = this.alarms.has(body.sensor) && body.sensor ? alarmed : body.sensor ? withSensor : plain;
      for (const [x, y, z, r] of body.balls) {
        at.set(x, y, z).multiplyScalar(body.radius).applyQuaternion(attitude).add(position);
        matrix.compose(at, attitude, scale.setScalar(r * body.radius));
        this.mesh.setMatrixAt(k, matrix);
        this.mesh.setColorAt(k++, colour);
      }
    });
    this.mesh.count = k;
    this.mesh.instanceMatrix.needsUpdate = true;
    if (this.mesh.instanceColor) this.mesh.instanceColor.needsUpdate = true;
    this.draw();
  }

  aim() {
    const low = new Vector3(Infinity, Infinity, Infinity), high = low.clone().negate();
    for (const { position } of this.placed) { low.min(position); high.max(position); }
    this.view.centre.copy(low).add(high).multiplyScalar(0.5);
    this.view.distance = 1.9 * Math.max(1e-3, high.distanceTo(low));
    this.aimed = true;
  }

  alarm(ids) { this.alarms = ids; this.place(); }
  only(sensors) { this.onlySensors = sensors; this.place(); }

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
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(w, h, false);
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
