import * as three from "./three.module.min.js";
import { OrbitControls } from "./orbit_controls.js";

const kFieldOfView = 32; // degrees, upright
const kLooks = {
  light: { link: "#9aa7b3", base: "#5d6975", edge: "#17202a", grid: "#b4bec8", mark: "#17202a" },
  dark: { link: "#75818d", base: "#a0acb8", edge: "#e6eaee", grid: "#3d4853", mark: "#e6eaee" },
};

/**
 * Draws the arm of docs/studio.md, and nothing else: where its links are the server has said. A picture is made
 * when something has changed, never by itself.
 */
export class ArmView {
  /** Null where the browser draws no WebGL. `onDraw` is called after every picture. */
  static in(host, onDraw) {
    const canvas = document.createElement("canvas");
    const context = canvas.getContext("webgl2", { antialias: true, alpha: true });
    return context === null ? null : new ArmView(host, canvas, context, onDraw);
  }

  constructor(host, canvas, context, onDraw) {
    this.host = host;
    this.onDraw = onDraw;
    this.pictures = 0;
    this.renderer = new three.WebGLRenderer({ canvas, context });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    host.prepend(canvas);
    this.scene = new three.Scene();
    this.camera = new three.PerspectiveCamera(kFieldOfView, 1, 0.01, 100);
    this.sky = new three.HemisphereLight("#ffffff", "#8a8f96", 2.2);
    this.sun = new three.DirectionalLight("#ffffff", 1.6);
    this.scene.add(this.sky, this.camera);
    this.camera.add(this.sun);
    this.controls = null;
    this.isTurned = false; // by the reader: from then on it stays so
    this.asked = false;
    new ResizeObserver(() => this.resize()).observe(host);
    canvas.addEventListener("webglcontextrestored", () => this.draw());
  }

  /** Another robot, or other colours of what is not an error. */
  build(arm, isDark) {
    this.root?.removeFromParent();
    this.root?.traverse((node) => {
      node.geometry?.dispose();
      node.material?.dispose();
    });
    this.look = kLooks[isDark ? "dark" : "light"];
    this.unit = 0.03 * arm.reach_m;
    this.root = new three.Group();
    this.scene.add(this.root);
    this.frames = arm.joints.map(() => new three.Group());
    this.centres = [];
    this.bodies = [];
    this.root.add(...this.frames);
    arm.joints.forEach((joint, index) => this.addJoint(joint, index));
    this.addBase(arm.joints[0]);
    this.addGround(arm);
    this.box = new three.Box3(new three.Vector3(...arm.low_m), new three.Vector3(...arm.high_m));
    this.box.union(this.gravityBox).expandByScalar(2.5 * this.unit);
    if (this.controls === null) this.setUpCamera(arm);
  }

