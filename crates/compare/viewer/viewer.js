// Makes the pictures of surfaces on this page turnable.
//
// An element `[data-surface="ID"]` holds a still <img>; its mesh stands as base64 text in
// <script type="application/octet-stream" id="surface-ID">. Each gets a button that puts a canvas over the
// still, seen from the still's own camera. Where the browser lacks WebGL 2 or DecompressionStream, nothing
// changes and the stills stay.

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  IcosahedronGeometry,
  InstancedMesh,
  MathUtils,
  Matrix4,
  Mesh,
  PerspectiveCamera,
  Scene,
  ShaderMaterial,
  SRGBColorSpace,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";

// Browsers drop the oldest of about 16 WebGL contexts without asking; phones allow fewer.
const MOST_VIEWS = 4;
const KEY_STEP = Math.PI / 24;
const STYLE = `
[data-surface] { position: relative; }
[data-surface] > canvas { position: absolute; max-width: 100%; cursor: grab; touch-action: none; }
[data-surface] > canvas:active { cursor: grabbing; }
[data-surface] > canvas:focus-visible { outline: 2px solid #1a5fb4; }
[data-surface] > .turn {
  position: absolute; padding: .3em .8em; border: 1px solid #8888; border-radius: 1em;
  font: inherit; font-size: .8rem; color: #222; background: #fffd; cursor: pointer;
}
[data-surface] > .turn:hover { background: #eee; }
[data-surface] > .turn:focus-visible { outline: 2px solid #1a5fb4; outline-offset: 1px; }
@media screen { img.turned { visibility: hidden; } }
@media print { [data-surface] > canvas, [data-surface] > .turn { display: none; } }
`;

// --- The payload, as src/report/surface_payload.rs writes it

const MAGIC = 0x3156534d; // "MSV1"

async function decode(base64) {
  const packed = Uint8Array.from(atob(base64.trim()), (letter) => letter.charCodeAt(0));
  const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const buffer = await new Response(unpacked).arrayBuffer();
  let at = 0;
  const take = (type, count) => {
    const values = new type(buffer, at, count);
    at += values.byteLength;
    return values;
  };
  const [magic, vertices, triangles, segments, points] = take(Uint32Array, 5);
  if (magic !== MAGIC) throw new Error("unknown format");
  const [low, high, eye, target, up] = Array.from({ length: 5 }, () => [...take(Float32Array, 3)]);
  const [fieldOfView, lineWidth, pointRadius] = take(Float32Array, 3);
  const index = take(Uint32Array, 3 * triangles);
  const inBox = (count) =>
    Float32Array.from(take(Uint16Array, 3 * count), (value, i) => {
      const axis = i % 3;
      return low[axis] + (value / 65535) * (high[axis] - low[axis]);
    });
  const surface = {
    positions: inBox(vertices),
    segments: inBox(2 * segments),
    points: inBox(points),
    colours: take(Uint8Array, 3 * vertices),
    lineColour: take(Uint8Array, 3),
    pointColour: take(Uint8Array, 3),
  };
  return { ...surface, index, low, high, eye, target, up, fieldOfView, lineWidth, pointRadius };
}

// --- The scene

const linear = ([r, g, b]) => new Color().setRGB(r / 255, g / 255, b / 255, SRGBColorSpace);

// Clay under lamps that move with the camera, as in the stills: a key light from the upper left, a weak fill
// from the right, a sky brighter than the ground, and a darker rim where the surface turns away.
const VERTEX = `
  uniform vec3 tint;
  varying vec3 paint, across, towards;
  void main() {
    vec4 place = vec4(position, 1.0);
    #ifdef USE_INSTANCING
      place = instanceMatrix * place;
    #endif
    place = modelViewMatrix * place;
    paint = tint;
    #ifdef USE_COLOR
      paint *= color;
    #endif
    across = normalMatrix * normal;
    towards = -place.xyz;
    gl_Position = projectionMatrix * place;
  }`;
