import {
  ArrowHelper,
  Box3,
  BoxGeometry,
  CapsuleGeometry,
  CylinderGeometry,
  DirectionalLight,
  EdgesGeometry,
  GridHelper,
  Group,
  HemisphereLight,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  PerspectiveCamera,
  Quaternion,
  Raycaster,
  Scene,
  SphereGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
  type BufferGeometry,
  type Object3D,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Arm, ArmJoint } from "./api";

const kFieldOfView = 32; // degrees, upright
interface ViewLook {
  link: string;
  base: string;
  edge: string;
  grid: string;
  mark: string;
}

const kLooks: Record<"light" | "dark", ViewLook> = {
  light: { link: "#9aa7b3", base: "#5d6975", edge: "#17202a", grid: "#b4bec8", mark: "#17202a" },
  dark: { link: "#75818d", base: "#a0acb8", edge: "#e6eaee", grid: "#3d4853", mark: "#e6eaee" },
};

type Solid = Mesh<BufferGeometry, MeshLambertMaterial>;

/** A place in pixels of the picture; inside: in front of the camera. */
interface InPicture {
  x: number;
  y: number;
  inside: boolean;
}

/**
 * Draws the arm of docs/studio.md, and nothing else: where its links are the server has said. A picture is made
 * when something has changed, never by itself.
 */
export class ArmView {
  /** Null where the browser draws no WebGL. `onDraw` is called after every picture. */
  static in(host: HTMLElement, onDraw: () => void): ArmView | null {
    const canvas = document.createElement("canvas");
    const context = canvas.getContext("webgl2", { antialias: true, alpha: true });
    return context === null ? null : new ArmView(host, canvas, context, onDraw);
  }

  /** How many were drawn. */
  pictures = 0;
  readonly renderer: WebGLRenderer;
  readonly camera = new PerspectiveCamera(kFieldOfView, 1, 0.01, 100);
  private readonly scene = new Scene();
  private root: Group | null = null;
  private controls: OrbitControls | null = null;
  private frames: Group[] = [];
  private bodies: Solid[] = [];
  private centres: Object3D[] = [];
  private look: ViewLook = kLooks.light;
  /** What sizes are told in: a share of how far the arm reaches, m. */
  private unit = 1;
  private up = new Vector3(0, 0, 1);
  /** From the arm to the camera. */
  private direction = new Vector3();
  /** All that is in the picture, wherever the arm is. */
  private box = new Box3();
  private gravityAt: Vector3 | null = null;
  private gravityBox = new Box3();
  private isTurned = false; // by the reader: from then on it stays so
  private asked = false;

  private constructor(
    private readonly host: HTMLElement,
    canvas: HTMLCanvasElement,
    context: WebGL2RenderingContext,
    private readonly onDraw: () => void,
  ) {
    this.renderer = new WebGLRenderer({ canvas, context });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    host.prepend(canvas);
    this.scene.add(new HemisphereLight("#ffffff", "#8a8f96", 2.2), this.camera);
    this.camera.add(new DirectionalLight("#ffffff", 1.6));
    new ResizeObserver(() => this.resize()).observe(host);
    canvas.addEventListener("webglcontextrestored", () => this.draw());
  }

  /** Another robot, or other colours of what is not an error. */
  build(arm: Arm, isDark: boolean) {
    this.root?.removeFromParent();
    this.root?.traverse(dispose);
    this.look = kLooks[isDark ? "dark" : "light"];
    this.unit = 0.03 * reachOf(arm);
    const root = new Group();
    this.root = root;
    this.scene.add(root);
    this.frames = arm.joints.map(() => new Group());
    this.centres = [];
    this.bodies = [];
    root.add(...this.frames);
    arm.joints.forEach((joint, index) => this.addJoint(joint, index, root));
    for (const joint of arm.joints.slice(0, 1)) this.addBase(joint, root);
    this.addGround(arm, root);
    this.box = new Box3(vectorOf(arm.low_m), vectorOf(arm.high_m));
    this.box.union(this.gravityBox).expandByScalar(2.5 * this.unit);
    if (this.controls === null) this.setUpCamera(arm);
  }

