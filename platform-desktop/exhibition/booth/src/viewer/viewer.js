// Turns the booth's GLB models: one mesh of corners, normals and numbers of corners, in this order.
import * as THREE from "./three.module.min.js";
import { OrbitControls } from "./OrbitControls.js";

const ELEMENTS = { 5126: Float32Array, 5125: Uint32Array };
const STEP = Math.PI / 24;

function readGlb(bytes) {
  const view = new DataView(bytes);
  if (view.getUint32(0, true) !== 0x46546c67) throw new Error("no GLB");
  const length = view.getUint32(12, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 20, length)));
  const start = 20 + length + 8;
  const read = (number) => {
    const accessor = head.accessors[number];
    const { byteOffset } = head.bufferViews[accessor.bufferView];
    const count = accessor.count * (accessor.type === "VEC3" ? 3 : 1);
    return new ELEMENTS[accessor.componentType](bytes, start + byteOffset, count);
  };
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(read(0), 3));
  geometry.setAttribute("normal", new THREE.BufferAttribute(read(1), 3));
  geometry.setIndex(new THREE.BufferAttribute(read(2), 1));
  return geometry;
}

function show(canvas, geometry) {
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xe7e3db);
  scene.add(new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ color: 0xd8cfbd, roughness: 0.85 })));
  scene.add(new THREE.HemisphereLight(0xffffff, 0x8a8070, 1.6));
  const camera = new THREE.PerspectiveCamera(35, 1, 0.001, 1000);
  const sun = new THREE.DirectionalLight(0xffffff, 2.2);
  sun.position.set(-1, 1.5, 1);
  camera.add(sun);
  scene.add(camera);

  geometry.computeBoundingSphere();
  const { center, radius } = geometry.boundingSphere;
  // All of it is seen, also where the canvas is narrower than high.
  const half = Math.tan((35 / 2) * (Math.PI / 180)) * Math.min(1, canvas.clientWidth / canvas.clientHeight || 1);
  const far = radius / Math.sin(Math.atan(half));
  camera.near = far / 100;
  camera.far = far * 10;
  camera.position.copy(center).add(new THREE.Vector3(0.45, 0.3, 1).setLength(far * 1.02));
  const controls = new OrbitControls(camera, canvas);
  controls.target.copy(center);
  controls.enablePan = false;
  controls.minDistance = radius * 1.1;
  controls.maxDistance = far * 3;

  const draw = () => renderer.render(scene, camera);
  const fit = () => {
    const { clientWidth: width, clientHeight: height } = canvas;
    if (!width || !height) return;
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    draw();
  };
  controls.addEventListener("change", draw);
  new ResizeObserver(fit).observe(canvas);
  canvas.addEventListener("keydown", (event) => {
    const way = new THREE.Spherical().setFromVector3(camera.position.clone().sub(center));
    const change = {
      ArrowLeft: () => { way.theta -= STEP; },
      ArrowRight: () => { way.theta += STEP; },
      ArrowUp: () => { way.phi -= STEP; },
      ArrowDown: () => { way.phi += STEP; },
      "+": () => { way.radius *= 0.9; },
      "-": () => { way.radius /= 0.9; },
    }[event.key];
    if (!change) return;
    event.preventDefault();
    change();
    way.makeSafe();
    camera.position.setFromSpherical(way).add(center);
    controls.update();
  });
  controls.update();
  fit();
  canvas.dataset.ready = "yes";
  canvas.focus({ preventScroll: true });
}

for (const viewer of document.querySelectorAll(".viewer")) {
  const [button, canvas, how] = viewer.children;
  button.addEventListener("click", async () => {
    button.disabled = true;
    try {
      const answer = await fetch(viewer.dataset.model);
      if (!answer.ok) throw new Error(answer.statusText);
      const geometry = readGlb(await answer.arrayBuffer());
      button.hidden = true;
      canvas.hidden = false;
      how.hidden = false;
      show(canvas, geometry);
    } catch (error) {
      console.warn(error);
      canvas.hidden = true;
      how.hidden = false;
      how.textContent = viewer.dataset.fault;
      button.hidden = false;
      button.disabled = false;
    }
  });
}
