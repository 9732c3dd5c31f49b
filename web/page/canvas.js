// Draws on a plain canvas where there is no graphics processor: capsules as their outlines, the farthest first. A
// processor draws a picture so in a few milliseconds, for which it would take a hundred times as long by shaders.

import { CAPSULE_FLOATS, CUBOID_FLOATS, VIEW_FLOATS } from "./module.js";

const SKY = ["#c3d2e2", "#dfe7ee"];
const GROUND = ["#dfe7ee", "#bfc4c9"];
const LINE = "rgb(120 128 136 / 55%)";
const SHADOW = "rgb(60 68 80 / 22%)";
const GRID = 12; // half side of the lines on the ground, m
const LOW = 0.3; // half the height of boxes that lie at everybody's feet, m
const NEAR = 0.05; // m
// Corners of a box, and its faces with the axis and the sign of their normals.
const CORNERS = [0, 1, 2, 3, 4, 5, 6, 7].map((at) => [at & 1 ? 1 : -1, at & 2 ? 1 : -1, at & 4 ? 1 : -1]);
const FACES = [
  [0, 1, [1, 3, 7, 5]], [0, -1, [0, 4, 6, 2]], [1, 1, [2, 6, 7, 3]],
  [1, -1, [0, 1, 5, 4]], [2, 1, [4, 5, 7, 6]], [2, -1, [0, 2, 3, 1]],
];

