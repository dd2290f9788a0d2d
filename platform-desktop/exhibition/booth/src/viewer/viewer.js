// Turns the booth's GLB models: one mesh of corners, normals and numbers of corners, in this order.
import * as THREE from "./three.module.min.js";
import { OrbitControls } from "./OrbitControls.js";

const ELEMENTS = { 5126: Float32Array, 5125: Uint32Array };
// As behind the pictures.
const GROUND = 0x5c5b59;
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

// The studio's tone curve, by its white point.
function toneCurve(white) {
  const plain = "vec3 CustomToneMapping( vec3 color ) { return color; }";
  const curve = `vec3 CustomToneMapping( vec3 color ) {
    color *= toneMappingExposure;
    return color * ( 1.0 + color / ${(white * white).toFixed(4)} ) / ( 1.0 + color );
  }`;
  const chunks = THREE.ShaderChunk;
  chunks.tonemapping_pars_fragment = chunks.tonemapping_pars_fragment.replace(plain, curve);
  return THREE.CustomToneMapping;
}

// The studio's light: a sun, whose shadows the sculpture throws on itself, and what comes from everywhere.
function lights({ sun, sunColour, ambient }, radius) {
  const direct = new THREE.DirectionalLight(new THREE.Color(...sunColour), Math.PI);
  direct.position.set(...sun).setLength(2 * radius);
  direct.castShadow = true;
  direct.shadow.mapSize.set(2048, 2048);
  Object.assign(direct.shadow.camera, {
    left: -radius, right: radius, top: radius, bottom: -radius, near: radius / 2, far: 3.5 * radius,
  });
  direct.shadow.normalBias = radius / 40;
  direct.shadow.radius = 6;
  const harmonics = new THREE.SphericalHarmonics3().fromArray(ambient.flat());
  return [direct, new THREE.LightProbe(harmonics, 1)];
}

function show(canvas, geometry, light) {
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
  renderer.toneMapping = toneCurve(light.white);
  renderer.shadowMap.enabled = true;
  geometry.center();
  geometry.computeBoundingSphere();
  const { radius } = geometry.boundingSphere;
  const stone = new THREE.MeshStandardMaterial({ color: new THREE.Color(...light.stone), roughness: 0.7 });
  const mesh = new THREE.Mesh(geometry, stone);
  mesh.castShadow = mesh.receiveShadow = true;
  const scene = new THREE.Scene();
  renderer.setClearColor(GROUND);
  scene.add(mesh, ...lights(light, radius));

  // All of it is seen, also where the canvas is narrower than high.
  const half = Math.tan((35 / 2) * (Math.PI / 180)) * Math.min(1, canvas.clientWidth / canvas.clientHeight || 1);
  const far = radius / Math.sin(Math.atan(half));
  // Hands move an orbit. The eye and the lights stand still, and the sculpture turns on its stool.
  const orbit = new THREE.PerspectiveCamera();
  const eye = new THREE.PerspectiveCamera(35, 1, far / 100, far * 10);
  const middle = new THREE.Vector3();
  orbit.position.setFromSphericalCoords(far * 1.02, Math.PI / 2 - light.elevation, light.azimuth);
  const controls = new OrbitControls(orbit, canvas);
  controls.enablePan = false;
  controls.minDistance = radius * 1.1;
  controls.maxDistance = far * 3;

  const draw = () => {
    const { radius: away, phi, theta } = new THREE.Spherical().setFromVector3(orbit.position);
    mesh.rotation.y = -theta;
    eye.position.setFromSphericalCoords(away, phi, 0);
    eye.lookAt(middle);
    renderer.render(scene, eye);
  };
  const fit = () => {
    const { clientWidth: width, clientHeight: height } = canvas;
    if (!width || !height) return;
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    renderer.setSize(width, height, false);
    eye.aspect = width / height;
    eye.updateProjectionMatrix();
    draw();
  };
  controls.addEventListener("change", draw);
  new ResizeObserver(fit).observe(canvas);
  canvas.addEventListener("keydown", (event) => {
    const way = new THREE.Spherical().setFromVector3(orbit.position);
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
    orbit.position.setFromSpherical(way);
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
      show(canvas, geometry, JSON.parse(viewer.dataset.light));
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