const FRAGMENT = `
  varying vec3 paint, across, towards;
  const vec3 key = vec3(-0.42, 0.66, 0.62), fill = vec3(0.80, 0.10, 0.59);
  const vec3 inside = vec3(0.62, 0.42, 0.30);
  void main() {
    vec3 n = normalize(across) * (gl_FrontFacing ? 1.0 : -1.0), eye = normalize(towards);
    float sky = mix(0.20, 0.46, 0.5 + 0.5 * n.y);
    float light = sky + 0.66 * max(dot(n, key), 0.0) + 0.16 * max(dot(n, fill), 0.0);
    float rim = 1.0 - 0.30 * pow(1.0 - clamp(dot(n, eye), 0.0, 1.0), 3.0);
    float shine = 0.05 * pow(max(dot(n, normalize(key + eye)), 0.0), 24.0);
    vec3 colour = gl_FrontFacing ? paint : paint * inside;
    gl_FragColor = vec4(mix(colour * light * rim, vec3(1.0), shine), 1.0);
    #include <colorspace_fragment>
  }`;

function clay(options) {
  const uniforms = { tint: { value: new Color(1, 1, 1) } };
  return new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms, ...options });
}

function sheet(surface) {
  const table = Float32Array.from({ length: 256 }, (_, value) => linear([value, value, value]).r);
  const geometry = new BufferGeometry();
  geometry.setIndex(new BufferAttribute(surface.index, 1));
  geometry.setAttribute("position", new BufferAttribute(surface.positions, 3));
  const colours = Float32Array.from(surface.colours, (value) => table[value]);
  geometry.setAttribute("color", new BufferAttribute(colours, 3));
  geometry.computeVertexNormals();
  // Pushed back by as much as it may slope under half of a line, so that lines are in front of it.
  const behind = { polygonOffset: true, polygonOffsetFactor: 1 + surface.lineWidth / 2, polygonOffsetUnits: 1 };
  return new Mesh(geometry, clay({ vertexColors: true, side: DoubleSide, ...behind }));
}

function lines(surface) {
  const geometry = new LineSegmentsGeometry().setPositions(surface.segments);
  return new LineSegments2(geometry, new LineMaterial({ color: linear(surface.lineColour) }));
}

function spheres(surface) {
  const count = surface.points.length / 3;
  const ball = new IcosahedronGeometry(surface.pointRadius, count > 2000 ? 1 : 2);
  const tint = { value: linear(surface.pointColour) };
  const mesh = new InstancedMesh(ball, clay({ uniforms: { tint } }), count);
  const place = new Matrix4();
  for (let i = 0; i < count; i++) {
    mesh.setMatrixAt(i, place.makeTranslation(...surface.points.subarray(3 * i, 3 * i + 3)));
  }
  return mesh;
}

// --- Views, each with a renderer from a small pool

const views = [];
const idle = [];

function newRenderer() {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("webgl2", { antialias: true, alpha: false });
  if (!context) return null;
  const renderer = new WebGLRenderer({ canvas, context });
  renderer.setClearColor(0xffffff);
  return renderer;
}

function takeRenderer() {
  if (!idle.length && views.length >= MOST_VIEWS) views[0].close();
  const renderer = idle.pop() ?? newRenderer();
  if (renderer || !views.length) return renderer;
  // A browser that gives fewer contexts than thought.
  views[0].close();
  return idle.pop();
}