  addJoint(joint, index) {
    const frame = this.frames[index];
    const size = this.unit * (1 - 0.025 * index);
    const axis = new three.Vector3(...joint.axis);
    const shape =
      joint.type === "revolute"
        ? new three.CylinderGeometry(1.5 * size, 1.5 * size, 3.4 * size, 28)
        : new three.BoxGeometry(2.8 * size, 4.2 * size, 2.8 * size);
    const body = this.solid(shape, this.look.link);
    body.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), axis);
    body.userData.joint = index;
    frame.add(body);
    this.bodies.push(body);
    const rod = this.rod([0, 0, 0], joint.end_m, 0.75 * size, this.look.link);
    if (rod) frame.add(rod);
    const before = index === 0 ? this.root : this.frames[index - 1];
    const rail = joint.rail_m && this.rod(...joint.rail_m, 0.5 * size, this.look.base);
    if (rail) before.add(rail);
    const centre = new three.Mesh(
      new three.SphereGeometry(0.95 * size, 20, 14),
      new three.MeshLambertMaterial({ color: this.look.mark }),
    );
    centre.position.set(...joint.centre_of_mass_m);
    frame.add(centre);
    this.centres.push(centre);
  }

  addBase(joint) {
    const size = 3.2 * this.unit;
    this.root.add(this.solid(new three.BoxGeometry(size, size, size), this.look.base));
    const rod = this.rod([0, 0, 0], joint.origin_m, this.unit, this.look.base);
    if (rod) this.root.add(rod);
  }

  /** A grid square to gravity below all that moves. */
  addGround(arm) {
    const gravity = new three.Vector3(...arm.gravity_m_s2);
    this.up = gravity.lengthSq() > 0 ? gravity.clone().normalize().negate() : new three.Vector3(0, 0, 1);
    const [low, high] = [new three.Vector3(...arm.low_m), new three.Vector3(...arm.high_m)];
    const lowest = Math.min(...corners(new three.Box3(low, high)).map((corner) => corner.dot(this.up)));
    const turn = new three.Quaternion().setFromUnitVectors(new three.Vector3(0, 1, 0), this.up);
    const grid = new three.GridHelper(2.4 * arm.reach_m, 12, this.look.grid, this.look.grid);
    grid.quaternion.copy(turn);
    grid.position.copy(this.up).multiplyScalar(lowest - 3 * this.unit);
    this.root.add(grid);
    this.addGravity(gravity.lengthSq() > 0, low.add(high).multiplyScalar(0.5));
  }

  /** The arrow stands beside the base, where the arm is not. */
  addGravity(isThere, middle) {
    this.gravityAt = null;
    this.gravityBox = new three.Box3(new three.Vector3(), new three.Vector3());
    if (!isThere) return;
    const aside = middle.addScaledVector(this.up, -middle.dot(this.up)).negate();
    if (aside.length() < this.unit) aside.copy(horizontal(this.up));
    const start = aside.setLength(7 * this.unit).addScaledVector(this.up, 5 * this.unit);
    const length = 9 * this.unit;
    const down = this.up.clone().negate();
    this.root.add(new three.ArrowHelper(down, start, length, this.look.mark, 2.4 * this.unit, 1.5 * this.unit));
    this.gravityAt = start;
    this.gravityBox.expandByPoint(start).expandByPoint(start.clone().addScaledVector(down, length));
  }

  solid(geometry, color) {
    const body = new three.Mesh(geometry, new three.MeshLambertMaterial({ color }));
    const edges = new three.EdgesGeometry(geometry, 40);
    body.add(new three.LineSegments(edges, new three.LineBasicMaterial({ color: this.look.edge })));
    return body;
  }

  /** A capsule between two places of one frame; none where they are one. */
  rod(from, to, radius, color) {
    const [start, end] = [new three.Vector3(...from), new three.Vector3(...to)];
    const way = end.clone().sub(start);
    const length = way.length();
    if (length < 1e-3 * this.unit) return null;
    const body = new three.Mesh(
      new three.CapsuleGeometry(radius, length, 6, 16),
      new three.MeshLambertMaterial({ color }),
    );
    body.position.copy(start).addScaledVector(way, 0.5);
    body.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), way.divideScalar(length));
    return body;
  }

  /**
   * From the side of a plane arm, so that it is seen as it moves; otherwise from a corner. The vertical of the
   * picture is that of gravity.
   */
  setUpCamera(arm) {
    this.camera.up.copy(this.up);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enablePan = false;
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("start", () => (this.isTurned = true));
    const side = horizontal(this.up);
    const normal = planeNormal(arm, this.frames);
    this.direction = new three.Vector3();
    if (normal !== null && Math.abs(normal.dot(this.up)) < 0.9) {
      const across = new three.Vector3().crossVectors(normal, this.up).normalize();
      this.direction.copy(normal).addScaledVector(across, 0.25).addScaledVector(this.up, 0.25);
    } else {
      const ahead = new three.Vector3().crossVectors(this.up, side);
      this.direction.copy(side).addScaledVector(ahead, -0.9).addScaledVector(this.up, 0.55);
    }
    this.direction.normalize();
    this.resize();
    this.showAll();
  }

  /** So that all that moves is in the picture, wherever the arm is. */
  showAll() {
    this.isTurned = false;
    const middle = this.box.getCenter(new three.Vector3());
    const right = new three.Vector3().crossVectors(this.up, this.direction).normalize();
    const above = new three.Vector3().crossVectors(this.direction, right);
    const upright = Math.tan((kFieldOfView * Math.PI) / 360);
    let distance = 0;
    for (const corner of corners(this.box)) {
      const away = corner.sub(middle);
      const needed = Math.max(
        Math.abs(away.dot(right)) / (upright * this.camera.aspect),
        Math.abs(away.dot(above)) / upright,
      );
      distance = Math.max(distance, needed + away.dot(this.direction));
    }
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(this.direction, 1.05 * distance);
    this.camera.near = distance / 100;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.controls.minDistance = distance / 6;
    this.controls.maxDistance = distance * 4;
    this.controls.update();
    this.draw();
  }

  /** The arm at an instant of the server's answer. */
  pose(arm, instant) {
    this.frames.forEach((frame, joint) => {
      frame.position.fromArray(arm.place_m[joint], 3 * instant);
      frame.quaternion.fromArray(arm.turn[joint], 4 * instant);
    });
    this.draw();
  }

  /** A colour for every joint. */
  colour(colours) {
    this.bodies.forEach((body, index) => body.material.color.set(colours[index]));
    this.draw();
  }

  showCentres(shown) {
    for (const centre of this.centres) centre.visible = shown;
    this.draw();
  }

  /** Where the joints, and the arrow of gravity after them, are in the picture: pixels. */
  places() {
    const { clientWidth: width, clientHeight: height } = this.host;
    const at = new three.Vector3();
    const inPicture = (place) => {
      place.project(this.camera);
      return { x: ((place.x + 1) / 2) * width, y: ((1 - place.y) / 2) * height, inside: Math.abs(place.z) < 1 };
    };
    const joints = this.frames.map((frame) => inPicture(frame.getWorldPosition(at)));
    return { joints, gravity: this.gravityAt && inPicture(at.copy(this.gravityAt)) };
  }

  /** The joint, from 0, that is drawn at a pixel of the picture; null: none. */
  jointAt(x, y) {
    const { clientWidth: width, clientHeight: height } = this.host;
    const ray = new three.Raycaster();
    ray.setFromCamera(new three.Vector2((2 * x) / width - 1, 1 - (2 * y) / height), this.camera);
    const [hit] = ray.intersectObjects(this.bodies, false);
    return hit ? hit.object.userData.joint : null;
  }

  turn(right, up) {
    this.isTurned = true;
    this.controls.rotateLeft(-0.15 * right);
    this.controls.rotateUp(-0.15 * up);
  }

  nearer(factor) {
    this.isTurned = true;
    if (factor > 1) this.controls.dollyIn(factor);
    else this.controls.dollyOut(1 / factor);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.controls !== null && !this.isTurned) this.showAll();
    this.draw();
  }

  /** Once before the next frame, however much has changed. */
  draw() {
    if (this.asked || !this.root) return;
    this.asked = true;
    requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    this.asked = false;
    this.renderer.render(this.scene, this.camera);
    this.pictures += 1;
    this.onDraw();
  }
}

function corners({ min, max }) {
  return [0, 1, 2, 3, 4, 5, 6, 7].map(
    (corner) =>
      new three.Vector3(corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y, corner & 4 ? max.z : min.z),
  );
}

/** Some direction square to `up`. */
function horizontal(up) {
  const side = new three.Vector3(1, 0, 0);
  if (Math.abs(side.dot(up)) > 0.9) side.set(0, 1, 0);
  return side.addScaledVector(up, -side.dot(up)).normalize();
}

/** What all axes of a plane arm are square to, in the base frame; null: it is none. */
function planeNormal(arm, frames) {
  let normal = null;
  for (const [index, joint] of arm.joints.entries()) {
    frames[index].quaternion.fromArray(arm.turn[index], 0);
    const axis = new three.Vector3(...joint.axis).applyQuaternion(frames[index].quaternion);
    if (joint.type !== "revolute") continue;
    if (normal === null) normal = axis;
    else if (Math.abs(normal.dot(axis)) < 0.99) return null;
  }
  return normal;
}