  private addJoint(joint: ArmJoint, index: number, root: Group) {
    const frame = this.frames[index];
    if (frame === undefined) return;
    const size = this.unit * (1 - 0.025 * index);
    const axis = vectorOf(joint.axis);
    const shape =
      joint.type === "revolute"
        ? new CylinderGeometry(1.5 * size, 1.5 * size, 3.4 * size, 28)
        : new BoxGeometry(2.8 * size, 4.2 * size, 2.8 * size);
    const body = this.solid(shape, this.look.link);
    body.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), axis);
    body.userData.joint = index;
    frame.add(body);
    this.bodies.push(body);
    const rod = this.rod([0, 0, 0], joint.end_m, 0.75 * size, this.look.link);
    if (rod) frame.add(rod);
    const before = this.frames[index - 1] ?? root;
    const [start, end] = joint.rail_m ?? [];
    const rail = start && end && this.rod(start, end, 0.5 * size, this.look.base);
    if (rail) before.add(rail);
    const centre = new Mesh(
      new SphereGeometry(0.95 * size, 20, 14),
      new MeshLambertMaterial({ color: this.look.mark }),
    );
    centre.position.fromArray(joint.centre_of_mass_m);
    frame.add(centre);
    this.centres.push(centre);
  }

  private addBase(joint: ArmJoint, root: Group) {
    const size = 3.2 * this.unit;
    root.add(this.solid(new BoxGeometry(size, size, size), this.look.base));
    const rod = this.rod([0, 0, 0], joint.origin_m, this.unit, this.look.base);
    if (rod) root.add(rod);
  }

  /** A grid square to gravity below all that moves. */
  private addGround(arm: Arm, root: Group) {
    const gravity = vectorOf(arm.gravity_m_s2);
    this.up = gravity.lengthSq() > 0 ? gravity.clone().normalize().negate() : new Vector3(0, 0, 1);
    const [low, high] = [vectorOf(arm.low_m), vectorOf(arm.high_m)];
    const lowest = Math.min(...corners(new Box3(low, high)).map((corner) => corner.dot(this.up)));
    const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), this.up);
    const grid = new GridHelper(2.4 * reachOf(arm), 12, this.look.grid, this.look.grid);
    grid.quaternion.copy(turn);
    grid.position.copy(this.up).multiplyScalar(lowest - 3 * this.unit);
    root.add(grid);
    this.addGravity(gravity.lengthSq() > 0, low.add(high).multiplyScalar(0.5), root);
  }

  /** The arrow stands beside the base, where the arm is not. */
  private addGravity(isThere: boolean, middle: Vector3, root: Group) {
    this.gravityAt = null;
    this.gravityBox = new Box3(new Vector3(), new Vector3());
    if (!isThere) return;
    const aside = middle.addScaledVector(this.up, -middle.dot(this.up)).negate();
    if (aside.length() < this.unit) aside.copy(horizontal(this.up));
    const start = aside.setLength(7 * this.unit).addScaledVector(this.up, 5 * this.unit);
    const length = 9 * this.unit;
    const down = this.up.clone().negate();
    root.add(new ArrowHelper(down, start, length, this.look.mark, 2.4 * this.unit, 1.5 * this.unit));
    this.gravityAt = start;
    this.gravityBox.expandByPoint(start).expandByPoint(start.clone().addScaledVector(down, length));
  }

  private solid(geometry: BufferGeometry, color: string): Solid {
    const body = new Mesh(geometry, new MeshLambertMaterial({ color }));
    const edges = new EdgesGeometry(geometry, 40);
    body.add(new LineSegments(edges, new LineBasicMaterial({ color: this.look.edge })));
    return body;
  }

  /** A capsule between two places of one frame; none where they are one. */
  private rod(from: number[], to: number[], radius: number, color: string): Solid | null {
    const [start, end] = [vectorOf(from), vectorOf(to)];
    const way = end.clone().sub(start);
    const length = way.length();
    if (length < 1e-3 * this.unit) return null;
    const body = new Mesh(
      new CapsuleGeometry(radius, length, 6, 16),
      new MeshLambertMaterial({ color }),
    );
    body.position.copy(start).addScaledVector(way, 0.5);
    body.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), way.divideScalar(length));
    return body;
  }

  /**
   * From the side of a plane arm, so that it is seen as it moves; otherwise from a corner. The vertical of the
   * picture is that of gravity.
   */
  private setUpCamera(arm: Arm) {
    this.camera.up.copy(this.up);
    const controls = new OrbitControls(this.camera, this.renderer.domElement);
    controls.enablePan = false;
    controls.addEventListener("change", () => this.draw());
    controls.addEventListener("start", () => (this.isTurned = true));
    this.controls = controls;
    const side = horizontal(this.up);
    const normal = planeNormal(arm);
    if (normal !== null && Math.abs(normal.dot(this.up)) < 0.9) {
      const across = new Vector3().crossVectors(normal, this.up).normalize();
      this.direction.copy(normal).addScaledVector(across, 0.25).addScaledVector(this.up, 0.25);
    } else {
      const ahead = new Vector3().crossVectors(this.up, side);
      this.direction.copy(side).addScaledVector(ahead, -0.9).addScaledVector(this.up, 0.55);
    }
    this.direction.normalize();
    this.resize();
    this.showAll();
  }

  /** So that all that moves is in the picture, wherever the arm is. */
  showAll() {
    const { controls } = this;
    if (controls === null) return;
    this.isTurned = false;
    const middle = this.box.getCenter(new Vector3());
    const right = new Vector3().crossVectors(this.up, this.direction).normalize();
    const above = new Vector3().crossVectors(this.direction, right);
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
    controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(this.direction, 1.05 * distance);
    this.camera.near = distance / 100;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    controls.minDistance = distance / 6;
    controls.maxDistance = distance * 4;
    controls.update();
    this.draw();
  }

  /** The arm at an instant of the server's answer. */
  pose(arm: Arm, instant: number) {
    this.frames.forEach((frame, joint) => {
      frame.position.fromArray(arm.place_m[joint] ?? [], 3 * instant);
      frame.quaternion.fromArray(arm.turn[joint] ?? [], 4 * instant);
    });
    this.draw();
  }

  /** A colour for every joint. */
  colour(colours: string[]) {
    this.bodies.forEach((body, index) => body.material.color.set(colours[index] ?? this.look.link));
    this.draw();
  }

  showCentres(shown: boolean) {
    for (const centre of this.centres) centre.visible = shown;
    this.draw();
  }

  /** Where the joints, and the arrow of gravity after them, are in the picture: pixels. */
  places() {
    const { clientWidth: width, clientHeight: height } = this.host;
    const at = new Vector3();
    const inPicture = (place: Vector3): InPicture => {
      place.project(this.camera);
      return { x: ((place.x + 1) / 2) * width, y: ((1 - place.y) / 2) * height, inside: Math.abs(place.z) < 1 };
    };
    const joints = this.frames.map((frame) => inPicture(frame.getWorldPosition(at)));
    return { joints, gravity: this.gravityAt && inPicture(at.copy(this.gravityAt)) };
  }

  /** The joint, from 0, that is drawn at a pixel of the picture; null: none. */
  jointAt(x: number, y: number): number | null {
    const { clientWidth: width, clientHeight: height } = this.host;
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2((2 * x) / width - 1, 1 - (2 * y) / height), this.camera);
    const [hit] = ray.intersectObjects(this.bodies, false);
    return hit ? (hit.object.userData.joint as number) : null;
  }

  turn(right: number, up: number) {
    this.isTurned = true;
    this.controls?.rotateLeft(-0.15 * right);
    this.controls?.rotateUp(-0.15 * up);
  }

  nearer(factor: number) {
    this.isTurned = true;
    if (factor > 1) this.controls?.dollyIn(factor);
    else this.controls?.dollyOut(1 / factor);
  }

  private resize() {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.controls !== null && !this.isTurned) this.showAll();
    this.draw();
  }

  /** Once before the next frame, however much has changed. */
  private draw() {
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

/** Of x, y, z. */
function vectorOf(place: number[]): Vector3 {
  return new Vector3().fromArray(place);
}

function corners({ min, max }: Box3) {
  return [0, 1, 2, 3, 4, 5, 6, 7].map(
    (corner) =>
      new Vector3(corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y, corner & 4 ? max.z : min.z),
  );
}

/** Some direction square to `up`. */
function horizontal(up: Vector3) {
  const side = new Vector3(1, 0, 0);
  if (Math.abs(side.dot(up)) > 0.9) side.set(0, 1, 0);
  return side.addScaledVector(up, -side.dot(up)).normalize();
}

/** What all axes of a plane arm are square to, in the base frame; null: it is none. */
function planeNormal(arm: Arm): Vector3 | null {
  let normal: Vector3 | null = null;
  for (const [index, joint] of arm.joints.entries()) {
    const turn = new Quaternion().fromArray(arm.turn[index] ?? []);
    const axis = vectorOf(joint.axis).applyQuaternion(turn);
    if (joint.type !== "revolute") continue;
    if (normal === null) normal = axis;
    else if (Math.abs(normal.dot(axis)) < 0.99) return null;
  }
  return normal;
}

/** How far the arm reaches, m. */
function reachOf({ reach_m }: Arm): number {
  return reach_m ?? 1;
}

/** Gives back what a part of the picture holds in the graphics processor. */
function dispose(node: Object3D) {
  const { geometry, material } = node as Partial<Mesh>;
  geometry?.dispose();
  if (Array.isArray(material)) material.forEach((each) => each.dispose());
  else material?.dispose();
}