function openView(surface, still, onClose) {
  const renderer = takeRenderer();
  if (!renderer) throw new Error("the browser gives no WebGL context");
  const canvas = renderer.domElement;
  const scene = new Scene();
  const parts = [sheet(surface)];
  if (surface.segments.length) parts.push(lines(surface));
  if (surface.points.length) parts.push(spheres(surface));
  scene.add(...parts);

  const camera = new PerspectiveCamera(MathUtils.radToDeg(surface.fieldOfView));
  camera.position.fromArray(surface.eye);
  camera.up.fromArray(surface.up);
  const controls = new OrbitControls(camera, canvas);
  controls.target.fromArray(surface.target);
  const centre = new Vector3().fromArray(surface.low).add(new Vector3().fromArray(surface.high)).divideScalar(2);
  const radius = centre.distanceTo(new Vector3().fromArray(surface.high)) + surface.pointRadius;
  controls.minDistance = 0.05 * radius;
  controls.maxDistance = Math.max(20 * radius, 2 * camera.position.distanceTo(controls.target));
  controls.update();
  controls.saveState();

  let frame = 0;
  const draw = () => {
    frame = 0;
    const distance = camera.position.distanceTo(centre);
    camera.far = distance + 1.1 * radius;
    camera.near = Math.max(distance - 1.1 * radius, 0.002 * camera.far);
    camera.updateProjectionMatrix();
    renderer.render(scene, camera);
  };
  const drawSoon = () => (frame ||= requestAnimationFrame(draw));
  const resize = () => {
    const [width, height] = [still.clientWidth, still.clientHeight];
    if (!width || !height) return;
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    renderer.setSize(width, height);
    placeOver(still, canvas);
    camera.aspect = width / height;
    // The width is told in pixels of the still, which is shown smaller or larger than it is.
    const scale = still.naturalWidth ? width / still.naturalWidth : 1;
    for (const part of parts) if (part.isLineSegments2) part.material.linewidth = Math.max(surface.lineWidth * scale, 0.75);
    draw();
  };
  const onKey = (event) => {
    const act = {
      ArrowLeft: () => controls.rotateLeft(KEY_STEP),
      ArrowRight: () => controls.rotateLeft(-KEY_STEP),
      ArrowUp: () => controls.rotateUp(KEY_STEP),
      ArrowDown: () => controls.rotateUp(-KEY_STEP),
      "+": () => controls.dollyIn(0.9),
      "-": () => controls.dollyOut(0.9),
      0: () => controls.reset(),
      Escape: () => view.close(),
    }[event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    act();
  };
  const onReset = () => controls.reset();
  const onLost = () => view.close("lost");
  const sizes = new ResizeObserver(resize);

  const view = {
    close(lost) {
      views.splice(views.indexOf(view), 1);
      cancelAnimationFrame(frame);
      sizes.disconnect();
      controls.dispose();
      canvas.removeEventListener("keydown", onKey);
      canvas.removeEventListener("dblclick", onReset);
      canvas.removeEventListener("webglcontextlost", onLost);
      for (const part of parts) {
        part.geometry.dispose();
        part.material.dispose();
        part.dispose?.();
      }
      const hadFocus = document.activeElement === canvas;
      canvas.remove();
      if (!lost) idle.push(renderer);
      still.classList.remove("turned");
      onClose(hadFocus);
    },
  };
  views.push(view);
  controls.addEventListener("change", drawSoon);
  canvas.addEventListener("keydown", onKey);
  canvas.addEventListener("dblclick", onReset);
  canvas.addEventListener("webglcontextlost", onLost);
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "application");
  canvas.setAttribute("aria-label", `${still.alt || "Surface"}. Arrow keys turn, plus and minus zoom, 0 resets.`);
  canvas.title = "Drag to turn, scroll or pinch to zoom, double-click to reset";
  resize();
  still.after(canvas);
  still.classList.add("turned");
  sizes.observe(still);
  return view;
}

// --- The page

function placeOver(still, canvas) {
  canvas.style.left = `${still.offsetLeft + still.clientLeft}px`;
  canvas.style.top = `${still.offsetTop + still.clientTop}px`;
}

function addButton(element) {
  const still = element.querySelector("img");
  const payload = document.getElementById(`surface-${element.dataset.surface}`);
  if (!still || !payload) return;
  const button = document.createElement("button");
  button.type = "button";
  button.className = "turn";
  const label = (text) => {
    button.textContent = text;
    button.setAttribute("aria-label", still.alt ? `${text}: ${still.alt}` : text);
  };
  let view = null;
  const onClose = (hadFocus) => {
    view = null;
    label("Turn it");
    if (hadFocus) button.focus({ preventScroll: true });
  };
  const toggle = async () => {
    if (view) return view.close();
    button.disabled = true;
    try {
      const surface = await decode(payload.textContent).catch(() => {
        throw new Error("its data are damaged");
      });
      view = openView(surface, still, onClose);
      button.disabled = false;
      label("Back to the picture");
    } catch (error) {
      label(`No 3D view: ${error.message}`);
    }
  };
  button.addEventListener("click", toggle);
  label("Turn it");
  element.append(button);
  const place = () => {
    button.style.right = `${element.clientWidth - still.offsetLeft - still.offsetWidth + 8}px`;
    button.style.top = `${still.offsetTop + 8}px`;
  };
  const sizes = new ResizeObserver(place);
  sizes.observe(still);
  sizes.observe(element);
}

function start() {
  const elements = document.querySelectorAll("[data-surface]");
  if (!elements.length || typeof DecompressionStream === "undefined") return;
  const first = newRenderer();
  if (!first) return;
  idle.push(first);
  const style = document.createElement("style");
  style.textContent = STYLE;
  document.head.append(style);
  elements.forEach(addButton);
}

if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", start);
else start();