export class Canvas2d {
  name = "canvas (CPU)";

  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d", { alpha: false });
  }

  draw(picture) {
    const { canvas, pen } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const { views, capsules, cuboids } = picture(width / height);
    this.clip = views.slice(VIEW_FLOATS, VIEW_FLOATS + 16);
    this.eye = views.slice(VIEW_FLOATS + 32, VIEW_FLOATS + 35);
    this.sun = views.slice(VIEW_FLOATS + 36, VIEW_FLOATS + 39);
    // Pixels of a metre that is a metre away: the length of the picture's vertical.
    const [, , , , , up] = this.clip;
    this.pixels = 0.5 * height * Math.hypot(this.clip[1], up, this.clip[9]);
    this.ground(width, height);
    const balls = rows(capsules, CAPSULE_FLOATS);
    const boxes = rows(cuboids, CUBOID_FLOATS);
    pen.fillStyle = SHADOW;
    pen.beginPath();
    balls.forEach((capsule) => this.shadow(capsule));
    pen.fill("nonzero");
    const things = [
      ...boxes.map((box) => ({ far: this.distance(box) + (box[4] < LOW ? 1e3 : 0), draw: () => this.box(box) })),
      ...balls.map((ball) => ({ far: this.distance(middle(ball)), draw: () => this.capsule(ball) })),
    ];
    things.sort((a, b) => b.far - a.far).forEach(({ draw }) => draw());
  }

  // A point on the screen, and its depth; null behind the eye.
  seen([x, y, z]) {
    const { clip, canvas } = this;
    const w = clip[3] * x + clip[7] * y + clip[11] * z + clip[15];
    if (w < NEAR) return null;
    const across = clip[0] * x + clip[4] * y + clip[8] * z + clip[12];
    const up = clip[1] * x + clip[5] * y + clip[9] * z + clip[13];
    return [0.5 * canvas.width * (1 + across / w), 0.5 * canvas.height * (1 - up / w), w];
  }

  distance([x, y, z]) {
    return Math.hypot(x - this.eye[0], y - this.eye[1], z - this.eye[2]);
  }

  ground(width, height) {
    const { pen, eye, clip } = this;
    // The horizon is where what is very far away lies, whichever way the camera looks.
    const ahead = [-clip[3], -clip[11]].map((part) => -part / Math.hypot(clip[3], clip[11]));
    const horizon = this.seen([eye[0] + 1e4 * ahead[0], 0, eye[2] + 1e4 * ahead[1]])?.[1] ?? 0;
    const fill = (top, bottom, [from, to]) => {
      if (bottom <= top) return;
      const shade = pen.createLinearGradient(0, top, 0, bottom);
      shade.addColorStop(0, from);
      shade.addColorStop(1, to);
      pen.fillStyle = shade;
      pen.fillRect(0, top, width, bottom - top);
    };
    fill(0, Math.min(horizon, height), SKY);
    fill(Math.max(0, horizon), height, GROUND);
    const focus = [Math.round(eye[0] + 5 * ahead[0]), Math.round(eye[2] + 5 * ahead[1])];
    pen.strokeStyle = LINE;
    for (let at = -GRID; at <= GRID; at++) {
      const [x, z] = [focus[0] + at, focus[1] + at];
      pen.lineWidth = x % 5 === 0 ? 1.6 : 0.7;
      this.line([x, 0, focus[1] - GRID], [x, 0, focus[1] + GRID]);
      pen.lineWidth = z % 5 === 0 ? 1.6 : 0.7;
      this.line([focus[0] - GRID, 0, z], [focus[0] + GRID, 0, z]);
    }
  }

  // In pieces: what of it is behind the eye is left out.
  line(from, to) {
    const { pen } = this;
    const PIECES = 12;
    pen.beginPath();
    let drawn = false;
    for (let at = 0; at <= PIECES; at++) {
      const point = this.seen(from.map((value, axis) => value + (at / PIECES) * (to[axis] - value)));
      if (point) pen[drawn ? "lineTo" : "moveTo"](point[0], point[1]);
      drawn = Boolean(point);
    }
    pen.stroke();
  }

  // What a capsule keeps the sun from, on the ground.
  shadow(capsule) {
    const below = ([x, y, z]) => {
      const far = y / this.sun[1];
      return [x - far * this.sun[0], 0, z - far * this.sun[2]];
    };
    const ends = [capsule.slice(0, 3), capsule.slice(4, 7)].map((end) => this.seen(below(end)));
    if (ends.every(Boolean)) this.outline(ends, [capsule[3], capsule[7]], 0.6);
  }

  capsule(capsule) {
    const { pen } = this;
    const [a, b] = [capsule.slice(0, 3), capsule.slice(4, 7)];
    const ends = [this.seen(a), this.seen(b)];
    if (!ends.every(Boolean)) return;
    pen.beginPath();
    this.outline(ends, [capsule[3], capsule[7]], 1);
    // Light across it, from the side of the sun.
    const along = [0, 1].map((axis) => ends[1][axis] - ends[0][axis]);
    const length = Math.hypot(...along);
    const side = length > 0.5 ? [along[1] / length, -along[0] / length] : [-0.5, -0.85];
    const sunny = this.seen(a.map((value, axis) => value + 0.1 * this.sun[axis]));
    const towards = sunny ? (sunny[0] - ends[0][0]) * side[0] + (sunny[1] - ends[0][1]) * side[1] : 1;
    const [x, y, depth] = ends[0];
    const radius = (Math.sign(towards || 1) * this.pixels * Math.max(capsule[3], capsule[7])) / depth;
    const shade = pen.createLinearGradient(x + radius * side[0], y + radius * side[1], x - radius * side[0], y - radius * side[1]);
    const colour = capsule.slice(8, 11);
    shade.addColorStop(0, paint(colour, 1.25));
    shade.addColorStop(0.55, paint(colour, 0.85));
    shade.addColorStop(1, paint(colour, 0.45));
    pen.fillStyle = shade;
    pen.fill();
  }

  // Two circles and what lies between them; shadows are `flat`.
  outline([[ax, ay, aw], [bx, by, bw]], [radiusA, radiusB], flat) {
    const { pen } = this;
    const [a, b] = [Math.max(0.6, (this.pixels * radiusA) / aw), Math.max(0.6, (this.pixels * radiusB) / bw)];
    const circle = (x, y, radius) => {
      pen.moveTo(x + radius, y);
      pen.ellipse(x, y, radius, flat * radius, 0, 0, 2 * Math.PI);
    };
    circle(ax, ay, a);
    circle(bx, by, b);
    const [dx, dy] = [bx - ax, by - ay];
    const length = Math.hypot(dx, dy);
    if (length <= Math.abs(a - b)) return;
    const angle = Math.atan2(dy, dx);
    const open = Math.acos((a - b) / length);
    const at = (x, y, radius, turn) => [x + radius * Math.cos(angle + turn), y + flat * radius * Math.sin(angle + turn)];
    // Clockwise like the circles, so that all is filled.
    [at(ax, ay, a, -open), at(bx, by, b, -open), at(bx, by, b, open), at(ax, ay, a, open)].forEach(([x, y], corner) =>
      pen[corner === 0 ? "moveTo" : "lineTo"](x, y));
    pen.closePath();
  }

  box(box) {
    const { pen, eye, sun } = this;
    const [centre, half, turn, colour] = [box.slice(0, 3), box.slice(3, 6), box.slice(6, 10), box.slice(10, 13)];
    const corners = CORNERS.map((corner) => add(centre, rotated(turn, corner.map((sign, axis) => sign * half[axis]))));
    const points = corners.map((corner) => this.seen(corner));
    for (const [axis, sign, face] of FACES) {
      const normal = rotated(turn, [0, 1, 2].map((other) => (other === axis ? sign : 0)));
      const out = corners[face[0]].reduce((sum, value, at) => sum + normal[at] * (eye[at] - value), 0);
      if (out <= 0 || !face.every((corner) => points[corner])) continue;
      const facing = Math.max(0, normal.reduce((sum, value, at) => sum + value * sun[at], 0));
      pen.fillStyle = paint(colour, 0.5 + 0.75 * facing);
      pen.beginPath();
      face.forEach((corner, at) => pen[at === 0 ? "moveTo" : "lineTo"](points[corner][0], points[corner][1]));
      pen.closePath();
      pen.fill();
      pen.strokeStyle = "rgb(0 0 0 / 18%)";
      pen.lineWidth = 0.7;
      pen.stroke();
    }
  }
}

function rows(values, width) {
  return Array.from({ length: values.length / width }, (_, row) => values.subarray(row * width, (row + 1) * width));
}

function middle(capsule) {
  return [0, 1, 2].map((axis) => 0.5 * (capsule[axis] + capsule[4 + axis]));
}

function add(a, b) {
  return a.map((value, axis) => value + b[axis]);
}

// A vector turned by a quaternion.
function rotated([x, y, z, w], v) {
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const axis = [x, y, z];
  const twice = cross(axis, v).map((value) => 2 * value);
  const again = cross(axis, twice);
  return v.map((value, at) => value + w * twice[at] + again[at]);
}

// A linear colour under so much light, as styles have it.
function paint(colour, light) {
  const bytes = Array.from(colour, (value) => Math.round(255 * Math.min(1, Math.max(0, light * value)) ** (1 / 2.2)));
  return `rgb(${bytes.join(" ")})`;
}
